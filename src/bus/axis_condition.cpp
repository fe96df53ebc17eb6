// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/axis_condition.h"

namespace cia402::bus {
namespace {

using drive::State;

bool unknown(const drive::AxisState& state) {
  return state.state == State::unknown || !state.feedback_valid;
}

/// What the summary says where no problem is told.
std::string plainText(const AxisSnapshot& axis) {
  const drive::AxisState& state = axis.state;
  if (state.health == fieldbus::Health::booting) {
    return "the drive is booting: " + axis.words.step.str();
  }
  if (state.health != fieldbus::Health::ready) {
    return std::string("the drive is ") + fieldbus::toString(state.health);
  }
  if (unknown(state)) {
    return "its state is unknown: no usable statusword and position yet";
  }
  if (drive::isFault(state.state)) return drive::toString(state.state);
  if (state.warning) return "the drive shows a warning (statusword bit 7)";
  if (!axis.words.stream.empty()) return axis.words.stream.str();
  return std::string(drive::toString(state.state)) +
         (state.halted ? ", halted until `enable`" : "");
}

}  // namespace

Condition conditionOf(const drive::AxisState& state, bool warning_stops, bool problem) {
  // Without a problem it is on its way: its turn to boot has not come, or it boots.
  if (state.health != fieldbus::Health::ready) {
    if (!problem) return Condition::warning;
    return fieldbus::isAway(state.health) ? Condition::unheard : Condition::error;
  }
  if (drive::isFault(state.state) || unknown(state)) return Condition::error;
  if (state.warning) return warning_stops ? Condition::error : Condition::warning;
  return problem ? Condition::warning : Condition::well;
}

Summary summaryOf(const AxisSnapshot& axis, bool warning_stops) {
  const AxisWords& words = axis.words;
  Summary summary;
  summary.condition = conditionOf(axis.state, warning_stops, !words.problem.empty());
  if (summary.condition == Condition::well && !words.stream.empty()) {
    summary.condition = Condition::warning;
  }
  if (summary.condition >= Condition::error && axis.node.may_be_absent) {
    const bool lost = axis.state.health != fieldbus::Health::absent;
    summary.condition = lost ? Condition::warning : Condition::well;
  }
  summary.text = words.problem.empty() ? plainText(axis) : words.problem.str();
  return summary;
}

}  // namespace cia402::bus
