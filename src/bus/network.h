// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bus/axis_cycle.h"
#include "bus/bus_side.h"
#include "bus/canopen/sync_supervisor.h"
#include "bus/command.h"
#include "bus/cycle_statistics.h"
#include "bus/event.h"
#include "bus/snapshot.h"
#include "canopen/master.h"
#include "config/robot.h"

namespace cia402::bus {

class LssSupervisor;
class NodeUnit;
class NodeUnits;
class StartUp;

/// Everything on one CAN bus: the CANopen master with its nodes, what sees to SYNC, node-IDs and
/// the start, and the cycle of the axes. Sans-IO: BusRunner runs it in real time, tests run it in
/// virtual time. One thread.
///
/// SYNC leaves at its absolute deadline before anything is computed; half a period later the
/// feedback is decoded, motion computed and the RPDOs sent, in time for the next SYNC.
class Network final : private canopen::MasterListener, private BusSide {
 public:
  /// @param robot valid configuration, @param master made from it by config::makeMasterConfig.
  /// @param sink where frames go, @param events where news go; both must outlive the network.
  Network(config::RobotConfig robot, canopen::MasterConfig master, can::Sink& sink,
          EventSink& events);
  ~Network() override;
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// To be called once the bus is there; nothing is sent before. Begins to boot the drives and to
  /// cycle once no other master has been heard for BusConfig::listen.
  void start(Time now);
  bool started() const { return phase_ != Phase::waiting; }
  /// A frame from the bus. @param stamp when it was on the wire.
  void receive(const can::Frame& frame, Time stamp, Time now);
  /// Tells the wall-clock time, for TIME messages (`bus: {time_interval: ...}`).
  void setWallTime(canopen::UnixTime wall, Time now) { master_.setWallTime(wall, now); }
  /// Sends SYNC if it is due; before frames that wait are taken in.
  void produceSync(Time now);
  /// Does all that is due: SYNC, cycle, time-outs, procedures; after the frames that came before.
  void tick(Time now);
  /// When tick() is due at the latest.
  Time nextDeadline() const;

  /// No frame leaves any more, for the reason `why` ("can0 is bus-off"): motion ends, axes are not
  /// enabled when the bus comes back, commands are refused until then.
  void busLost(const std::string& why, Time now);
  /// Frames leave again. @param is_news whether people are told.
  void busBack(bool is_news, Time now);

  /// Carries out a command; its reply may come at once or when a job has ended.
  void execute(Command command, Time now);

  /// Ends everything in good order: motion is ramped down, the axes are disabled, the drives go
  /// pre-operational; done after 1.8 s at the latest, see shutDown(). What a driver that is gone
  /// may have left turning is stopped, too; where another master is on the bus nothing is sent.
  void beginShutdown(Time now);
  bool shutDown() const { return cycle_.shutdown().done(); }

  /// Writes the state of everything but the bus interface. Allocates only if `snapshot` has not
  /// got the right sizes yet.
  void fill(NetworkSnapshot& snapshot) const;

  const config::RobotConfig& config() const { return config_; }
  AxisCycle& cycle() { return cycle_; }
  const AxisCycle& cycle() const { return cycle_; }
  drive::Axis& axis(std::size_t index) { return cycle_.units()[index].axis; }
  const drive::Axis& axis(std::size_t index) const { return cycle_.units()[index].axis; }
  /// The node that an axis sits in. @param axis index in the configuration
  canopen::Node& node(std::size_t axis);
  NodeUnits& nodes() { return *nodes_; }
  LssSupervisor& lss() { return *lss_; }
  canopen::Master& master() { return master_; }
  const canopen::Master& master() const { return master_; }
  const CycleStatistics& statistics() const { return sync_.statistics(); }
  /// The time it was given last.
  Time now() const { return cycle_.now(); }
  void tell(Event::Severity severity, std::string_view text, Time now) {
    bus::tell(events_, severity, text, now);
  }

 private:
  void onEmergency(canopen::Node& node, const fieldbus::Emergency& emergency) override;
  void onMalformedEmergency(canopen::Node& node, std::size_t size) override;
  void onSdoAnswer(canopen::Node& node) override;
  void onBootUp(canopen::Node& node, Time now) override;
  void onHealthChange(canopen::Node& node, fieldbus::Health before, Time now) override;
  void onForeignSync(const can::Frame& frame, Time stamp, Time now) override;

  std::string enableProblem() const override;
  std::string preparationOf(std::size_t axis) const override;
  bool prepareRecovery(const std::vector<AxisUnit*>& units) override;
  void releaseDevices(Time now) override;

  enum class Phase : std::uint8_t {
    waiting,    ///< for the bus
    listening,  ///< for another master
    running,    ///< SYNC, cycle and time-outs, unless node-IDs are being given out
    ended       ///< nothing is sent any more
  };

  std::vector<AxisUnit::Place> places();
  void addNodes();
  /// nullptr if no axis sits in it.
  NodeUnit* unitOf(const canopen::Node& node);
  void listen(Time now);
  void beginSending(Time now);
  void boot(Time now);
  void act(Time now);
  void stepCycle(Time now);
  /// Why a command that needs the bus is not carried out; empty if it is.
  std::string refusal() const;

  config::RobotConfig config_;
  EventSink& events_;
  std::bitset<2048> foreseen_;  ///< identifiers that receive filters pass
  canopen::Master master_;
  AxisCycle cycle_;
  SyncSupervisor sync_;
  std::unique_ptr<NodeUnits> nodes_;
  std::unique_ptr<LssSupervisor> lss_;
  std::unique_ptr<StartUp> start_up_;
  std::string bus_lost_;  ///< why; empty: it is there
  Phase phase_ = Phase::waiting;
};

}  // namespace cia402::bus
