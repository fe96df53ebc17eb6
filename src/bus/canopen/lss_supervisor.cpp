// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/lss_supervisor.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace cia402::bus {
namespace {

using fieldbus::Health;

constexpr Duration kLookInterval = std::chrono::seconds(5);
constexpr int kLookAttempts = 2;  // as it is looked for again anyway
/// After which one that boots has sent its boot-up message; the others are asked.
constexpr Duration kBootUpTime = std::chrono::milliseconds(500);

/// It failed, or was taken out of operation, and its heartbeat has ended since.
bool fellSilent(const canopen::Node& node, Time now) {
  return node.health() == Health::failed &&
         node.supervision().kind == canopen::ErrorControl::heartbeat &&
         now > node.lastHeartbeat() + node.config().heartbeat_timeout;
}

}  // namespace

LssSupervisor::LssSupervisor(canopen::Master& master, NodeUnits& nodes, AxisCycle& cycle,
                             can::Sink& sink, EventSink& events)
    : master_(master),
      nodes_(nodes),
      cycle_(cycle),
      sink_(sink),
      events_(events),
      desk_(sink),
      bit_timing_(desk_, nodes, cycle) {}

void LssSupervisor::lookSoon(canopen::Node& node, Time now) { node.look(now + kBootUpTime); }

std::vector<canopen::NodeId> LssSupervisor::nodesInOperation() const {
  std::vector<canopen::NodeId> ids = {master_.config().node_id};
  for (const canopen::Node& node : master_.nodes()) {
    const bool silent = !node.everHeard() || fellSilent(node, cycle_.now());
    if (!fieldbus::isAway(node.health()) && !silent) ids.push_back(node.id());
  }
  return ids;
}

/// Gives a node its node-ID.
void LssSupervisor::assign(NodeUnit& node, Occasion occasion) {
  canopen::LssAssignTask::Options options;
  const canopen::DeviceConfig& device = node.config();
  options.identity = device.lss->identity;
  options.node_id = device.node_id;
  options.store = device.lss->store;
  options.reset = occasion != Occasion::start;
  if (options.reset) options.in_use = [this] { return nodesInOperation(); };
  if (occasion == Occasion::look) options.attempts = kLookAttempts;
  desk_.add(
      device.name, std::make_unique<canopen::LssAssignTask>(std::move(options), sink_),
      [this, &node, occasion](const canopen::LssTask& task, const std::string& error, Time now) {
        assigned(node, occasion, static_cast<const canopen::LssAssignTask&>(task), error, now);
      });
}

void LssSupervisor::assigned(NodeUnit& node, Occasion occasion, const canopen::LssAssignTask& task,
                             const std::string& error, Time now) {
  if (cycle_.shutdown().begun()) return;
  if (occasion != Occasion::start && error.empty()) lookSoon(node.node(), now);
  const bool news = error.empty() ? task.changed() : !task.absent();
  if (news || occasion != Occasion::look) tellAssigned(node, task, error, now);
}

void LssSupervisor::tellAssigned(NodeUnit& node, const canopen::LssTask& task,
                                 const std::string& error, Time now) {
  const bool success = error.empty();
  const std::string text =
      drive::whoIs(node.axis().axis.config()) + ": LSS: " + (success ? task.result() : error);
  const bool known = !success && node.axis().news.cause() == text;
  node.forEachAxis([&](AxisUnit& axis) { axis.news.setCause(success ? std::string() : text); });
  if (!known) tell(events_, success ? Event::Severity::info : Event::Severity::error, text, now);
}

bool LssSupervisor::begin() {
  for (NodeUnit& node : nodes_.all()) {
    if (node.config().lss) assign(node, Occasion::start);
  }
  starting_ = desk_.busy();
  return starting_;
}

bool LssSupervisor::tick(Time now) {
  desk_.tick(now);
  if (starting_) sayStart();
  if (desk_.busy()) return false;
  if (std::exchange(starting_, false)) return true;
  cycle_.jobs().release();
  return false;
}

void LssSupervisor::sayStart() {
  for (AxisUnit& unit : cycle_.units()) {
    const std::string step = preparationOf(unit.index);
    const bool waits = step.empty() && desk_.busy();
    unit.news.say(&AxisWords::step, waits ? "LSS: waiting for its turn" : step);
    unit.news.say(&AxisWords::problem, unit.news.cause());
  }
}

std::string LssSupervisor::preparationOf(std::size_t axis) const {
  const bool its = desk_.busy() && desk_.who() == nodes_.ofAxis(axis).config().name;
  return its ? desk_.step() : std::string();
}

/// Not by "identify non-configured remote slave" (4Ch), which many slaves do not know (CANopenNode,
/// 305/CO_LSSslave.c).
void LssSupervisor::lookNow(Time now) {
  next_look_ = now + kLookInterval;
  if (cycle_.shutdown().begun()) return;
  for (NodeUnit& node : nodes_.all()) {
    const bool away = fieldbus::isAway(node.axis().axis.state().health);
    if (node.config().lss && away) assign(node, Occasion::look);
  }
}

bool LssSupervisor::prepareRecovery(const std::vector<AxisUnit*>& units) {
  bool needed = false;
  for (NodeUnit& node : nodes_.all()) {
    const Health health = node.axis().axis.state().health;
    const bool there = health == Health::booting || health == Health::ready;
    if (!node.config().lss || there) continue;
    const bool concerned = std::any_of(units.begin(), units.end(), [&](const AxisUnit* unit) {
      return &nodes_.ofAxis(unit->index) == &node;
    });
    if (!concerned) continue;
    assign(node, Occasion::recover);
    needed = true;
  }
  return needed;
}

}  // namespace cia402::bus
