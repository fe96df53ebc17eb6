// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/words.h"

#include "common/text.h"
#include "drive/profile/fault_text.h"
#include "drive/sentence.h"

namespace cia402::drive {

namespace {

/// Why a drive that would go on for ever gets no set-points; empty: it gets them.
std::string unwatchedRefusal(const AxisCore& axis) {
  const ModeSpec& mode = axis.mode().spec();
  if (!mode.runsOn() || axis.config().unwatched_streams || axis.device().noticesLostMaster()) {
    return {};
  }
  return axis.who() + ": the " + axis.device().terms().device +
         " does not notice when this driver dies, and would go on in mode " + mode.name +
         " with what it was told last; use a mode of positions, or say `unwatched_streams: true` "
         "of the axis where nobody can come to harm by that";
}

}  // namespace

std::string report(const AxisCore& axis) {
  const fieldbus::Slot slot = axis.objects().controlword.slot;
  const std::uint64_t sent = axis.control().frames();
  const std::uint16_t statusword = axis.state().statusword;
  std::string text = "controlword " + axis.profile().address(0x6040) + " = " +
                     hexText(axis.control().word(), 4) + ", " + axis.control().text() +
                     ", sent in " + axis.device().carrierText(slot) + ", " + std::to_string(sent) +
                     " frames so far";
  text += "; the drive shows " + axis.feedback().stateText() + "; " + axis.faults().emergencyText();
  if (sent == 0) {
    text +=
        std::string("; no ") + axis.device().terms().output + " has left: is the cycle running?";
  }
  if ((statusword & statusword::kVoltageEnabled) == 0) {
    text += "; voltage enabled is 0: check the main supply and the safety (STO) inputs";
  } else if ((statusword & statusword::kRemote) == 0) {
    text += "; remote is 0: the drive does not listen to the controlword, check its control source";
  }
  return text;
}

std::string limitText(const AxisState& state, const AxisConfig& config) {
  const motion::JointLimits& limits = config.limits;
  const bool prismatic = config.geometry.prismatic();
  const double limit = (state.velocity > 0.0 ? limits.upper : limits.lower).value_or(kUnknown);
  const bool beyond = motion::room(limits, state.position, state.velocity) < 0.0;
  return "at " + length(state.position, prismatic) + ", with " + length(state.velocity, prismatic) +
         "/s, the axis " + (beyond ? "goes on beyond" : "comes to") + " its limit of position " +
         length(limit, prismatic);
}

std::string needText(const StatusNeed& need) {
  return "statusword bit " + std::to_string(need.bit) + " is " + (need.set ? "0" : "1") + ", " +
         need.text + ": " + need.remedy;
}

std::string obstacle(const AxisCore& axis) {
  const std::string name = jointName(axis.config());
  const AxisState& state = axis.state();
  const ModeSpec& mode = axis.mode().spec();
  const bool homed = axis.generator().homedEnough();
  const std::string zero = axis.config().homing ? "home" : "set_position";  // gives it one
  if (!axis.deviceReady()) {
    return name + ", its " + axis.device().terms().device + " is " +
           fieldbus::toString(axis.device().health()) + ": recover";
  }
  if (!state.feedback_valid) return name + " gives no fresh statusword and position: recover";
  if (axis.faulted()) return name + " is in fault: recover";
  if (!axis.inOperation()) return name + " is not enabled (" + toString(state.state) + "): enable";
  if (const StatusNeed* need = axis.feedback().unmet()) return name + ": " + needText(*need);
  if (axis.mode().homing()) {
    return name + " is left in its homing mode: enable" + (homed ? "" : ", then " + zero);
  }
  const bool shown = axis.feedback().shows(mode);
  if (state.halted && !inMode(axis) && !axis.profile().mode_change.while_halted) {
    return name + " is halted, is not in mode " + mode.name +
           ", and takes no mode while halted: disable, then enable";
  }
  if (state.halted) return name + " is halted: enable" + (homed ? "" : ", then " + zero);
  if (!shown) return name + " does not show that it is in mode " + mode.name + ": enable";
  if (!axis.mode().prepared()) {
    return name + " may lack what mode " + mode.name +
           " needs, for a change of the mode was cut off: enable";
  }
  return homed ? std::string() : name + " is not homed: " + zero;
}

std::string motionRefusal(const AxisCore& axis, bool busy) {
  const AxisState& state = axis.state();
  const std::string who = axis.who();
  if (state.ready_for_motion) {
    if (axis.generator().homedEnough()) return unwatchedRefusal(axis);
    return who + ": not homed; " +
           (axis.config().homing ? "home it" : "say where it stands by set_position") +
           " before position motion";
  }
  if (!axis.deviceReady()) {
    return who + ": the " + axis.device().terms().device + " is " +
           fieldbus::toString(axis.device().health()) + "; recover brings it back";
  }
  if (!state.feedback_valid) {
    return who + ": no fresh " + axis.profile().feedbackObjects();
  }
  if (axis.faulted()) return axis.faults().text();
  if (busy) return who + ": a procedure is running";
  if (!axis.inOperation()) {
    return who + ": not enabled, " + axis.feedback().stateText() + "; call enable";
  }
  if (const StatusNeed* need = axis.feedback().unmet()) return who + ": " + needText(*need);
  if (state.halted) return who + ": halted; enable releases the halt";
  const ModeSpec& mode = axis.mode().spec();
  const std::optional<int> shown = axis.feedback().shownMode();
  if (shown != mode.value) {
    return who + ": " + axis.profile().address(0x6061) + " shows mode " +
           (shown ? std::to_string(*shown) : std::string("unknown")) + " instead of " +
           std::to_string(mode.value) + " (" + mode.name + "); call enable";
  }
  if (!axis.mode().prepared()) {
    return who + ": the drive may lack what mode " + mode.name +
           " needs, for a change of the mode was cut off; call enable";
  }
  return who + ": the brake is being released, or the drive does not follow its set-points yet (" +
         axis.feedback().stateText() + ")";
}

std::string enablingRefusal(const AxisCore& axis) {
  const StatusNeed* need = axis.feedback().unmet();
  if (need != nullptr) return axis.who() + ": is not enabled: " + needText(*need);
  if (!axis.control().wantsPowerCycle()) return {};
  return axis.who() + ": is not enabled: " + axis.control().powerCycleReason() +
         "; switch it off and on";
}

std::string calibrationRefusal(const AxisCore& axis) {
  if (!axis.deviceReady()) {
    return std::string("the ") + axis.device().terms().device + " is " +
           fieldbus::toString(axis.device().health()) +
           ", so that nobody knows whether the axis is disabled; recover it first";
  }
  if (!axis.state().feedback_valid) {
    return "no fresh statusword and position say that the axis is disabled and stands (" +
           axis.feedback().text() + "); recover it first";
  }
  if (!axis.powerOff() || axis.inOperation() || axis.goal() == Goal::enabled) {
    return std::string("the axis is not disabled (") + toString(axis.state().state) +
           "); disable it first";
  }
  if (!axis.feedback().measuredStill()) {
    return "the axis is not known to stand; wait until it is at rest";
  }
  return {};
}

}  // namespace cia402::drive
