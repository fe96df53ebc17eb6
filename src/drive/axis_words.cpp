// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The axis in sentences; made on demand only.
#include <cmath>

#include "axis_core.h"
#include "cia402_driver/drive/fault_text.h"
#include "sentence.h"

namespace cia402::drive {

std::string AxisCore::who() const { return whoIs(config_); }

std::string AxisCore::stateText() const {
  if (state_.state == State::unknown && state_.statusword == 0) return "no statusword";
  return "statusword " + hexWord(state_.statusword) + " (" + toString(state_.state) + ": " +
         statuswordText(state_.statusword) + ")";
}

std::string AxisCore::feedbackText() const {
  std::string text = device_.overdueText();
  if (!text.empty()) return text;
  const bool come = image_.fresh(objects_.statusword.slot) && image_.fresh(objects_.position.slot);
  return come ? "the position that the drive sends is no finite number" : "none has come yet";
}

std::string AxisCore::coastingText() const {
  if (!state_.feedback_valid) return "nothing tells whether it stands: " + feedbackText();
  return "the axis still moves (velocity " + number(state_.velocity) +
         "): nothing of the drive brakes it";
}

std::string AxisCore::unknownText() const {
  const bool known = state_.feedback_valid && state_.state != State::unknown;
  if (!nodeReady() || known) return {};
  if (state_.feedback_valid) {
    return who() + ": its state is unknown: statusword (6041:00) " + hexWord(state_.statusword) +
           " is none of the states of CiA 402 (" + statuswordText(state_.statusword) +
           "); is it the right drive profile?";
  }
  std::string why = device_.missingText();
  if (why.empty()) why = feedbackText();
  return who() +
         ": its state is unknown: no usable statusword (6041:00) and position (6064:00): " + why +
         "; check cable, bus load and the drive's TPDOs";
}

std::string AxisCore::modeRefusal(const ModeChannel& mode) const {
  const bool left_out =
      mode.refusal.empty() && mode.target.mapped() && image_.outputLeftOut(mode.target.slot);
  if (!left_out) return mode.refusal;
  return "the drive does not have its target " + fieldbus::toString(mode.target.spec->id) + " " +
         mode.target.spec->name + ", or cannot map it";
}

std::string AxisCore::emergencyText() const {
  if (errors_.pending() == 0) return "no EMCY is pending";
  return "last EMCY " + codeText(errors_.pending());
}

std::string AxisCore::codeText(std::uint16_t code) const {
  const std::string* excuse = errors_.excuse(code);
  return errorCodeText(profile(), code) +
         (excuse != nullptr ? "; the cause is that " + *excuse : std::string());
}

std::string AxisCore::report() const {
  const fieldbus::Slot slot = objects_.controlword.slot;
  const std::uint64_t sent = image_.sent(slot);
  std::string text = "controlword 6040:00 = " + hexWord(controlword_) + ", " + command_.text +
                     ", sent in " + device_.carrierText(slot) + ", " + std::to_string(sent) +
                     " frames so far";
  text += "; the drive shows " + stateText() + "; " + emergencyText();
  if (sent == 0) text += "; no RPDO has left: is the cycle running?";
  if ((state_.statusword & statusword::kVoltageEnabled) == 0) {
    text += "; voltage enabled is 0: check the main supply and the safety (STO) inputs";
  } else if ((state_.statusword & statusword::kRemote) == 0) {
    text += "; remote is 0: the drive does not listen to the controlword, check its control source";
  }
  return text;
}

std::string AxisCore::faultText() const {
  if (faulted()) {
    const char* reacting =
        state_.state == State::fault_reaction_active ? " (the drive is still stopping)" : "";
    if (state_.error_code == 0) {
      return who() + ": fault" + reacting +
             ", no error code yet (603F:00 is 0 and no EMCY came); clear_faults, then look at the "
             "drive's own display or log";
    }
    return who() + ": fault " + codeText(state_.error_code) + reacting + "; then clear_faults";
  }
  if (state_.error_code != 0 && errors_.excuse(state_.error_code) == nullptr) {
    return who() + ": " + (state_.warning ? "warning " : "error reported ") +
           errorCodeText(profile(), state_.error_code);
  }
  if (state_.warning && profile().warning_stops) {
    return who() + ": warning without a code (statusword bit 7); clear_faults";
  }
  return {};
}

std::string AxisCore::obstacle() const {
  const std::string name = jointName(config_);
  const bool homed = homedEnough();
  const std::string zero = config_.homing ? "home" : "set_position";  // the call that gives it one
  if (!nodeReady())
    return name + ", its node is " + fieldbus::toString(device_.health()) + ": recover";
  if (!state_.feedback_valid) return name + " gives no fresh statusword and position: recover";
  if (faulted()) return name + " is in fault: recover";
  if (!in_operation_) return name + " is not enabled (" + toString(state_.state) + "): enable";
  if (mode_->spec->kind == ControlKind::homing) {
    return name + " is left in its homing mode: enable" + (homed ? "" : ", then " + zero);
  }
  const bool shown = shown_mode_ == mode_->spec->value;
  if (state_.halted && !shown && !profile().mode_change.while_halted) {
    return name + " is halted, is not in mode " + mode_->spec->name +
           ", and takes no mode while halted: disable, then enable";
  }
  if (state_.halted) return name + " is halted: enable" + (homed ? "" : ", then " + zero);
  if (!shown) {
    return name + " does not show that it is in mode " + mode_->spec->name + ": enable";
  }
  return homed ? std::string() : name + " is not homed: " + zero;
}

std::string AxisCore::motionRefusal(bool busy) const {
  if (state_.ready_for_motion) {
    if (!homedEnough()) {
      return who() + ": not homed; " +
             (config_.homing ? "home it" : "say where it stands by set_position") +
             " before position motion";
    }
    return {};
  }
  if (!nodeReady()) {
    return who() + ": the node is " + fieldbus::toString(device_.health()) +
           "; recover brings it back";
  }
  if (!state_.feedback_valid) {
    return who() + ": no fresh position (6064:00) and statusword (6041:00)";
  }
  if (faulted()) return faultText();
  if (busy) return who() + ": a procedure is running";
  if (!in_operation_) {
    return who() + ": not enabled, " + stateText() + "; call enable";
  }
  if (state_.halted) return who() + ": halted; enable releases the halt";
  if (shown_mode_ != mode_->spec->value) {
    return who() + ": 6061:00 shows mode " +
           (shown_mode_ ? std::to_string(*shown_mode_) : std::string("unknown")) + " instead of " +
           std::to_string(mode_->spec->value) + " (" + mode_->spec->name + "); call enable";
  }
  return who() +
         ": the brake is being released, or the drive does not follow its set-points yet (" +
         stateText() + ")";
}

}  // namespace cia402::drive
