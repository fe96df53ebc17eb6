// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/limits.h"

#include <algorithm>
#include <cmath>

#include "drive/axis/standstill.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/enable.h"
#include "drive/procedures/steps/fault_reset.h"

namespace cia402::drive {
namespace {

constexpr Duration kStopMargin{std::chrono::milliseconds(500)};
/// Of the cycles between the steps; and a step's own limit, which knows more to tell, comes first.
constexpr Duration kMargin{std::chrono::milliseconds(500)};
constexpr Duration kStanding = 4 * Standstill::kWindow;  // awaitStandstill()
constexpr std::ptrdiff_t kLimitTransfers = 3;            // PositionLimits: for each object

/// The sum of what steps may take. They are called by the names of the steps.
struct Steps {
  const AxisConfig& axis;
  const fieldbus::DeviceTimes& device;
  const DriveProfile& profile = *axis.profile;
  const DriveProfile::Timing& timing = profile.timing;

  Duration transfer() const { return device.transfer(); }
  Duration writes(const std::vector<NamedWrite>& list) const {
    const auto copies = std::count_if(list.begin(), list.end(), [&](const NamedWrite& write) {
      return profile.find(write.from) != nullptr;
    });
    const int each = profile.reads_back ? 2 : 1;
    return (each * static_cast<int>(list.size()) + static_cast<int>(copies)) * transfer();
  }
  Duration limits() const {
    const auto of_profile = std::count_if(profile.startup.begin(), profile.startup.end(),
                                          [](const NamedWrite& write) { return write.when_homed; });
    return kLimitTransfers * std::max<std::ptrdiff_t>(2, of_profile) * transfer();
  }
  Duration mode() const {
    Duration longest{0};
    for (const ModeSpec& spec : profile.modes) {
      longest = std::max(longest, writes(spec.entry_writes));
    }
    return longest + 2 * timing.mode_change + 2 * transfer();
  }
  Duration shown() const {  // ModeShownStep
    const ModeChange& rules = profile.mode_change;
    const bool detour = rules.again == ModeChange::Again::same && !rules.detours.empty();
    return detour ? 2 * mode() : timing.mode_change;
  }
  /// From switch on disabled three transitions, and one more out of quick stop active.
  Duration climb() const {
    return (timing.transition(16) + timing.transition(12)) / 2 + timing.power_off +
           timing.transition(2) + timing.transition(3) + timing.transition(4);
  }
  Duration enable() const {
    return timing.state_change + settings() + kComeToRest + writes(profile.before_enable) +
           limits() + mode() + climb() + shown() + timing.brake_release + kFollowPatience;
  }
  Duration settings() const {  // SettingsStep
    const CountsRule& counts = profile.counts_rule;
    std::size_t transfers = counts.times.size() + counts.over.size() +
                            (timing.brake_object.empty() ? 0 : 1) +
                            (timing.power_object.empty() ? 0 : 1);
    if (counts.adjustable) transfers += 4;  // two are written, and read again
    transfers += profile.rated_torque.empty() ? 0 : 1;
    transfers += profile.not_ready_reason.empty() ? 0 : 1;
    for (const SettingCheck& check : profile.checks) {
      transfers += check.objects.size() + (check.unless.empty() ? 0 : 1);
      if (check.write != SettingCheck::Write::never) transfers += 2;  // it is read again
    }
    return static_cast<int>(transfers) * transfer();
  }
  Duration change() const {  // SwitchStep
    const ModeChange& rules = profile.mode_change;
    const bool may_disable = rules.needs_disabling || !rules.detours.empty();
    return may_disable ? timing.disabling(axis.disabling) + enable() + mode() : mode();
  }
  Duration reset() const {
    const Duration once = timing.transition(14) + timing.transition(15) + 3 * timing.state_change +
                          FaultResetStep::kInterval + FaultResetStep::kWatch;
    const Duration clearing = profile.fault_reset.clears_history ? transfer() : Duration(0);
    if (profile.fault_reset.pause == Duration::zero()) {
      return clearing + profile.fault_reset.tries * once;
    }
    return clearing + (profile.fault_reset.tries + 1) * once + FaultResetStep::pause(profile);
  }
  Duration boot() const { return kBootTimes * device.boot; }
  Duration declare() const { return 2 * kStanding + 2 * limits(); }
  Duration home() const {
    const bool by_drive = axis.homing && profile.homing.methods.count(axis.homing->method) != 0 &&
                          axis.homing->method;
    if (!by_drive) return declare();
    return settings() + writes(profile.homing.writes) + limits() + enable() + stopTime(axis, 0.0) +
           timing.state_change + axis.homing->timeout + transfer() + timing.state_change +
           limits() + change();
  }
  Duration rewrite() const {  // SaveBySwitch
    constexpr int kMostWritten = 100;
    return profile.parameters.recipes.memory.object.empty() ? Duration(0)
                                                            : 2 * kMostWritten * transfer();
  }
  Duration store(const std::vector<std::uint8_t>& subindices) const {
    return static_cast<int>(subindices.size()) * (profile.parameters.timeout + transfer());
  }
};

}  // namespace

Duration stopTime(const AxisConfig& config, double velocity) {
  const double fastest = config.limits.velocity.value_or(0.0);
  const double measured = std::isfinite(velocity) ? std::fabs(velocity) : 0.0;
  const double ramp = std::max(fastest, measured) / stopDeceleration(config);
  return std::max(config.profile->timing.state_change, fromSeconds(2.0 * ramp) + kStopMargin);
}

Duration transitionTime(const AxisCore& axis, int number) {
  const Duration more = endsOperation(number) ? axis.control().powerOffTime() : Duration(0);
  return axis.profile().timing.transition(number) + more;
}

Duration disablingAtOnce(const AxisCore& axis) {
  Duration longest{0};
  for (const int number : axis.config().disabling.transitions()) {
    longest = std::max(longest, transitionTime(axis, number));
  }
  return longest;
}

Duration disablingInTurn(const AxisCore& axis) {
  Duration time{0};
  for (const int number : axis.config().disabling.transitions()) {
    time += transitionTime(axis, number);
  }
  return time;
}

Duration timeLimit(ProcedureKind kind, const AxisConfig& config,
                   const fieldbus::DeviceTimes& device, double velocity) {
  const Steps steps{config, device};
  const Duration stop = stopTime(config, velocity), change = steps.timing.state_change;
  switch (kind) {
    case ProcedureKind::none:
      break;
    case ProcedureKind::enable:
      return kMargin + std::max(steps.change(), steps.enable());
    case ProcedureKind::disable:
      return kMargin + stop + steps.timing.disablingInTurn(config.disabling) + kComeToRest;
    case ProcedureKind::home:
      return kMargin + steps.home();
    case ProcedureKind::clear_faults:
      return kMargin + steps.reset();
    case ProcedureKind::recover:
      return kMargin + 2 * change + steps.boot() + steps.reset() + steps.enable();
    case ProcedureKind::quick_stop:
      return kMargin + stop + std::max(steps.timing.longest(12), steps.transfer());
    case ProcedureKind::halt:
      return kMargin + stop;
    case ProcedureKind::set_mode:
      return kMargin + kStanding + steps.change() +
             (config.set_mode_stops ? stop + std::max(steps.change(), steps.enable())
                                    : Duration(0));
    case ProcedureKind::set_position:
      return kMargin + steps.declare();
    case ProcedureKind::save_parameters:
      return kMargin + steps.store(config.saved()) + steps.rewrite();
    case ProcedureKind::restore_parameters:
      return kMargin + steps.store(config.restored()) + steps.boot();
  }
  return kMargin;
}

}  // namespace cia402::drive
