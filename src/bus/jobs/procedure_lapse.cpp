// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/procedure_lapse.h"

#include <cmath>

#include "motion/joint.h"

namespace cia402::bus {

std::string motionOf(const drive::AxisState& state) {
  if (!state.feedback_valid) return "nothing tells whether it stands";
  if (std::isnan(state.velocity)) return "it moves";
  return "it moves (velocity " + motion::formatNumber(state.velocity) + ")";
}

bool tellsWhatItIs(drive::ProcedureKind kind) {
  using drive::ProcedureKind;
  return kind == ProcedureKind::clear_faults || kind == ProcedureKind::set_mode ||
         kind == ProcedureKind::home || kind == ProcedureKind::set_position;
}

std::string lapse(const drive::ProcedureRequest& request, const drive::Axis& axis, bool replaced) {
  using drive::ProcedureKind;
  const drive::AxisState& state = axis.state();
  const std::string began =
      drive::jointName(axis.config()) + ": " + toString(request.kind) + " had succeeded, ";
  const std::string cause = replaced
                                ? began + "but " + toString(axis.procedure().kind) + " was called: "
                                : began + "but ";
  const bool enabled = state.state == drive::State::operation_enabled;
  const std::string now = std::string("it is ") + toString(state.state);
  if (tellsWhatItIs(request.kind) && !state.feedback_valid) {
    return cause + "it gives no fresh statusword and position any more: recover";
  }
  switch (request.kind) {
    case ProcedureKind::recover:
      return axis.obstacle();
    case ProcedureKind::enable:
      return enabled ? std::string() : cause + now;
    case ProcedureKind::disable:
      if (!powerStageOff(state.state, state.statusword)) return cause + now;
      return axis.mayMove() ? cause + motionOf(state) : std::string();
    case ProcedureKind::clear_faults:
      return isFault(state.state) ? cause + now : std::string();
    case ProcedureKind::home:
    case ProcedureKind::set_position:
      return state.homed ? std::string() : cause + "it is not homed";
    case ProcedureKind::set_mode:
      if (axis.modeName() == drive::canonicalModeName(request.mode)) return {};
      return cause + "it is in mode " + axis.modeName();
    case ProcedureKind::halt:
    case ProcedureKind::quick_stop:
      if (replaced && enables(axis.procedure().kind)) return cause + now;
      return axis.mayMove() ? cause + motionOf(state) : std::string();
    default:
      return {};
  }
}

}  // namespace cia402::bus
