// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "bus/axis_reporter.h"
#include "bus/axis_words.h"
#include "bus/cycle_statistics.h"
#include "bus/fixed_text.h"
#include "can/bus.h"
#include "canopen/nmt/nmt.h"
#include "canopen/node/node.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// The node of an axis as the last cycle left it.
struct NodeSnapshot {
  std::uint32_t changes = 0;  ///< canopen::Node::changes() at that time
  canopen::NmtState nmt = canopen::NmtState::unknown;
  Time last_heartbeat{};                   ///< Time() if there was none
  std::uint32_t boot_ups = 0;              ///< since start
  canopen::Node::Identity identity;        ///< zeros where not read
  canopen::Node::Supervision supervision;  ///< as found at the last boot
  bool may_be_absent = false;              ///< `optional`, and absent or lost
  bool own_cob_ids = false;                ///< it insists on COB-IDs that no receive filter passes
  canopen::SdoClient::Counters sdo;        ///< since start
};

/// One axis as the last cycle left it.
struct AxisSnapshot {
  drive::AxisState state;
  NodeSnapshot node;
  EmergencyCounts emergencies;
  double target = drive::kUnknown;  ///< set-point of the active mode, joint units
  drive::ProcedureKind procedure = drive::ProcedureKind::none;
  bool procedure_running = false;
  Time procedure_deadline{};          ///< when it is given up at the latest
  std::uint64_t missed_feedback = 0;  ///< cycles without a new TPDO while the node was ready
  std::uint64_t stale_feedback = 0;   ///< how often a TPDO was overdue, see PdoConfig::stale_after
  std::uint64_t wrong_lengths = 0;    ///< TPDOs that were too short or too long
  std::vector<drive::ShownSignal> signals;  ///< of its profile, once somebody has looked
  std::uint32_t signals_version = 0;        ///< grows with each change of these
  AxisWords words;
};

/// One joint as the last cycle left it, as people are shown it.
struct JointState {
  bool known = false;                 ///< its position is
  Time stamp{};                       ///< when that was on the wire
  double position = drive::kUnknown;  ///< rad or m
  double velocity = drive::kUnknown;  ///< rad/s or m/s
  double effort = drive::kUnknown;    ///< N m or N
  double desired = drive::kUnknown;   ///< position set-point, rad or m; in other modes unknown
  double desired_velocity = drive::kUnknown;  ///< of that, rad/s or m/s
};

/// The trajectory of one group.
struct GroupSnapshot {
  bool executing = false;
  bool stopping = false;
};

/// Everything the ROS side shows, taken once a cycle.
struct NetworkSnapshot {
  Time now{};
  can::BusState bus_state = can::BusState::missing;
  can::BusCounters counters;
  FixedText<512> bus_text;
  std::size_t pending = 0;  ///< frames that wait in the driver
  std::optional<can::Interface::ErrorCounters> error_counters;
  double bus_load = 0.0;       ///< share of the bit rate over the last second, without stuff bits
  double most_bus_load = 0.0;  ///< with as many stuff bits as the frames could need
  CycleStatistics statistics;
  FixedText<256> sync_problem;      ///< why SYNC is not as it must be, or not sent; empty if well
  std::uint64_t missed_syncs = 0;   ///< of an external producer
  std::uint64_t foreign_syncs = 0;  ///< of others, while the driver produces SYNC
  bool shut_down = false;
  std::vector<AxisSnapshot> axes;     ///< in configuration order
  std::vector<JointState> joints;     ///< in the order of config::RobotConfig::joints()
  std::vector<GroupSnapshot> groups;  ///< in configuration order
};

}  // namespace cia402::bus
