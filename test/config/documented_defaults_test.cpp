// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A default in docs/configuration.md is what the loader makes of a key that is not given.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "common/text.h"
#include "config/key_tables.h"
#include "config/loaded.h"

namespace cia402::config {
namespace {

/// Every section that there is, and as little in it as may be.
constexpr const char* kEmptySections = R"(
bus: {interface: can0}
recorder: {}
axes:
  a: {node_id: 1, drive: generic_cia402, counts_per_turn: 1000, homing: {method: 17}, boot: {},
      error_control: {}, simulation: {}, frame: {parent: base, child: tip}}
groups: {g: {joints: [a], constraints: {a: {}}}}
)";

std::string yesNo(bool value) { return value ? "true" : "false"; }
std::string seconds(Duration value) { return numberText(toSeconds(value)); }
std::string number(double value) { return numberText(value); }

using Read = std::function<std::string(const RobotConfig&)>;

const drive::AxisConfig& axisOf(const RobotConfig& robot) { return robot.axes.at(0); }
const canopen::DeviceConfig& deviceOf(const RobotConfig& robot) { return robot.devices.at(0); }
const drive::HomingOptions& homingOf(const RobotConfig& robot) { return *axisOf(robot).homing; }

const std::map<std::string, Read> kOfTheTop{
    {"joint_state_rate", [](const auto& r) { return number(r.joint_state_rate); }},
    {"unknown_joints", [](const auto& r) { return r.omit_unknown_joints ? "omit" : "nan"; }},
};
const std::map<std::string, Read> kOfTheBus{
    {"bitrate", [](const auto& r) { return numberText(r.bus.bitrate, 8); }},
    {"sync_period", [](const auto& r) { return seconds(r.bus.sync_period); }},
    {"node_id", [](const auto& r) { return number(r.bus.node_id); }},
    {"heartbeat", [](const auto& r) { return seconds(r.bus.heartbeat); }},
    {"sync", [](const auto& r) { return r.bus.external_sync ? "external" : "own"; }},
    {"listen", [](const auto& r) { return seconds(r.bus.listen); }},
    {"stop_all_on_loss", [](const auto& r) { return yesNo(r.bus.stop_all_on_loss); }},
    {"reset", [](const auto& r) { return r.bus.reset_all ? "all" : "each"; }},
    {"time_interval", [](const auto& r) { return seconds(r.bus.time_interval); }},
    {"receive", [](const auto& r) { return r.bus.receive_all ? "all" : "configured"; }},
};
const std::map<std::string, Read> kOfTheRecorder{
    {"duration", [](const auto& r) { return seconds(r.recorder.duration); }},
    {"post_trigger", [](const auto& r) { return seconds(r.recorder.post_trigger); }},
    {"keep", [](const auto& r) { return number(r.recorder.keep); }},
};
const std::map<std::string, Read> kOfAnAxis{
    {"device_axis", [](const auto& r) { return number(axisOf(r).device_axis); }},
    {"type",
     [](const auto& r) {
       return axisOf(r).geometry.type == drive::AxisGeometry::Type::revolute ? "revolute" : "other";
     }},
    {"gear_ratio", [](const auto& r) { return number(axisOf(r).geometry.gear_ratio); }},
    {"direction", [](const auto& r) { return number(axisOf(r).geometry.direction); }},
    {"position_offset", [](const auto& r) { return number(axisOf(r).geometry.position_offset); }},
    {"command_timeout", [](const auto& r) { return seconds(axisOf(r).command_timeout); }},
    {"quick_stop", [](const auto& r) { return axisOf(r).quick_stop_holds ? "hold" : "disable"; }},
    {"command_timeout_action",
     [](const auto& r) { return axisOf(r).brake_after_effort ? "brake" : "coast"; }},
    {"unwatched_streams", [](const auto& r) { return yesNo(axisOf(r).unwatched_streams); }},
    {"optional", [](const auto& r) { return yesNo(deviceOf(r).boot.optional); }},
    {"restore_before_configure",
     [](const auto& r) { return yesNo(deviceOf(r).boot.restore_before_configure); }},
    {"configuration_check",
     [](const auto& r) {
       return deviceOf(r).boot.check == canopen::ConfigurationCheck::none ? "none" : "other";
     }},
    {"stale_after", [](const auto& r) { return number(deviceOf(r).stale_after); }},
    {"set_mode_in_motion",
     [](const auto& r) { return axisOf(r).set_mode_stops ? "stop" : "refuse"; }},
};
const std::map<std::string, Read> kOfTheBoot{
    {"retries", [](const auto& r) { return number(deviceOf(r).boot.retries); }},
    {"retry_delay", [](const auto& r) { return seconds(deviceOf(r).boot.retry_delay); }},
    {"search_period", [](const auto& r) { return seconds(deviceOf(r).boot.search_period); }},
};
const std::map<std::string, Read> kOfHoming{
    {"offset", [](const auto& r) { return number(homingOf(r).atHome()); }},
    {"offset_means",
     [](const auto& r) {
       return homingOf(r).offset_shifts_zero ? "shift_of_zero" : "position_at_home";
     }},
    {"timeout", [](const auto& r) { return seconds(homingOf(r).timeout); }},
    {"required", [](const auto& r) { return yesNo(homingOf(r).required); }},
    {"kept_by_drive", [](const auto& r) { return yesNo(homingOf(r).kept_by_drive); }},
    {"order", [](const auto& r) { return number(homingOf(r).order); }},
};
const std::map<std::string, Read> kOfTheSimulation{
    {"initial_position",
     [](const auto& r) { return number(r.simulated.at("a").initial_position); }},
    {"brake_delay", [](const auto& r) { return number(r.simulated.at("a").brake_delay); }},
    {"unconfigured", [](const auto& r) { return yesNo(r.simulated.at("a").unconfigured); }},
};
const std::map<std::string, Read> kOfFrames{
    {"origin/xyz", [](const auto& r) { return number(r.frames.at(0).xyz[0]); }},
    {"origin/rpy", [](const auto& r) { return number(r.frames.at(0).rpy[0]); }},
    {"axis",
     [](const auto& r) {
       const auto& axis = r.frames.at(0).axis;
       return "[" + number(axis[0]) + ", " + number(axis[1]) + ", " + number(axis[2]) + "]";
     }},
};
const std::map<std::string, Read> kOfAGroup{
    {"stop_group_on_fault", [](const auto& r) { return yesNo(r.groups[0].stop_group_on_fault); }},
    {"allow_partial_joints_goal",
     [](const auto& r) { return yesNo(r.groups[0].allow_partial_joints_goal); }},
    {"stop_trajectory_duration",
     [](const auto& r) { return number(r.groups[0].stop_trajectory_duration); }},
    {"strict", [](const auto& r) { return yesNo(r.groups[0].strict); }},
    {"lengthening", [](const auto& r) { return number(r.groups[0].lengthening); }},
    {"acceleration_margin", [](const auto& r) { return number(r.groups[0].acceleration_margin); }},
    {"constraints/goal_time", [](const auto& r) { return number(r.groups[0].goal_time); }},
    {"constraints/stopped_velocity_tolerance",
     [](const auto& r) { return number(r.groups[0].stopped_velocity_tolerance); }},
    {"constraints/<joint>",
     [](const auto& r) { return number(r.groups[0].tolerances.at("a").trajectory); }},
};

/// By chapter of the document.
const std::map<std::string, std::map<std::string, Read>> kDefaults{
    {"Top level", kOfTheTop},         {"bus", kOfTheBus},    {"recorder", kOfTheRecorder},
    {"axes/<name>", kOfAnAxis},       {"boot", kOfTheBoot},  {"homing", kOfHoming},
    {"simulation", kOfTheSimulation}, {"Frames", kOfFrames}, {"groups/<name>", kOfAGroup},
};

/// A default that is a value, without its unit: "0.4 s" is 0.4, "`own`" is own. Empty where the
/// cell says in words what happens ("the profile's", "3 periods").
std::string valueIn(const std::string& cell) {
  static const std::regex kValue(
      "(-?[0-9.]+|true|false|`([^`/]+)`)( s| rad/s or m/s|: not checked;.*)?");
  std::smatch match;
  if (!std::regex_match(cell, match, kValue)) return "";
  return match[2].matched ? match[2] : match[1];
}

TEST(DocumentedDefaults, AreThoseOfTheLoader) {
  const LoadedRobot loaded = loadText(kEmptySections);
  ASSERT_EQ(loaded.problems, "");
  std::size_t compared = 0;
  for (const auto& [heading, chapter] : keyChapters()) {
    for (const KeyRow& row : chapter.rows) {
      const std::string documented = valueIn(row.fallback);
      for (const std::string& key : row.keys) {
        if (heading == "Top level" && key == "groups") continue;  // a group of its own, below
        if (key == "skew/homing") continue;                       // another key's value
        const auto reads = kDefaults.find(heading);
        const bool known = reads != kDefaults.end() && reads->second.count(key) == 1;
        EXPECT_EQ(known, !documented.empty())
            << heading << ", " << key << ": `" << row.fallback << "` is a value that this test "
            << (known ? "does not find" : "does not compare");
        if (!known) continue;
        EXPECT_EQ(reads->second.at(key)(loaded.robot), documented) << heading << ", " << key;
        ++compared;
      }
    }
  }
  std::size_t known = 0;
  for (const auto& [heading, reads] : kDefaults) known += reads.size();
  EXPECT_EQ(compared, known) << "a row is gone";
}

TEST(DocumentedDefaults, TheOneGroupThatNobodyNamedIsCalledAsDocumented) {
  const LoadedRobot loaded = loadText(
      "{bus: {interface: can0}, axes: {a: {node_id: 1, drive: generic_cia402, "
      "counts_per_turn: 1000}}}");
  const auto rows = keysBelow(keyChapters().at("Top level"), "");
  ASSERT_EQ(loaded.robot.groups.size(), 1u) << loaded.problems;
  EXPECT_EQ("`" + loaded.robot.groups[0].name + "`", rows.at("groups").fallback);
}

}  // namespace
}  // namespace cia402::config
