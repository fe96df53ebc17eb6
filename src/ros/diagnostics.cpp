// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/ros/diagnostics.h"

#include <cmath>

#include "cia402_driver/bus/real_clock.h"
#include "cia402_driver/ros/publishers.h"

namespace cia402::ros_node {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kHighLoad = 0.8;  // share of the bit rate

std::string hardwareId(const bus::AxisSnapshot& axis, const drive::AxisConfig& config) {
  const std::uint32_t serial = axis.node.identity.serial;
  return serial != 0 ? std::to_string(serial)
                     : config.profile->name + " node " + std::to_string(config.node_id);
}

void addHex(diagnostic_updater::DiagnosticStatusWrapper& status, const char* key,
            std::uint32_t value) {
  status.addf(key, "0x%08X", value);
}

/// "0.153 rad", or "unknown".
std::string withUnit(double value, const char* unit) {
  if (std::isnan(value)) return "unknown";
  char text[48];
  std::snprintf(text, sizeof text, "%.6g %s", value, unit);
  return text;
}

}  // namespace

Diagnostics::Diagnostics(ros::NodeHandle& node, ros::NodeHandle& private_node,
                         bus::BusRunner& runner, const config::RobotConfig& robot)
    : runner_(runner), robot_(robot), snapshot_(runner.snapshot()), updater_(node, private_node) {
  updater_.setHardwareID(robot.bus.interface);
  updater_.add("bus", this, &Diagnostics::reportBus);
  for (std::size_t i = 0; i < robot.axes.size(); ++i) {
    const drive::AxisConfig& axis = robot.axes[i];
    updater_.add("node " + std::to_string(axis.node_id),
                 [this, i](Status& status) { reportNode(i, status); });
    updater_.add(axis.name, [this, i](Status& status) { reportAxis(i, status); });
  }
  timer_ = node.createTimer(ros::Duration(0.1), [this](const ros::TimerEvent&) {
    snapshot_ = runner_.snapshot();
    updater_.update();
  });
}

void Diagnostics::reportBus(Status& status) {
  const bus::CycleStatistics& cycle = snapshot_.statistics;
  if (snapshot_.bus_state == can::BusState::error_active) {
    status.summary(DiagnosticStatus::OK, snapshot_.bus_text.str());
  } else {
    const bool passing = snapshot_.bus_state == can::BusState::error_warning ||
                         snapshot_.bus_state == can::BusState::error_passive;
    status.summary(passing ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR,
                   snapshot_.bus_text.str());
  }
  if (snapshot_.bus_load > kHighLoad) {
    status.mergeSummaryf(DiagnosticStatus::WARN, "bus load %.0f %%", 100.0 * snapshot_.bus_load);
  }
  status.addf("state", "%s", can::toString(snapshot_.bus_state));
  status.addf("load", "%.1f %%", 100.0 * snapshot_.bus_load);
  status.add("frames sent", snapshot_.counters.frames_sent);
  status.add("frames received", snapshot_.counters.frames_received);
  status.add("frames deferred", snapshot_.counters.frames_deferred);
  status.add("frames dropped", snapshot_.counters.frames_dropped);
  status.add("error frames", snapshot_.counters.error_frames);
  status.add("bus-off events", snapshot_.counters.bus_off_events);
  status.addf("SYNC period", "%.3f ms", 1e3 * toSeconds(robot_.bus.sync_period));
  status.addf("SYNC lateness rms", "%.3f ms", 1e3 * cycle.rmsLateness());
  status.addf("SYNC lateness max", "%.3f ms", 1e3 * cycle.maxLateness());
  status.add("cycles", cycle.cycles());
  status.add("cycles skipped", cycle.overruns());
  status.add("SYNC missed", snapshot_.missed_syncs);
  status.add("SYNC of others", snapshot_.foreign_syncs);
  if (!snapshot_.sync_problem.empty()) {
    status.mergeSummary(DiagnosticStatus::ERROR, snapshot_.sync_problem.str());
  }
  status.add("real time", runner_.realtime().text);
}

void Diagnostics::reportNode(std::size_t index, Status& status) {
  const bus::AxisSnapshot& axis = snapshot_.axes[index];
  status.hardware_id = hardwareId(axis, robot_.axes[index]);
  const canopen::NodeHealth health = axis.state.health;
  if (health == canopen::NodeHealth::ready) {
    status.summary(DiagnosticStatus::OK, "configured and operational");
  } else if (health == canopen::NodeHealth::booting) {
    status.summary(DiagnosticStatus::WARN, "booting: " + axis.step.str());
  } else {
    status.summary(DiagnosticStatus::ERROR,
                   axis.problem.empty() ? canopen::toString(health) : axis.problem.str());
  }
  status.add("axis", robot_.axes[index].name);
  status.add("step", axis.step.str());
  status.add("drive", robot_.axes[index].profile->name);
  status.add("NMT state", canopen::toString(axis.node.nmt));
  addHex(status, "device type", axis.node.identity.device_type);
  addHex(status, "vendor id", axis.node.identity.vendor_id);
  addHex(status, "product code", axis.node.identity.product_code);
  addHex(status, "revision", axis.node.identity.revision);
  status.add("serial number", axis.node.identity.serial);
  if (axis.node.last_heartbeat == Time()) {
    status.add("heartbeat age", "none yet");
  } else {
    status.addf("heartbeat age", "%.3f s", toSeconds(snapshot_.now - axis.node.last_heartbeat));
  }
  status.add("boot-ups", axis.node.boot_ups);
  status.add("emergencies", axis.node.emergencies);
  status.add("feedback missed", axis.missed_feedback);
  status.add("feedback stale", axis.stale_feedback);
  status.add("feedback of wrong length", axis.wrong_lengths);
  if (!axis.stale.empty()) status.mergeSummary(DiagnosticStatus::WARN, axis.stale.str());
}

void Diagnostics::reportAxis(std::size_t index, Status& status) {
  const bus::AxisSnapshot& axis = snapshot_.axes[index];
  const drive::AxisConfig& config = robot_.axes[index];
  const drive::AxisState& state = axis.state;
  status.hardware_id = hardwareId(axis, config);
  const bool fault =
      state.state == drive::State::fault || state.state == drive::State::fault_reaction_active;
  if (!axis.problem.empty() || fault) {
    status.summary(DiagnosticStatus::ERROR,
                   axis.problem.empty() ? drive::toString(state.state) : axis.problem.str());
  } else if (state.health != canopen::NodeHealth::ready) {
    status.summary(DiagnosticStatus::WARN, "the drive is not ready");
  } else if (state.warning) {
    status.summary(DiagnosticStatus::WARN, "the drive shows a warning");
  } else {
    status.summary(DiagnosticStatus::OK, drive::toString(state.state));
  }
  const bool linear = config.geometry.type == drive::AxisGeometry::Type::prismatic;
  status.add("state", drive::toString(state.state));
  status.add("statusword", drive::statuswordText(state.statusword));
  status.add("mode", state.mode ? state.mode->name : "unknown");
  status.add("homed", state.homed ? "yes" : "no");
  status.addf("error code", "0x%04X", state.error_code);
  status.add("procedure", axis.procedure_running ? drive::toString(axis.procedure) : "none");
  status.add("step", stepText(axis));
  status.add("position", withUnit(state.position, linear ? "m" : "rad"));
  status.add("velocity", withUnit(state.velocity, linear ? "m/s" : "rad/s"));
  status.add("effort", withUnit(state.effort, linear ? "N" : "N m"));
  status.add("following error", withUnit(state.following_error, linear ? "m" : "rad"));
}

}  // namespace cia402::ros_node
