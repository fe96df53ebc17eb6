// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the ROS side is shown of a robot.
#include <algorithm>

#include "cia402_driver/bus/robot.h"

namespace cia402::bus {
namespace {

/// Boot has found a COB-ID that canopen::receivedIdentifiers() did not foresee.
bool hasOwnCobIds(const canopen::Node& node, const std::bitset<2048>& foreseen) {
  const auto& tpdos = node.image().tpdos();
  return std::any_of(tpdos.begin(), tpdos.end(), [&](const canopen::PdoImage::Pdo& pdo) {
    return pdo.cob_id < foreseen.size() && !foreseen[pdo.cob_id];
  });
}

NodeSnapshot nodeSnapshot(const canopen::Node& node, const std::bitset<2048>& foreseen) {
  NodeSnapshot snapshot;
  snapshot.changes = node.changes();
  snapshot.nmt = node.nmtState();
  snapshot.last_heartbeat = node.lastHeartbeat();
  snapshot.boot_ups = node.bootUps();
  if (node.identity()) snapshot.identity = *node.identity();
  snapshot.supervision = node.supervision();
  snapshot.sdo = node.sdo().counters();
  snapshot.may_be_absent = node.excused();
  snapshot.own_cob_ids = hasOwnCobIds(node, foreseen);
  return snapshot;
}

}  // namespace

void Robot::fill(RobotSnapshot& snapshot) const {
  snapshot.now = now_;
  snapshot.statistics = statistics_;
  snapshot.shut_down = shutDown();
  snapshot.sync_problem = sync_problem_;
  snapshot.missed_syncs = external_sync_.missed();
  snapshot.foreign_syncs = foreign_syncs_;
  snapshot.axes.resize(axes_.size());
  snapshot.groups.resize(groups_.size());
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    AxisSnapshot& axis = snapshot.axes[i];
    axis.state = axes_[i].state();
    axis.target = axes_[i].target();
    const canopen::Node& node = *nodes_[i];
    if (axis.node.changes != node.changes()) axis.node = nodeSnapshot(node, foreseen_);
    const EmergencyCounts& emergencies = reporters_[i].emergencies();
    const bool more = axis.emergencies.total != emergencies.total ||
                      axis.emergencies.malformed != emergencies.malformed;
    if (more) axis.emergencies = emergencies;  // counts of every code: not for every cycle
    axis.procedure = axes_[i].procedure().kind;
    axis.procedure_running = axes_[i].procedure().running;
    axis.missed_feedback = missed_feedback_[i];
    axis.stale_feedback = node.image().staleCount();
    axis.wrong_lengths = node.image().wrongLengths();
    if (axis.words.version != news_[i].words.version) axis.words = news_[i].words;
  }
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    snapshot.groups[i] = {groups_[i].executing(), groups_[i].stopping()};
  }
}

}  // namespace cia402::bus
