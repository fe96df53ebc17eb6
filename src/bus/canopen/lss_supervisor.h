// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bus/axis_cycle.h"
#include "bus/canopen/bit_timing_switch.h"
#include "bus/canopen/lss_desk.h"
#include "bus/canopen/node_unit.h"
#include "bus/event.h"
#include "canopen/master.h"

namespace cia402::bus {

/// Sees to it by the layer setting services (CiA 305) that drives which the configuration names by
/// their identity have their node-IDs: at the start, when one comes back, and before one recovers.
class LssSupervisor {
 public:
  /// All must outlive the supervisor.
  LssSupervisor(canopen::Master& master, NodeUnits& nodes, AxisCycle& cycle, can::Sink& sink,
                EventSink& events);

  /// Begins to give out the node-IDs, before anything else. @return false if there are none
  bool begin();
  /// That is under way.
  bool starting() const { return starting_; }
  void receive(const can::Frame& frame, Time now) { desk_.receive(frame, now); }
  bool busy() const { return desk_.busy(); }
  Time deadline() const { return desk_.nextDeadline(); }
  /// @return true once the node-IDs of the start are given out: the nodes are to be booted
  bool tick(Time now);
  /// A drive that comes without a node-ID cannot announce itself by a boot-up message: while one is
  /// away, it is called by its identity now and then. To be called once a cycle.
  void lookForLostDrives(Time now) {
    if (now >= next_look_ && !desk_.busy()) lookNow(now);
  }
  /// Recovering begins with the node-ID where the drive may have lost it. @return true if so
  bool prepareRecovery(const std::vector<AxisUnit*>& units);
  /// Ends everything, for the reason `why`.
  void abandon(const std::string& why, Time now) {
    desk_.abandon(why, now);
    starting_ = false;
  }

  /// "LSS: inquiring its node-ID": what is done now; empty if nothing is.
  std::string step() const { return desk_.step(); }
  /// The same for one axis.
  std::string preparationOf(std::size_t axis) const;
  /// Node-IDs that must not be given to another device.
  std::vector<canopen::NodeId> nodesInOperation() const;
  LssDesk& desk() { return desk_; }
  can::Sink& sink() { return sink_; }
  BitTimingSwitch& bitTiming() { return bit_timing_; }
  const BitTimingSwitch& bitTiming() const { return bit_timing_; }

  /// A node that has got its node-ID is looked for once it has had the time to send its boot-up
  /// message.
  static void lookSoon(canopen::Node& node, Time now);

 private:
  /// At the start all nodes are reset afterwards; a look that finds nobody is no news.
  enum class Occasion : std::uint8_t { start, recover, look };

  void assign(NodeUnit& node, Occasion occasion);
  void assigned(NodeUnit& node, Occasion occasion, const canopen::LssAssignTask& task,
                const std::string& error, Time now);
  void tellAssigned(NodeUnit& node, const canopen::LssTask& task, const std::string& error,
                    Time now);
  void sayStart();
  void lookNow(Time now);

  canopen::Master& master_;
  NodeUnits& nodes_;
  AxisCycle& cycle_;
  can::Sink& sink_;
  EventSink& events_;
  LssDesk desk_;
  BitTimingSwitch bit_timing_;
  bool starting_ = false;  ///< drives get their node-IDs before anything else
  Time next_look_{};
};

}  // namespace cia402::bus
