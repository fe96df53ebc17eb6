// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/core.h"

#include <algorithm>
#include <cmath>

#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::sim {
namespace {

constexpr Duration kSyncSilence = std::chrono::milliseconds(100);
constexpr Duration kQuickStopFlash = std::chrono::milliseconds(2);
constexpr Duration kWatchPeriod = std::chrono::milliseconds(1);
constexpr std::uint16_t kFaultResetBit = 0x0080;  // of the controlword; others of the statusword
constexpr std::uint16_t kWarningBit = 0x0080;
constexpr std::uint16_t kVoltageBit = 0x0010;
constexpr std::uint16_t kRemoteBit = 0x0200;

std::int64_t gridStep(Time time) { return time.time_since_epoch() / kDriveStep; }

}  // namespace

DriveCore::DriveCore(const DriveDefinition& definition, const AxisMechanics& mechanics,
                     ObjectDictionary& dictionary, Reports& reports)
    : definition_(definition),
      mechanics_(mechanics),
      values_(definition, dictionary, mechanics.counts_per_turn),
      history_count_(dictionary.find({0x1003, 0})),
      motion_(definition, mechanics, values_),
      reports_(reports) {
  causes_.reserve(16);
}

void DriveCore::start(bool cold, Time now) {
  advance(now);
  on_ = true;
  if (cold && !definition_.absolute_encoder) motion_.setCounter(0.0);
  motion_.powerStage(false);
  applied_mode_ = values_.raw(Role::mode, 0);
  motion_.setMode(definition_.mode(applied_mode_));
  enabled_at_ = kNever;
  resets_ = 0;
  mode_commanded_ = was_stopped_ = false;
  mode_at_ = stopped_since_ = kNever;
  reset_low_since_ = now;
  if (cold) stored_ = false;
  last_mode_command_ = applied_mode_;
  state_ = PdsState::not_ready_to_switch_on;
  ready_at_ = now + definition_.initialisation;
  controlword_ = 0;
  statusword_ = 0;  // the dictionary has its initial values again
  after_stop_.reset();
  causes_.clear();
  warning_ = false;
  limit_reported_ = false;
  last_sync_.reset();
  values_.setRaw(Role::error_code, 0);
  showMode();
  if (now >= ready_at_) {
    ready_at_ = kNever;
    enter(PdsState::switch_on_disabled);
  }
  motion_.publish();
  updateStatusword();
}

void DriveCore::powerOff() {
  on_ = false;
  motion_.powerStage(false);
  state_ = PdsState::not_ready_to_switch_on;
  ready_at_ = kNever;
  after_stop_.reset();
  statusword_ = 0;
}

bool DriveCore::enabledState() const {
  return state_ == PdsState::operation_enabled || state_ == PdsState::quick_stop_active ||
         state_ == PdsState::fault_reaction_active;
}

bool DriveCore::idle() const {
  return enabled_at_ == kNever && mode_at_ == kNever && !motion_.powered() && motion_.atRest() &&
         (ready_at_ == kNever || !on_);
}

void DriveCore::advance(Time now) {
  now_ = std::max(now_, now);
  const std::int64_t target = gridStep(now_);
  bool moved = false;
  while (step_ < target) {
    if (idle()) {
      step_ = target;
      break;
    }
    ++step_;
    step();
    moved = true;
  }
  if (moved) motion_.publish();
  if (on_ && (moved || !causes_.empty())) updateStatusword();
}

Time DriveCore::nextEvent() const {
  if (idle()) return kNever;
  if (ready_at_ != kNever && !motion_.powered()) {
    const Time due{(gridStep(ready_at_ - Duration(1)) + 1) *
                   kDriveStep};  // the first step at or after
    return std::max(due, Time{(step_ + 1) * kDriveStep});
  }
  // While SYNC runs the drive is asked often enough by it.
  const bool synchronised = last_sync_ && now_ - *last_sync_ < kSyncSilence;
  return now_ + (synchronised ? kSyncSilence : kWatchPeriod);
}

