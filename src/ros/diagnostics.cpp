// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/diagnostics.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/console.h>

#include <cmath>
#include <optional>

#include "bus/axis_condition.h"
#include "bus/jobs/object_text.h"
#include "bus/link_findings.h"
#include "bus/node_condition.h"
#include "bus/real_clock.h"
#include "can/error_frame.h"
#include "common/text.h"
#include "decode/value_text.h"
#include "drive/profile/fault_text.h"
#include "drive/profile/status_bits.h"

namespace cia402::ros_node {
namespace {

using diagnostic_msgs::DiagnosticStatus;

unsigned char levelOf(bus::Condition condition) {
  switch (condition) {
    case bus::Condition::well:
      return DiagnosticStatus::OK;
    case bus::Condition::warning:
      return DiagnosticStatus::WARN;
    case bus::Condition::error:
      return DiagnosticStatus::ERROR;
    case bus::Condition::unheard:
      break;
  }
  return DiagnosticStatus::STALE;
}

std::string hardwareId(const bus::AxisSnapshot& axis, const drive::AxisConfig& config) {
  const std::uint32_t serial = axis.node.identity.serial;
  return serial != 0 ? std::to_string(serial) : config.profile->name + " " + config.place;
}

void addHex(diagnostic_updater::DiagnosticStatusWrapper& status, const char* key,
            std::uint32_t value) {
  status.add(key, hexText(value, 8));
}

/// "0.153 rad", or "unknown".
std::string withUnit(double value, const char* unit) {
  return std::isnan(value) ? "unknown" : numberText(value) + " " + unit;
}

/// A measured value and how old it is.
void addValue(diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& key,
              double value, const char* unit, Duration age) {
  status.add(key, withUnit(value, unit));
  status.add(key + " age", withUnit(std::isnan(value) ? value : toSeconds(age), "s"));
}

/// A value that the profile names to be shown, as read_object shows it, and how old it is.
void addSignal(diagnostic_updater::DiagnosticStatusWrapper& status, const drive::AxisConfig& axis,
               const drive::ShownSignal& signal, Duration age) {
  if (signal.object == nullptr) return;  // the drive lacks it
  const std::string& name = signal.object->name;
  const unsigned size = fieldbus::sizeBits(signal.object->type) / 8;
  status.add(
      name,
      !signal.known
          ? "unknown"
          : bus::describeObject(signal.object, axis, fieldbus::toBytes(signal.raw, size)).value);
  status.add(name + " age", signal.known ? withUnit(toSeconds(age), "s") : "unknown");
}

/// Digital inputs with the names of those that are active.
std::string inputsText(const drive::AxisConfig& axis, const drive::AxisState& state) {
  const drive::ObjectSpec* object = axis.profile->find("digital_inputs");
  if (!state.digital_inputs_valid || object == nullptr) return "unknown";
  const unsigned size = fieldbus::sizeBits(object->type) / 8;
  return bus::describeObject(object, axis, fieldbus::toBytes(state.digital_inputs, size)).value;
}

/// The joint's limits: "-2.65 to 2.5 rad, 1.5 rad/s, 4 rad/s^2, 240 N m".
std::string limitsText(const drive::AxisConfig& axis) {
  using drive::Quantity;
  const motion::JointLimits& limits = axis.limits;
  std::string text;
  if (limits.lower || limits.upper) {
    text = (limits.lower ? numberText(*limits.lower) : "no end") + " to " +
           (limits.upper ? numberText(*limits.upper) : "no end") + " " +
           decode::unitOf(Quantity::position, axis);
  }
  const auto add = [&](const std::optional<double>& limit, Quantity quantity) {
    if (limit) append(text, withUnit(*limit, decode::unitOf(quantity, axis)), ", ");
  };
  add(limits.velocity, Quantity::velocity);
  add(limits.acceleration, Quantity::acceleration);
  add(limits.jerk, Quantity::jerk);
  add(limits.effort, Quantity::torque);
  return text.empty() ? "none" : text;
}

/// What was wrong last, also where it is over.
void addLastError(diagnostic_updater::DiagnosticStatusWrapper& status, const bus::AxisWords& words,
                  Time now) {
  const bool any = !words.last.empty();
  status.add("last error", any ? words.last.str() : "none");
  status.add("last error age", any ? withUnit(toSeconds(now - words.last_at), "s") : "none");
}

/// How late SYNC was how often, a line for each band.
void addLateness(diagnostic_updater::DiagnosticStatusWrapper& status,
                 const bus::CycleStatistics& cycle) {
  const auto& bands = bus::CycleStatistics::kBands;
  status.addf("SYNC lateness rms", "%.3f ms", 1e3 * cycle.rmsLateness());
  status.addf("SYNC lateness max", "%.3f ms", 1e3 * cycle.maxLateness());
  for (std::size_t band = 0; band < bands.size(); ++band) {
    status.add("SYNC lateness up to " + numberText(1e3 * bands[band]) + " ms", cycle.inBand(band));
  }
  status.add("SYNC lateness above " + numberText(1e3 * bands.back()) + " ms",
             cycle.inBand(bands.size()));
}

/// "emergencies: 1234", then a line for each code.
void addEmergencies(diagnostic_updater::DiagnosticStatusWrapper& status,
                    const bus::EmergencyCounts& counts) {
  status.add("emergencies", counts.total);
  for (std::size_t i = 0; i < counts.codes; ++i) {
    status.add("emergencies " + hexText(counts.of[i].code, 4), counts.of[i].count);
  }
  if (counts.malformed != 0) status.add("emergencies malformed", counts.malformed);
}

/// What goes wrong on the bus, by kind.
void addBusHealth(diagnostic_updater::DiagnosticStatusWrapper& status,
                  const bus::NetworkSnapshot& snapshot) {
  const can::BusCounters& counters = snapshot.counters;
  status.add("restarts after bus-off", counters.restarts);
  status.add("restart attempts of the driver", counters.restart_attempts);
  status.add("frames stale", counters.frames_stale);
  status.add("frames waiting", snapshot.pending);
  status.add("receive overflows", counters.receive_overflows);
  for (std::size_t bit = 0; bit < counters.error_classes.size(); ++bit) {
    if (counters.error_classes[bit] == 0) continue;
    status.add(std::string("error frames, ") + can::errorClassName(bit),
               counters.error_classes[bit]);
  }
  if (snapshot.error_counters) {
    status.addf("error counters", "transmit %u, receive %u", snapshot.error_counters->transmit,
                snapshot.error_counters->receive);
  }
}

/// What the kernel says of the interface.
void addLink(diagnostic_updater::DiagnosticStatusWrapper& status, const can::LinkSettings& link) {
  status.add("interface kind", link.kind.empty() ? "unknown" : link.kind);
  if (link.tx_queue_length) status.add("txqueuelen", *link.tx_queue_length);
  if (link.bitrate) status.add("bit rate", *link.bitrate);
  if (link.sample_point) status.addf("sample point", "%.1f %%", 100.0 * *link.sample_point);
  if (link.restart_ms) status.add("restart-ms", *link.restart_ms);
  if (link.controller) status.add("controller state", can::toString(*link.controller));
  if (link.transmit_errors && link.receive_errors) {
    status.addf("controller error counters", "transmit %u, receive %u",
                static_cast<unsigned>(*link.transmit_errors),
                static_cast<unsigned>(*link.receive_errors));
  }
  if (!link.events) return;
  status.add("berr-reporting", link.error_reporting ? "on" : "off");
  status.add("bus-offs (kernel)", link.events->bus_offs);
  status.add("restarts (kernel)", link.events->restarts);
  status.add("arbitration lost (kernel)", link.events->arbitration_lost);
  status.add("bus errors (kernel)", link.events->bus_errors);
}

void addSdo(diagnostic_updater::DiagnosticStatusWrapper& status,
            const canopen::SdoClient::Counters& sdo) {
  status.addf(
      "SDO transfers", "%llu done, %llu aborted, %llu time-outs, %llu repeated",
      static_cast<unsigned long long>(sdo.completed), static_cast<unsigned long long>(sdo.aborted),
      static_cast<unsigned long long>(sdo.timeouts), static_cast<unsigned long long>(sdo.retries));
  status.addf("SDO answer time", "%.3f ms mean, %.3f ms longest",
              1e3 * toSeconds(sdo.meanLatency()), 1e3 * toSeconds(sdo.longest_latency));
  status.addf("SDO throughput", "%.0f B/s", sdo.throughput());
  status.add("SDO frames out of place", sdo.stray_frames);
}

}  // namespace

Diagnostics::Diagnostics(ros::NodeHandle& node, ros::NodeHandle& private_node,
                         bus::BusRunner& runner, LinkWatch& link, const config::RobotConfig& robot)
    : runner_(runner),
      robot_(robot),
      snapshot_(runner.snapshot()),
      link_(link),
      updater_(node, private_node),
      topic_(node.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1)) {
  updater_.setHardwareID(robot.bus.interface);
  updater_.add("bus", this, &Diagnostics::reportBus);
  std::size_t nodes = 0;
  for (std::size_t i = 0; i < robot.axes.size(); ++i) {
    const drive::AxisConfig& axis = robot.axes[i];
    if (axis.device == nodes) {  // devices are in the order of their first axes
      ++nodes;
      updater_.add("node " + std::to_string(robot.deviceOf(axis).node_id),
                   [this, i](Status& status) { reportNode(i, status); });
    }
    updater_.add(axis.name, [this, i](Status& status) { reportAxis(i, status); });
  }
}

