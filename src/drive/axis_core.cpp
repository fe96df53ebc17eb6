// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Construction, and the reactions that wait for nobody.
#include "axis_core.h"

#include <algorithm>
#include <utility>

#include "sentence.h"

namespace cia402::drive {
namespace {

SetPointLimits setPointLimits(const AxisConfig& config) {
  return {config.limits.lower, config.limits.upper, config.limits.velocity,
          stopDeceleration(config)};
}

}  // namespace

AxisCore::AxisCore(AxisConfig config, fieldbus::Device& device)
    : config_(std::move(config)),
      device_(device),
      image_(device.image()),
      objects_(config_, device),
      polled_velocity_(poller_.add(objects_.velocity)),
      polled_effort_(poller_.add(objects_.effort)),
      polled_following_error_(
          poller_.add(objects_.following_error, AxisPoller::Reading::when_looked_at)),
      polled_mode_(poller_.add(objects_.mode_display)),
      polled_inputs_(poller_.add(objects_.digital_inputs)),
      standstill_(config_.standstill_velocity, objects_.position.conversion.resolution()),
      mode_(objects_.channel(config_.mode)),
      position_(objects_.position.conversion),
      limits_(config_),
      set_point_(setPointLimits(config_), config_.sync_period),
      following_(config_.standstill_velocity, config_.sync_period) {
  std::size_t longest = 0;
  for (const ModeSpec& spec : profile().modes) {
    longest = std::max(longest, spec.entry_writes.size());
  }
  held_.reserve(longest);
  const ObjectSpec& position = *objects_.position.spec;
  const bool continuous = config_.geometry.type == AxisGeometry::Type::continuous;
  if (continuous && position.encoding == Encoding::integer) {
    unwrap_ = {fieldbus::sizeBits(position.type), fieldbus::isSigned(position.type)};
  }
  selectMode(*mode_);
  state_.homed = absolute();
}

bool AxisCore::absolute() const {
  return !zero_lost_ && (!config_.homing || !config_.homing->required);
}

const ModeChannel& AxisCore::workingMode() const {
  if (bound_for_ != nullptr) return *bound_for_;
  if (braked_in_ != nullptr) return *braked_in_;
  return mode_->spec->kind == ControlKind::homing ? *objects_.channel(config_.mode) : *mode_;
}

void AxisCore::setGoal(Goal goal) {
  silent_ = voltage_off_ = false;
  goal_ = goal;
  if (goal != Goal::enabled) leaveOperation();
}

void AxisCore::switchOff() {
  setGoal(Goal::disabled);
  voltage_off_ = true;
}

void AxisCore::leaveOperation() {
  in_operation_ = state_.ready_for_motion = false;
  mode_override_.reset();
  brake_released_ = kNever;
  following_.end();
  homing_start_ = effort_streamed_ = false;
  releaseHalt();
  handshake_.reset(target_raw_);
  set_point_.rest(kindOf(*mode_->spec), SetPoint::kNone);
}

bool AxisCore::faulted() const { return isFault(state_.state); }

bool AxisCore::powerOff() const { return powerStageOff(state_.state, state_.statusword); }

void AxisCore::supervise(Time now) {
  if (stop_ticket_) watchStopBySdo();
  if (now > written_ + 2 * config_.sync_period && written_ != Time{}) onLateCycle(now);
  if (!nodeReady()) return;
  if (!limits_.idle() || limits_due_ || limitsBelong() != limits_known_) keepLimits();
  const bool commanded = goal_ != Goal::disabled && goal_ != Goal::quick_stop;
  if (commanded && !state_.feedback_valid) return stopUnheard();
  const State state = state_.state;
  if (in_operation_) {
    const bool undecodable =
        state == State::unknown && now - known_state_ <= config_.undecodable_timeout;
    if (state != State::operation_enabled && !undecodable) return giveUpOperation();
    if (state_.warning && profile().warning_stops) return stopForWarning();
    if (braked_in_ != nullptr) watchBrakeMode(now);
    const bool has_bit = mode_->spec->follows_command_bit.has_value();
    if (!following_.leaves(standstill_.moving(), has_bit, now)) watchFollowing(now);
  } else if (goal_ == Goal::enabled && state == State::operation_enabled) {
    in_operation_ = true;
    brake_released_ = now + profile().timing.brake_release;
    following_.begin(now);
    neutralizeTarget();
  }
}

void AxisCore::stopUnheard() {
  setGoal(Goal::quick_stop);
  failure_ = who() + ": no usable statusword (6041:00) and position (6064:00): " + feedbackText() +
             "; quick stop is commanded. Check bus load, cable and the drive's TPDOs";
  notify(failure_);
}

void AxisCore::giveUpOperation() {
  failure_ = who() + ": the drive left operation enabled by itself: " + stateText() + "; " +
             (faulted() || state_.error_code != 0 ? faultText() : emergencyText()) +
             (faulted() ? "" : "; enable brings it back once the reason is gone");
  // Switching off would cut a quick stop ramp of the drive short.
  setGoal(state_.state == State::quick_stop_active ? Goal::quick_stop : Goal::disabled);
  notify(failure_);
}

void AxisCore::stopForWarning() {
  failure_ = who() + ": the drive warns (statusword bit 7), which makes it stop like a fault: " +
             faultText();
  setGoal(Goal::quick_stop);  // what the drive does itself; switching off would let it coast
  notify(failure_);
}

void AxisCore::onLateCycle(Time now) {
  set_point_.interrupt();
  const bool stopping = state_.halted && !halt_bit_ && set_point_.kind() == SetPointKind::goal;
  if (stopping && stop_point_after_ == kNever) stop_point_after_ = now;
}

void AxisCore::updateReadiness(bool busy, Time now) {
  state_.ready_for_motion = in_operation_ && !busy && !state_.halted && state_.feedback_valid &&
                            brakeReleased(now) && shown_mode_ == mode_->spec->value &&
                            state_.state == State::operation_enabled;
}

void AxisCore::onNodeLost() {
  const bool was_commanded = !silent_;
  setGoal(Goal::disabled);
  silent_ = true;
  fault_reset_ = false;
  forgetFeedback();
  poller_.reset();
  errors_ = ErrorEvidence();
  state_.error_code = 0;
  base_controlword_ = controlword_ = 0;
  if (!absolute()) returnToDriveZero();
  limits_.forget();
  limits_due_ = true;
  state_.homed = absolute();
  state_.ready_for_motion = false;
  state_.health = device_.health();
  selectMode(*objects_.channel(config_.mode));
  failure_ = who() + ": the node is " + fieldbus::toString(device_.health());
  if (!device_.problem().empty()) failure_ += " (" + device_.problem() + ")";
  failure_ += "; the axis stays disabled until recover or enable";
  if (was_commanded) notify(failure_);
}

void AxisCore::onBusLost(const std::string& why) {
  const bool commanded = goal_ != Goal::disabled && goal_ != Goal::quick_stop;
  if (!commanded) return;
  setGoal(Goal::quick_stop);
  failure_ = who() + ": " + why +
             ": nothing reaches the drive; it gets a quick stop once the bus is back and stays "
             "disabled until enable or recover";
  notify(failure_);
}

void AxisCore::stopBySdo(const std::string& why) {
  if (!nodeReady() || powerOff()) return;
  const bool was_commanded = !silent_ && goal_ != Goal::disabled;
  setGoal(Goal::quick_stop);
  const ObjectSpec* object = objects_.controlword.spec;
  stop_ticket_ = device_.objects().downloadUrgent(
      object->id, fieldbus::toBytes(controlword::kQuickStopCommand, 2), object->name);
  if (!was_commanded) return;
  failure_ = who() + ": " + why;
  notify(failure_);
}

/// Where that failed as well, nothing but the drive itself can stop the motor.
void AxisCore::watchStopBySdo() {
  if (!stop_ticket_ || !stop_ticket_->done()) return;
  const fieldbus::Ticket ended = std::exchange(stop_ticket_, nullptr);
  if (ended->ok()) return;
  notify(who() + ": the quick stop by SDO failed: " + ended->message() +
         "; the drive may go on: switch its power off if it does not stop by itself");
}

void AxisCore::notify(std::string text) {
  notice_ = std::move(text);
  notice_warns_ = false;
  ++notices_;
}

void AxisCore::warnOnce(std::string text) {
  if (std::find(warned_.begin(), warned_.end(), text) != warned_.end()) return;
  warned_.push_back(text);
  notify(std::move(text));
  notice_warns_ = true;
}

void AxisCore::declarePosition(double value) {
  if (!state_.feedback_valid) return;
  zero_lost_ = false;
  setZero(zero_shift_ + (value - state_.position));
}

void AxisCore::adoptDriveZero(double shift) {
  zero_lost_ = false;
  unwrap_.restart(mode_->spec->kind == ControlKind::homing);
  setZero(shift);
}

void AxisCore::returnToDriveZero() {
  unwrap_.restart(mode_->spec->kind == ControlKind::homing);
  setZero(0.0);
}

void AxisCore::loseZero() {
  returnToDriveZero();
  unwrap_.restart(true);  // what its number does until measureAnew() is no motion
  zero_lost_ = true;
  state_.homed = false;
}

/// A drive that sends its position on changes only has sent another one already.
void AxisCore::measureAnew() {
  unwrap_.restart(mode_->spec->kind == ControlKind::homing);
  placeZero();
  standstill_.reset();
  const fieldbus::Slot slot = objects_.position.slot;
  if (!nodeReady() || !image_.regular(slot)) return;
  image_.forget(slot);
  forgetMotion();
}

std::string AxisCore::calibrationRefusal() const {
  if (!nodeReady()) {
    return std::string("the node is ") + fieldbus::toString(device_.health()) +
           ", so that nobody knows whether the axis is disabled; recover it first";
  }
  if (!state_.feedback_valid) {
    return "no fresh statusword and position say that the axis is disabled and stands (" +
           feedbackText() + "); recover it first";
  }
  if (!powerOff() || in_operation_ || goal_ == Goal::enabled) {
    return std::string("the axis is not disabled (") + toString(state_.state) +
           "); disable it first";
  }
  if (!standstill_.still()) return "the axis is not known to stand; wait until it is at rest";
  return {};
}

std::string AxisCore::enablingRefusal() const {
  if (power_cycle_after_ != device_.bootUps()) return {};
  return who() +
         ": is not enabled: its parameters were saved, after which the drive takes no enabling "
         "(power_cycle_after_save of its profile); switch it off and on";
}

void AxisCore::setZero(double shift) {
  const double moved = shift - zero_shift_;
  zero_shift_ = shift;
  placeZero();
  if (mode_->spec->kind == ControlKind::position) {
    set_point_.shift(moved);
    given_ = kUnknown;
  }
  state_.position += moved;
  state_.homed = true;
  ++state_.zero_changes;
  limits_due_ = true;
  standstill_.reset();
}

/// Targets need no whole wraps: they wrap around themselves.
void AxisCore::placeZero() {
  const Conversion& position = objects_.position.conversion;
  position_ =
      position.shifted(zero_shift_ + static_cast<double>(unwrap_.wraps()) * position.span());
  mode_conversion_ = mode_->conversion;
  if (mode_->spec->kind != ControlKind::position) return;
  mode_conversion_ = mode_conversion_.shifted(zero_shift_);
  if (unwrap_.counting()) mode_conversion_ = mode_conversion_.wrapping();
}

void AxisCore::openLimits(bool open) {
  if (limits_open_ == open) return;
  limits_open_ = open;
  limits_due_ = true;
}

void AxisCore::keepLimits() {
  const bool known = limitsBelong();
  if (state_.feedback_valid) {
    if (std::exchange(limits_due_, false) || known != limits_known_) {
      limits_known_ = known;
      limits_.aim(known, zero_shift_, state_.position);
    }
    limits_.closeIfInside(state_.position, in_operation_ ? target() : state_.position);
  }
  limits_.advance(device_.objects());
}

}  // namespace cia402::drive
