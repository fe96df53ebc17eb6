// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/node_condition.h"

namespace cia402::bus {
namespace {

using fieldbus::Health;

Summary ofReady(const AxisSnapshot& axis) {
  const canopen::Node::Supervision& supervision = axis.node.supervision;
  Summary summary{Condition::well, "configured and operational"};
  if (!supervision.watched) {
    summary.add(Condition::warning, "its loss would show in missing TPDOs only");
  }
  if (!supervision.watches_master) {
    summary.add(Condition::warning, "it cannot notice a dead master");
  }
  if (!axis.words.stale.empty()) summary.add(Condition::warning, axis.words.stale.str());
  return summary;
}

/// Of one that is not ready, and about which something is said.
Condition conditionOf(const AxisSnapshot& axis) {
  if (!axis.node.may_be_absent) return Condition::error;
  return axis.state.health == Health::absent ? Condition::well : Condition::warning;
}

}  // namespace

Summary nodeSummaryOf(const AxisSnapshot& axis) {
  const Health health = axis.state.health;
  if (health == Health::ready) return ofReady(axis);
  if (health == Health::booting) {
    return {Condition::warning, "booting: " + axis.words.step.str()};
  }
  if (!axis.words.problem.empty()) return {conditionOf(axis), axis.words.problem.str()};
  if (health == Health::absent) {
    return {Condition::warning, "not heard yet: " + axis.words.step.str()};
  }
  return {conditionOf(axis), fieldbus::toString(health)};
}

}  // namespace cia402::bus