void Diagnostics::update() {
  snapshot_ = runner_.snapshot();
  skipped_.look(snapshot_.statistics.overruns(), snapshot_.now);
  link_.update(snapshot_);
  updater_.update();
}

void Diagnostics::reportBus(Status& status) {
  if (topic_.getNumSubscribers() > 0) runner_.look();  // what the next report will show
  const bus::CycleStatistics& cycle = snapshot_.statistics;
  const can::TrafficMeter::Load load = link_.load(snapshot_);
  const bus::Summary summary = bus::busSummaryOf(snapshot_, load.nominal, skipped_.lately());
  status.summary(levelOf(summary.condition), summary.text);
  status.addf("state", "%s", can::toString(snapshot_.bus_state));
  status.addf("load", "%.1f %%, %.1f %% with all stuff bits that are possible",
              100.0 * load.nominal, 100.0 * load.most);
  status.add("frames sent", snapshot_.counters.frames_sent);
  status.add("frames received", snapshot_.counters.frames_received);
  status.add("frames deferred", snapshot_.counters.frames_deferred);
  status.add("frames dropped", snapshot_.counters.frames_dropped);
  status.add("error frames", snapshot_.counters.error_frames);
  status.add("bus-off events", snapshot_.counters.bus_off_events);
  status.add("interface losses", snapshot_.counters.interface_losses);
  addBusHealth(status, snapshot_);
  reportLink(status);
  status.addf("SYNC period", "%.3f ms", 1e3 * toSeconds(robot_.bus.sync_period));
  addLateness(status, cycle);
  if (robot_.bus.interface == "sim") {
    status.addf("simulation behind the clock", "%.3f s", toSeconds(runner_.time().lost()));
  }
  status.add("cycles", cycle.cycles());
  status.add("cycles skipped", cycle.overruns());
  status.add("failures not recorded", runner_.recordings().suppressed());
  status.add("SYNC missed", snapshot_.missed_syncs);
  status.add("SYNC of others", snapshot_.foreign_syncs);
  status.add("real time", runner_.realtime().text);
}

