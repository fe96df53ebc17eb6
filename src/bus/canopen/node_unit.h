// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bus/axis_cycle.h"
#include "bus/event.h"
#include "canopen/device_config.h"
#include "canopen/node/node.h"

namespace cia402::bus {

/// A CANopen node with the axes that sit in it, and what people are told of the node itself: its
/// boot, its loss, its PDOs, what it keeps of its past.
class NodeUnit {
 public:
  /// Identifiers that receive filters pass.
  using Foreseen = std::bitset<2048>;

  /// All must outlive the unit.
  NodeUnit(canopen::Node& node, const canopen::DeviceConfig& config, AxisCycle& cycle,
           EventSink& events)
      : node_(&node), config_(&config), cycle_(&cycle), events_(&events) {}
  void add(AxisUnit& axis) { axes_.push_back({&axis, Time()}); }

  canopen::Node& node() const { return *node_; }
  const canopen::DeviceConfig& config() const { return *config_; }
  /// The first axis in it.
  AxisUnit& axis() const { return *axes_.front().unit; }
  bool empty() const { return axes_.empty(); }
  template <typename Use>
  void forEachAxis(Use&& use) const {
    for (const Entry& entry : axes_) use(*entry.unit);
  }

  /// Once a cycle for each of its axes.
  void watch(AxisUnit& axis, Time now) {
    // Failed PDOs that are shown are looked at again.
    if (node_->image().troubles() != troubles_ || !axis.news.words().stale.empty()) watchPdos(now);
    if (axis.news.faultUnexplained()) readHistory(axis, now);
  }
  void onBootUp(Time now);
  void onHealthChange(Time now);
  /// @param excuse how this program itself has caused it, in words; empty: it has not
  void onEmergency(const fieldbus::Emergency& emergency, const std::string& excuse, Time now);
  void onMalformedEmergency(std::size_t size, Time now);

  /// What is shown of the node in the snapshot of each of its axes.
  void fill(AxisSnapshot& snapshot, const Foreseen& foreseen) const {
    const canopen::PdoImage& image = node_->image();
    snapshot.stale_feedback = image.staleCount();
    snapshot.wrong_lengths = image.wrongLengths();
    if (snapshot.node.changes != node_->changes()) fillNode(snapshot.node, foreseen);
  }

 private:
  [[gnu::cold]] void fillNode(NodeSnapshot& snapshot, const Foreseen& foreseen) const;

  struct Entry {
    AxisUnit* unit = nullptr;
    Time history_asked{};  ///< Time() if it was not
  };

  void tellBooted(Time now);
  [[gnu::cold]] void watchPdos(Time now);
  [[gnu::cold]] void readHistory(AxisUnit& axis, Time now);

  canopen::Node* node_;
  const canopen::DeviceConfig* config_;
  AxisCycle* cycle_;
  EventSink* events_;
  std::vector<Entry> axes_;
  Time boot_began_{};
  unsigned boot_ups_ = 0;  ///< messages since the last boot that succeeded
  // Of the TPDOs, as told last:
  std::uint64_t stale_count_ = 0, wrong_lengths_ = 0;
  std::uint64_t troubles_ = 0;  ///< both together
  Time pdos_told_ = Time::min();
};

/// The nodes of a bus.
class NodeUnits {
 public:
  /// In the order of the master's nodes; all of them before addAxis() for each axis in its order.
  void add(NodeUnit node) { all_.push_back(std::move(node)); }
  void addAxis(std::size_t node, AxisUnit& axis) {
    all_[node].add(axis);
    of_axis_.push_back(&all_[node]);
  }

  std::vector<NodeUnit>& all() { return all_; }
  const std::vector<NodeUnit>& all() const { return all_; }
  /// The node that an axis sits in. @param axis index in the configuration
  NodeUnit& ofAxis(std::size_t axis) { return *of_axis_[axis]; }
  const NodeUnit& ofAxis(std::size_t axis) const { return *of_axis_[axis]; }

 private:
  std::vector<NodeUnit> all_;
  std::vector<NodeUnit*> of_axis_;  // into all_
};

}  // namespace cia402::bus