void DriveCore::step() {
  const Time time{step_ * kDriveStep};
  if (on_ && time >= ready_at_) {
    ready_at_ = kNever;
    enter(PdsState::switch_on_disabled);
  }
  if (time >= enabled_at_) {
    enabled_at_ = kNever;
    enter(PdsState::operation_enabled);
    onTargetPosition();
  }
  if (time >= mode_at_) applyMode(values_.raw(Role::mode, 0));
  if (state_ == PdsState::operation_enabled) motion_.hold(time < follow_at_);
  motion_.step();
  if (motion_.powered()) {
    superviseMotion();
    stepState();
  }
}

void DriveCore::stepState() {
  if (!motion_.stopping() || !motion_.standing()) return;
  if (state_ == PdsState::fault_reaction_active) {
    enter(PdsState::fault);  // transition 14
  } else if (state_ == PdsState::quick_stop_active) {
    if (!hold_after_quick_stop_) enter(PdsState::switch_on_disabled);  // transition 12
  } else if (after_stop_) {
    enter(after_stop_->to);
  }
}

void DriveCore::enter(PdsState state) {
  const bool was_enabled = enabledState();
  state_ = state;
  after_stop_.reset();
  if (state == PdsState::operation_enabled) {
    if (!was_enabled) {
      motion_.powerStage(true);
      follow_at_ = now_ + fromSeconds(mechanics_.brake_delay);
      motion_.hold(now_ < follow_at_);
    } else {
      motion_.release();
    }
  } else if (!enabledState() && was_enabled) {
    motion_.powerStage(false);
  }
  if (state != PdsState::switched_on) enabled_at_ = kNever;
  showMode();
}

StopOption DriveCore::option(const OptionTable& table, Role role) const {
  const auto found = table.options.find(values_.raw(role, table.fallback));
  return found == table.options.end() ? StopOption{} : found->second;
}

void DriveCore::onControlword() {
  const std::uint16_t previous = controlword_;
  controlword_ = static_cast<std::uint16_t>(values_.raw(Role::controlword, 0));
  const PdsCommand command = decodeCommand(controlword_, previous);
  if (command == PdsCommand::fault_reset) {
    if (seesResetEdge(previous)) resetFault();
    return;
  }
  if ((previous & kFaultResetBit) != 0) reset_low_since_ = now_;
  const bool was_operating = state_ == PdsState::operation_enabled && !after_stop_;
  if (state_ == PdsState::operation_enabled && after_stop_ &&
      command == PdsCommand::enable_operation) {
    after_stop_.reset();
    motion_.release();
  }
  PdsTransition transition = transitionFor(state_, command);
  if (transition.number == 0 && definition_.direct_enable &&
      state_ == PdsState::switch_on_disabled && (controlword_ & 0x0087) == 0x0007) {
    enter(PdsState::ready_to_switch_on);
    transition = transitionFor(state_, command);
  }
  if (transition.number != 0) execute(transition);
  if (transition.number == 3 && command == PdsCommand::enable_operation &&
      definition_.enable_in_one_step) {
    execute(transitionFor(state_, command));
  }
  if (state_ == PdsState::operation_enabled && !after_stop_) {
    // Edges count only where operation was enabled before.
    motion_.controlBits(controlword_, was_operating ? previous : controlword_);
  }
  updateStatusword();
}

void DriveCore::execute(const PdsTransition& transition) {
  switch (transition.number) {
    case 4:
      beginEnabling();
      break;
    case 5:
      leaveEnabled(transition, definition_.disable_operation, Role::disable_operation_option);
      break;
    case 8:
      leaveEnabled(transition, definition_.shutdown, Role::shutdown_option);
      break;
    case 11:
      beginQuickStop(option(definition_.quick_stop, Role::quick_stop_option));
      break;
    case 16:
      if (hold_after_quick_stop_ &&
          (definition_.resume_quick_stop_while_moving || motion_.standing())) {
        enter(PdsState::operation_enabled);
      }
      break;
    default:
      enter(transition.to);
      break;
  }
}

void DriveCore::leaveEnabled(const PdsTransition& transition, const OptionTable& table, Role role) {
  const StopOption chosen = option(table, role);
  if (chosen.ramp == Ramp::coast) {
    enter(transition.to);
    return;
  }
  if (!after_stop_) motion_.stop(chosen.ramp);
  after_stop_ = transition;
}

void DriveCore::beginQuickStop(StopOption chosen) {
  if (chosen.ramp == Ramp::coast) {
    enter(PdsState::switch_on_disabled);
    return;
  }
  hold_after_quick_stop_ = chosen.hold;
  quick_stop_since_ = now_;
  enter(PdsState::quick_stop_active);
  motion_.stop(chosen.ramp);
}