void Diagnostics::reportLink(Status& status) {
  if (robot_.bus.interface == "sim") return;
  const auto& link = link_.settings();
  if (!link) return;
  addLink(status, *link);
  const auto findings = bus::linkFindings(*link, robot_, can::mayConfigureLinks());
  for (const can::LinkFinding& finding : findings) {
    status.mergeSummary(levelOf(bus::conditionOf(finding)), finding.text);
    if (!findings_told_.insert(finding.text).second) continue;
    if (finding.error) {
      ROS_ERROR_STREAM(finding.text);
    } else {
      ROS_WARN_STREAM(finding.text);
    }
  }
}

void Diagnostics::reportNode(std::size_t index, Status& status) {
  const bus::AxisSnapshot& axis = snapshot_.axes[index];
  status.hardware_id = hardwareId(axis, robot_.axes[index]);
  const bus::Summary summary = bus::nodeSummaryOf(axis);
  status.summary(levelOf(summary.condition), summary.text);
  const canopen::Node::Supervision& supervision = axis.node.supervision;
  const bool ready = axis.state.health == fieldbus::Health::ready;
  status.add("boot", ready ? axis.words.boot.str() : axis.words.step.str());
  status.add("error control", canopen::toString(supervision.kind));
  status.add("notices a dead master", supervision.watches_master ? "yes" : "no");
  status.add("axis", robot_.axes[index].name);
  status.add("step", axis.words.step.str());
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
  addSdo(status, axis.node.sdo);
  status.add("boot-ups", axis.node.boot_ups);
  addEmergencies(status, axis.emergencies);
  status.add("feedback missed", axis.missed_feedback);
  status.add("feedback stale", axis.stale_feedback);
  status.add("feedback of wrong length", axis.wrong_lengths);
}

