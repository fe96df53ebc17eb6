// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/core.h"

#include <algorithm>
#include <cmath>

#include "sim/drive/digital_outputs.h"
#include "sim/drive/statusword.h"
#include "sim/drive/sync_timing.h"
#include "sim/drive/write_guard.h"

namespace cia402::sim {
namespace {

constexpr Duration kWatchPeriod = std::chrono::milliseconds(1);

// Controlword.
constexpr std::uint16_t kFaultReset = 0x0080, kUnlockRamp = 0x0020, kHalt = 0x0100;
// Statusword.
constexpr std::uint16_t kModeBits = 0xFC00;

std::int64_t gridStep(Time time) { return time.time_since_epoch() / kDriveStep; }

void showCode(DriveValues& values, std::int64_t code) {
  values.setRaw(Role::error_code, code);
  values.setRaw(Role::error_code_copy, code);
}

}  // namespace

DriveCore::DriveCore(const DriveDefinition& definition, unsigned axis,
                     const AxisMechanics& mechanics, ObjectDictionary& dictionary, Reports& reports)
    : definition_(definition),
      values_(definition, axis, dictionary, mechanics.counts_per_turn),
      history_count_(dictionary.find({0x1003, 0})),
      motion_(definition, definition.motors[axis], mechanics, values_),
      modes_(definition, values_, motion_),
      power_(definition, mechanics, values_, motion_, modes_),
      faults_(definition, values_, dictionary),
      reports_(reports) {}

void DriveCore::start(bool cold, Time now) {
  advance(now);
  on_ = true;
  if (cold && !definition_.absolute_encoder) motion_.setCounter(0.0);
  if (cold) stored_ = false;
  if (cold) motion_.setHomed(false);
  motion_.powerStage(false);
  controlword_ = 0;
  statusword_ = 0;  // the dictionary has its initial values again
  reset_low_since_ = now;
  limits_told_ = LimitReports();
  faults_.start(now);
  sync_.reset();
  showCode(values_, 0);
  modes_.start();
  power_.start(now);
  power_.finishInitialisation(now, now_);
  motion_.parts().probes.start();
  onObstacle();
}

void DriveCore::powerOff() {
  on_ = false;
  motion_.parts().probes.start();
  motion_.parts().maker.setInputs(false, false);
  power_.powerOff();
  statusword_ = 0;
}

bool DriveCore::idle() const {
  if (motion_.powered() || !motion_.atRest() || motion_.parts().maker.wantsPower()) return false;
  const bool initialises = power_.readyAt() != kNever && on_;
  return !power_.enabling() && !faults_.endByThemselves() && modes_.due() == kNever && !initialises;
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
  const bool may_be_local = definition_.quirks.local_until != Duration::zero();
  if (on_ && (moved || !faults_.empty() || may_be_local)) updateStatusword();
}

Time DriveCore::nextEvent() const {
  if (idle()) return kNever;
  if (power_.readyAt() != kNever && !motion_.powered()) {
    const Time due{(gridStep(power_.readyAt() - Duration(1)) + 1) *
                   kDriveStep};  // the first step at or after
    return std::max(due, Time{(step_ + 1) * kDriveStep});
  }
  // While SYNC runs the drive is asked often enough by it.
  return now_ + (sync_.runs(now_) ? SyncWatch::kSilence : kWatchPeriod);
}

void DriveCore::step() {
  const Time time{step_ * kDriveStep};
  if (on_) power_.finishInitialisation(time, now_);
  if (power_.finishEnabling(time, now_)) onTargetPosition();
  const bool fault = power_.state() == PdsState::fault;
  if (fault && faults_.endByThemselves() && faults_.lasting(time) == nullptr) resetFault();
  if (time >= modes_.due()) {
    modes_.apply(power_.state());
    updateStatusword();
  }
  power_.waitForBrake(time);
  motion_.step();
  if (!motion_.powered()) return;
  superviseMotion();
  power_.finishStops(time, now_);
}

void DriveCore::superviseMotion() {
  if (motion_.followingErrorExceeded() && definition_.following_error_is_fault &&
      power_.state() != PdsState::fault_reaction_active) {
    raise("following_error");
  }
  const double tolerance = syncTolerance(definition_, values_, enabledMode());
  const Time time{step_ * kDriveStep};
  if (tolerance < kUnlimited &&
      toSeconds(sync_.since(time)) > interpolationPeriod(values_) + tolerance) {
    raise("sync_error");
  }
  if (const char* fault = motion_.takeFault()) raise(fault);
  if (motion_.parts().watch.takeStall()) raise("stall");
  const MotionLimits& limits = motion_.limits();
  const auto act = [this](const LimitReports::Due& due) {
    if (due.end != nullptr && faults_.endWarning(*due.end)) clearErrors();
    if (due.end != nullptr) updateStatusword();
    const bool told = due.raise != nullptr && due.raise->warning && faults_.stands(*due.raise);
    if (due.raise != nullptr && !told) raise(*due.raise);
  };
  const bool beyond = limits.positionHit();
  act(limits_told_.positions.look(
      {"position_limit", beyond && motion_.standing(), beyond, limits.upwards()}, definition_));
  if (!definition_.limit_switch_is_fault) return;
  act(limits_told_.switches.look(
      {limits.switchFault(), limits.switchHit(), motion_.onLimitSwitch(), limits.upwards()},
      definition_));
}

void DriveCore::onControlword() {
  if (definition_.quirks.isLocal(now_)) return;
  const std::uint16_t previous = controlword_;
  controlword_ = static_cast<std::uint16_t>(values_.raw(Role::controlword, 0));
  const PdsCommand wanted = decodeCommand(controlword_, previous);
  if (wanted == PdsCommand::fault_reset) {
    const DriveQuirks& quirks = definition_.quirks;
    const bool seen = now_ - reset_low_since_ >= quirks.reset_edge_time;
    if (seen && !quirks.fault_reset_by_object) resetFault();
    return;
  }
  if ((previous & kFaultReset) != 0) reset_low_since_ = now_;
  const bool locked = (controlword_ & kUnlockRamp) == 0;
  motion_.lockRamps(definition_.locked_ramp_holds_stops && locked);
  const bool was_operating = power_.operating();
  command(wanted);
  // Most drives mind edges only where operation was enabled before.
  const bool lost = definition_.brake_loses_commands && power_.braking(now_);
  const bool edges = (was_operating || definition_.edges_while_enabling) && !lost;
  if (power_.operating()) motion_.controlBits(controlword_, edges ? previous : controlword_);
  updateStatusword();
}

void DriveCore::command(PdsCommand command) {
  if (motion_.parts().maker.chosen()) return;
  if (command == PdsCommand::enable_operation) power_.stay();
  PdsTransition transition = transitionFor(power_.state(), command);
  if (transition.number == 0 && definition_.direct_enable &&
      power_.state() == PdsState::switch_on_disabled && (controlword_ & 0x0087) == 0x0007) {
    power_.enter(PdsState::ready_to_switch_on, now_);
    transition = transitionFor(power_.state(), command);
  }
  if (!obstacle_.forbids(transition)) execute(transition);
  if (transition.number == 3 && command == PdsCommand::enable_operation &&
      definition_.enable_in_one_step && power_.state() == PdsState::switched_on) {
    execute(transitionFor(power_.state(), command));
  }
}

void DriveCore::execute(const PdsTransition& transition) {
  if (transition.number == 0 || definition_.quirks.refuses(transition.number)) return;
  transition.number == 4 ? beginEnabling() : power_.execute(transition, now_);
}

bool DriveCore::mayEnable() {
  const DriveQuirks& quirks = definition_.quirks;
  const double fastest = definition_.enables_below;
  if (fastest > 0.0 && std::fabs(motion_.motor().velocity()) > fastest) {
    raise("turning_at_enable");
    return false;
  }
  if (quirks.mode_needed && modes_.applied() == 0) return false;
  if (quirks.needs_power_cycle_to_save && stored_) return false;
  if (!quirks.sync_needed || sync_.runs(now_)) return true;
  raise("rpdo_timeout");
  return false;
}

/// 0x0F in Switched on.
void DriveCore::beginEnabling() {
  // Without SYNC the set-point that stands in the dictionary counts at once.
  if (mayEnable() && power_.enable(now_)) onTargetPosition();
}

void DriveCore::onMode() {
  const bool halted = (controlword_ & kHalt) != 0;
  switch (modes_.command(power_.state(), enabled(), halted, now_)) {
    case ModeSelection::Outcome::nothing:
      return;
    case ModeSelection::Outcome::applied:
      return updateStatusword();
    case ModeSelection::Outcome::fault:
      return raise("mode_change");
  }
}

void DriveCore::onTargetPosition() {
  if (power_.state() != PdsState::operation_enabled) return;
  if (sync_.runs(now_) && !sync_.isNow(now_)) return;  // waits for the next SYNC
  startSegment();
}

void DriveCore::onSync() {
  sync_.onSync(now_);
  const double tolerance = syncTolerance(definition_, values_, enabledMode());
  if (tolerance < kUnlimited &&
      toSeconds(sync_.interval()) < interpolationPeriod(values_) - tolerance) {
    raise("sync_error");
  }
  startSegment();
}

void DriveCore::startSegment() {
  double period = definition_.follows_sync_period ? 0.0 : interpolationPeriod(values_);
  if (period <= 0.0) period = toSeconds(sync_.interval());
  motion_.cyclicTarget(period, toSeconds(now_ - Time{step_ * kDriveStep}));
}

void DriveCore::onWrite(Role role) {
  const bool enabled = power_.state() == PdsState::operation_enabled;
  if (role == Role::homing_start && enabled) motion_.homing().startByObject();
  if (role == Role::emergency_stop && enabled) power_.quickStop(now_);
  if (role == Role::alarm_select) faults_.alarms().show();
  if (role == Role::save_zero) motion_.setCounter(0.0);
  if (role == Role::home_offset) motion_.homing().offsetWritten();
  if (const char* fault = motion_.takeFault()) raise(fault);
  motion_.publish();
  updateStatusword();
}

std::uint32_t DriveCore::outputs() const {
  const OutputSituation now{nmt_, statusword_, motion_.powered(), motion_.motor().velocity()};
  return on_ ? outputsAtTerminals(definition_, values_, now) : 0;
}

std::uint32_t DriveCore::refuseWrite(const Entry& entry, std::uint64_t number) const {
  const WriteSituation situation{modes_.applied(), enabled(), motion_.powered()};
  return sim::refuseWrite(definition_, values_, situation, entry, number);
}

void DriveCore::raise(const FaultDefinition& known) {
  if (!on_) return;
  const FaultDefinition& fault = faults_.asSet(known);
  if (!fault.tells) return reports_.emergency(fault);
  faults_.add(fault, now_);
  showCode(values_, fault.code);
  values_.setRaw(Role::error_details, fault.details);
  if (!fault.warning || definition_.warning_stops) power_.react(fault, now_);
  if (fault.holds) motion_.pause(true);
  updateStatusword();
  reports_.emergency(fault);
}

void DriveCore::raise(const char* fault) {
  if (const FaultDefinition* known = definition_.fault(fault)) raise(*known);
}

void DriveCore::resetFault() {
  if (power_.state() != PdsState::fault && !faults_.warning()) return;
  if (power_.state() == PdsState::fault_reaction_active) return;
  if (const FaultDefinition* lasting = faults_.lasting(now_)) {
    showCode(values_, lasting->code);
    reports_.emergency(*lasting);
    return;
  }
  if (!faults_.tryReset(history_count_ != nullptr && history_count_->number != 0)) return;
  clearErrors();
  if (power_.state() == PdsState::fault) power_.enter(PdsState::switch_on_disabled, now_);
  updateStatusword();
}

void DriveCore::clearErrors() {
  faults_.clear();
  motion_.pause(false);
  showCode(values_, 0);
  values_.setRaw(Role::error_details, 0);
  reports_.errorsGone();
}

void DriveCore::onObstacle() {
  const PdsState state = power_.state();
  const bool on =
      enabled() || state == PdsState::switched_on || state == PdsState::ready_to_switch_on;
  if (obstacle_.stands() && on) power_.enter(PdsState::switch_on_disabled, now_);
  values_.setRaw(Role::not_ready_reason, obstacle_.reason());
  motion_.setInputs(obstacle_.inputs());
  motion_.publish();
  updateStatusword();
}

void DriveCore::removeCauses() {
  faults_.endCauses(now_);
  obstacle_.put(nullptr);
  onObstacle();
  motion_.motor().block(false);
  motion_.motor().reverse(false);
  if (!definition_.warning_stops && faults_.endWarnings()) clearErrors();
  updateStatusword();
}

void DriveCore::onNonFinite() { raise("not_a_number"); }

void DriveCore::onBootedAlone() {
  if (definition_.quirks.passive_when_alone) raise("can_passive");
}

void DriveCore::connectionLost(ConnectionLoss reaction) {
  if (definition_.quirks.master_lost_holds) return holdUnwatched();
  switch (reaction) {
    case ConnectionLoss::none:
      return;
    case ConnectionLoss::fault:
      return raise("master_lost");
    case ConnectionLoss::disable_voltage:
      if (enabled()) power_.enter(PdsState::switch_on_disabled, now_);
      break;
    case ConnectionLoss::quick_stop:
      if (power_.state() == PdsState::operation_enabled) power_.quickStop(now_);
      break;
  }
  updateStatusword();
}

void DriveCore::onMasterLost() {
  constexpr ConnectionLoss kByOption[] = {ConnectionLoss::none, ConnectionLoss::fault,
                                          ConnectionLoss::disable_voltage,
                                          ConnectionLoss::quick_stop};
  const std::int64_t code = values_.raw(Role::abort_connection_option,
                                        static_cast<std::int64_t>(definition_.master_lost));
  connectionLost(code >= 0 && code <= 3 ? kByOption[code] : definition_.master_lost);
}

void DriveCore::onNmtState(canopen::NmtState state) {
  const bool left = nmt_ == canopen::NmtState::operational && state != nmt_;
  nmt_ = state;
  faults_.onNmtState(state, now_);
  if (!left || !definition_.stops_outside_operational) return;
  const PdsState power = power_.state();
  if (power != PdsState::operation_enabled && power != PdsState::quick_stop_active) return;
  if (definition_.quirks.master_lost_holds) return holdUnwatched();
  power_.quickStop({Ramp::quick_stop, false}, now_);
  updateStatusword();
}

/// The next controlword ends it.
void DriveCore::holdUnwatched() {
  if (!power_.operating()) return;
  motion_.controlBits(static_cast<std::uint16_t>(controlword_ | kHalt), controlword_);
}

void DriveCore::updateStatusword() {
  StatuswordParts parts;
  parts.shown = power_.shown(now_);
  parts.ready = power_.state() != PdsState::not_ready_to_switch_on;
  parts.voltage = !faults_.voltageLost(now_) && obstacle_.voltage();
  parts.remote = obstacle_.remote() && !definition_.quirks.isLocal(now_);
  parts.warning = faults_.warning();
  if (enabled()) parts.of_mode = motion_.statusBits();
  if (motion_.homed()) parts.of_mode |= definition_.homed_bit.value_or(0);
  if (parts.shown == PdsState::fault && definition_.quirks.fault_keeps_mode_bits) {
    parts.of_mode |= statusword_ & kModeBits;
  }
  const std::uint16_t word = makeStatusword(parts, definition_.quirks, now_);
  if (word == statusword_) return;
  statusword_ = word;
  values_.setRaw(Role::statusword, word);
}

}  // namespace cia402::sim