void DriveCore::beginFaultReaction(Ramp ramp) {
  if (!motion_.powered() || ramp == Ramp::coast) {
    enter(PdsState::fault);
    return;
  }
  enter(PdsState::fault_reaction_active);
  motion_.stop(ramp);
}

void DriveCore::onTargetPosition() {
  if (state_ != PdsState::operation_enabled) return;
  const bool synchronised = last_sync_ && now_ - *last_sync_ < kSyncSilence;
  if (synchronised && now_ != *last_sync_) return;  // waits for the next SYNC
  startSegment();
}

void DriveCore::onSync() {
  if (last_sync_) sync_interval_ = now_ - *last_sync_;
  last_sync_ = now_;
  startSegment();
}

void DriveCore::startSegment() {
  const double exponent = static_cast<double>(values_.raw(Role::interpolation_exponent, -3));
  double period =
      static_cast<double>(values_.raw(Role::interpolation_time, 0)) * std::pow(10.0, exponent);
  if (definition_.follows_sync_period || period <= 0.0) period = toSeconds(sync_interval_);
  motion_.cyclicTarget(period, toSeconds(now_ - Time{step_ * kDriveStep}));
}

void DriveCore::onHomingStart() {
  if (state_ == PdsState::operation_enabled) motion_.homeByObject();
}

void DriveCore::saveZero() {
  motion_.setCounter(0.0);
  motion_.publish();
}

std::uint32_t DriveCore::refuseWrite(const Entry& entry, std::uint64_t number) const {
  namespace abort_code = fieldbus::abort_code;
  Entry candidate = entry;
  candidate.number = number;
  const std::int64_t value =
      fieldbus::isSigned(entry.type) ? asSigned(candidate) : static_cast<std::int64_t>(number);
  if (values_.entry(Role::mode) == &entry) {
    if (definition_.mode(value) == nullptr) return abort_code::kInvalidValue;
    const bool change = value != applied_mode_;
    if (change && enabledState() && !definition_.mode_change_while_enabled) {
      return abort_code::kDeviceState;
    }
    return 0;
  }
  const bool of_homing = entry.id.index == 0x6098 || entry.id.index == 0x6099;
  if (definition_.quirks.homing_is_fixed && of_homing) return abort_code::kReadOnly;
  if (values_.entry(Role::homing_method) == &entry) {
    const auto& methods = definition_.homing_methods;
    const bool known = std::find(methods.begin(), methods.end(), value) != methods.end();
    return known ? 0 : abort_code::kInvalidValue;
  }
  if (values_.entry(Role::save_zero) == &entry && motion_.powered()) {
    return abort_code::kDeviceState;
  }
  const auto& locked = definition_.locked_while_enabled;
  const bool is_locked = std::find(locked.begin(), locked.end(), entry.id) != locked.end();
  return is_locked && enabledState() ? abort_code::kDeviceState : 0;
}

void DriveCore::updateStatusword() {
  const bool flashed = definition_.quirks.quick_stop_flashes &&
                       state_ == PdsState::quick_stop_active &&
                       now_ - quick_stop_since_ > kQuickStopFlash;
  const bool hidden = flashed || definition_.quirks.shows_no_state;
  std::uint16_t word = statusBits(hidden ? PdsState::switch_on_disabled : state_);
  if (state_ != PdsState::not_ready_to_switch_on) {
    word |= kRemoteBit;
    const bool voltage = std::none_of(causes_.begin(), causes_.end(), [this](const Cause& cause) {
      return cause.fault->voltage_lost && cause.until > now_;
    });
    if (voltage) word |= kVoltageBit;
  }
  if (warning_) word |= kWarningBit;
  if (state_ == PdsState::fault && !hidden) word |= definition_.quirks.fault_bits;
  if (enabledState()) word = static_cast<std::uint16_t>(word | motion_.statusBits());
  const std::uint16_t vendor = definition_.quirks.vendor_bits;
  if (vendor != 0) word = static_cast<std::uint16_t>((word & ~vendor) | vendorBits());
  if (word == statusword_) return;
  statusword_ = word;
  values_.setRaw(Role::statusword, word);
}

}  // namespace cia402::sim