void Diagnostics::reportAxis(std::size_t index, Status& status) {
  const bus::AxisSnapshot& axis = snapshot_.axes[index];
  const drive::AxisConfig& config = robot_.axes[index];
  const drive::AxisState& state = axis.state;
  status.hardware_id = hardwareId(axis, config);
  const bus::Summary summary = bus::summaryOf(axis, config.profile->warning_stops);
  status.summary(levelOf(summary.condition), summary.text);
  status.add("state", drive::toString(state.state));
  status.add("statusword",
             drive::statusBitsText(state.statusword, state.mode, config.profile->status_words));
  status.add("mode", state.mode ? state.mode->name : "unknown");
  status.add("halted", state.halted ? "yes" : "no");
  status.add("homed", state.homed ? "yes" : "no");
  status.add("limits", limitsText(config));
  status.add("internal limit active", state.internal_limit ? "yes" : "no");
  status.add("error code", hexText(state.error_code, 4));
  status.add("procedure", axis.procedure_running ? drive::toString(axis.procedure) : "none");
  status.add("step", axis.words.step.str());
  status.add("waits for",
             axis.words.waiting_for.empty() ? "nothing" : axis.words.waiting_for.str());
  addLastError(status, axis.words, snapshot_.now);
  if (!axis.words.history.empty())
    status.add("error history after the last fault", axis.words.history.str());
  using drive::Quantity;
  const auto add = [&](const char* key, double value, Quantity quantity, Time stamp) {
    addValue(status, key, value, decode::unitOf(quantity, config), snapshot_.now - stamp);
  };
  add("position", state.position, Quantity::position, state.stamp);
  add("velocity", state.velocity, Quantity::velocity, state.stamps.velocity);
  add("effort", state.effort, Quantity::torque, state.stamps.effort);
  add("following error", state.following_error, Quantity::distance, state.stamps.following_error);
  status.add("digital inputs", inputsText(config, state));
  for (const drive::ShownSignal& signal : axis.signals) {
    addSignal(status, config, signal, snapshot_.now - signal.stamp);
  }
}

}  // namespace cia402::ros_node
