// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/commands.h"

#include <cmath>

#include "drive/axis/words.h"
#include "drive/modes/waiting_set_points.h"
#include "drive/sentence.h"

namespace cia402::drive {

std::string Commands::refusal(double value, const ModeControl& mode) const {
  if (leader_ != nullptr) {
    return "the axis follows a trajectory of group " + *leader_ +
           "; stop that first with an empty trajectory";
  }
  if (!std::isfinite(value)) return "it is not a finite number";
  if (mode.kind() == SetPointKind::none) {
    return "mode " + mode.spec().name + " takes none; set_mode another first";
  }
  std::uint64_t raw = 0;
  if (mode.kind() == SetPointKind::torque && !mode.encode(value, raw)) {
    return number(value) + " does not fit " + mode.targetText();
  }
  const bool coasts = !axis_.config.brake_after_effort && mode.stopsAtLimit();
  if (coasts && !mode.maySlow(value)) {
    return limitText(axis_.state, axis_.config) +
           ", and coasts (command_timeout_action): only an effort that slows it down is taken";
  }
  if (stream_.command && !mode.takesMore()) {
    return std::to_string(WaitingSetPoints::kMost) +
           " wait for those before already; give it again once some are reached";
  }
  return {};
}

std::string Commands::excess(double value, const ModeControl& mode) const {
  const motion::JointLimits& limits = axis_.config.limits;
  const bool velocity = mode.kind() == SetPointKind::velocity;
  if (!mode.positions()) {
    const std::optional<double>& most = velocity ? limits.velocity : limits.effort;
    std::uint64_t raw = 0;
    if (most && std::fabs(value) > *most) {
      return number(value) + " is beyond its limit of " + (velocity ? "velocity, " : "effort, ") +
             number(*most);
    }
    return mode.encode(value, raw) ? std::string()
                                   : number(value) + " does not fit " + mode.targetText();
  }
  if (mode.spec().handover.relative() || mode.accepts(value)) return {};
  return "position " + number(value) + " is beyond its limits" +
         (limits.lower ? ", " + number(*limits.lower) + " below" : "") +
         (limits.upper ? ", " + number(*limits.upper) + " above" : "");
}

Result<void> Commands::take(double value, ModeControl& mode, const SetPoint& sent, Time now) {
  const std::string why = refusal(value, mode);
  if (!why.empty()) return Error{jointName(axis_.config) + ": set-point refused: " + why};
  if (!stream_.command) resume(mode, sent, stream_.clock);
  stream_.command = value;
  stream_.commanded = now;
  stream_.dried_up = false;
  mode.takeCommand(stream_);
  return {};
}

void Commands::resume(ModeControl& mode, const SetPoint& sent, Time at) {
  breaks_ = sent.breaks();
  given_up_ = sent.givenUp();
  interruptions_ = sent.interruptions();
  mode.beginStream(stream_, at);
}

/// As the mode leads it.
std::optional<double> Commands::lead(ModeControl& mode, const SetPoint& sent, Time now) {
  // What was sent ended otherwise: by a stop, or by cycles that were missed.
  if (sent.breaks() != breaks_ || sent.interruptions() != interruptions_) {
    if (sent.givenUp() != given_up_) {
      drop();
      return {};
    }
    resume(mode, sent, stream_.clock - axis_.config.cycle);
  }
  return mode.follow(stream_, now);
}

}  // namespace cia402::drive
