// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every key of a robot's file with a value of its own, found again where it belongs, and the
// mistakes that test/config/robot_test.cpp does not make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loaded.h"
#include "config/robot.h"

namespace cia402::config {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kFull = R"(
bus: {interface: vcan7, bitrate: 500000, sync_period: 0.01, node_id: 126, heartbeat: 0.25,
      sync_counter: 9, sync: external, listen: 0.5, reset: all, sync_window: 0.002,
      time_interval: 2.5, receive: all}
joint_state_rate: 33.0
unknown_joints: omit
publish_tf: false
static_frames: [{parent: carriage, child: tip, origin: {xyz: [4, 5, 6], rpy: [0.4, 0.5, 0.6]}}]
recorder: {duration: 12.5, post_trigger: 1.5, directory: /tmp/recordings, keep: 7}
axes:
  slide:
    node_id: 3
    joint: lift
    drive: generic_cia402
    type: prismatic
    counts_per_turn: 4096
    gear_ratio: 2.5
    lead: 0.005
    position_offset: 0.125
    rated_torque: 0.75
    direction: -1
    limits: {lower: -0.5, upper: 0.75, velocity: 0.25, acceleration: 1.5, jerk: 15.0, effort: 40.0}
    mode: pv
    command_timeout: 0.75
    command_timeout_action: coast
    set_mode_in_motion: stop
    homing: {method: 17, search_velocity: 0.03, zero_velocity: 0.01, acceleration: 0.6,
             offset: -0.25, timeout: 12.0, required: false, order: -4}
    identity: {vendor_id: 11, product_code: 12, revision: 13, serial: 14}
    frame: {parent: base, child: carriage, origin: {xyz: [1, 2, 3], rpy: [0.1, 0.2, 0.3]},
            axis: [0, 3, 4]}
    simulation: {drive: generic_cia402_guarding, initial_position: 0.4, lower_limit_switch: -0.6,
                 upper_limit_switch: 0.8, home_switch: [-0.1, 0.1], index_offset: 0.75,
                 time_constant: 0.02, brake_delay: 0.3, unconfigured: true, vendor: 21,
                 product: 22, revision: 23, serial: 24, with: {quirks: {colour: red}}}
  turn: {node_id: 4, drive: generic_cia402, counts_per_turn: 1000,
         limits: {velocity: 1, acceleration: 2}}
groups:
  both: {joints: [turn, lift], stop_group_on_fault: false, allow_partial_joints_goal: true,
         stop_trajectory_duration: 0.75, strict: true, acceleration_margin: 0.25, lengthening: 0.5,
         constraints: {goal_time: 2.5, stopped_velocity_tolerance: 0.125, lift: {trajectory: 0.02, goal: 0.003}}}
)";

class RobotKeys : public testing::Test {
 protected:
  RobotKeys() {
    EXPECT_EQ(loaded.problems, "");
    EXPECT_EQ(robot.axes.size(), 2U);
  }
  const LoadedRobot loaded = loadText(kFull);
  const RobotConfig& robot = loaded.robot;
};

TEST_F(RobotKeys, OfTheBus) {
  const BusConfig& bus = robot.bus;
  EXPECT_EQ(bus.interface, "vcan7");
  EXPECT_EQ(bus.bitrate, 500000.0);
  EXPECT_EQ(bus.sync_period, milliseconds(10));
  EXPECT_EQ(bus.node_id, 126);
  EXPECT_EQ(bus.heartbeat, milliseconds(250));
  EXPECT_EQ(bus.sync_counter, 9);
  EXPECT_TRUE(bus.external_sync);
  EXPECT_EQ(bus.listen, milliseconds(500));
  EXPECT_TRUE(bus.reset_all);
  EXPECT_TRUE(bus.receive_all);
  EXPECT_EQ(bus.sync_window, milliseconds(2));
  EXPECT_EQ(bus.time_interval, milliseconds(2500));
  EXPECT_EQ(robot.joint_state_rate, 33.0);
  EXPECT_TRUE(robot.omit_unknown_joints);
}

TEST_F(RobotKeys, OfTheRecorder) {
  EXPECT_EQ(robot.recorder.duration, milliseconds(12500));
  EXPECT_EQ(robot.recorder.post_trigger, milliseconds(1500));
  EXPECT_EQ(robot.recorder.directory, "/tmp/recordings");
  EXPECT_EQ(robot.recorder.keep, 7U);
}

TEST_F(RobotKeys, OfAnAxis) {
  const drive::AxisConfig& slide = robot.axes[0];
  EXPECT_EQ(slide.name, "slide");
  EXPECT_EQ(slide.joint, "lift");
  const canopen::DeviceConfig& device = robot.deviceOf(slide);
  EXPECT_EQ(device.name, "slide");
  EXPECT_EQ(device.node_id, 3);
  EXPECT_EQ(slide.cycle, milliseconds(10));
  EXPECT_EQ(slide.geometry.type, drive::AxisGeometry::Type::prismatic);
  EXPECT_EQ(slide.geometry.counts_per_turn, 4096.0);
  EXPECT_EQ(slide.geometry.gear_ratio, 2.5);
  EXPECT_EQ(slide.geometry.lead, 0.005);
  EXPECT_EQ(slide.geometry.position_offset, 0.125);
  EXPECT_EQ(slide.geometry.rated_torque, 0.75);
  EXPECT_EQ(slide.geometry.direction, -1);
  EXPECT_EQ(slide.limits.lower, -0.5);
  EXPECT_EQ(slide.limits.upper, 0.75);
  EXPECT_EQ(slide.limits.velocity, 0.25);
  EXPECT_EQ(slide.limits.acceleration, 1.5);
  EXPECT_EQ(slide.limits.jerk, 15.0);
  EXPECT_EQ(slide.limits.effort, 40.0);
  EXPECT_EQ(slide.mode, "profile_velocity");
  EXPECT_EQ(slide.command_timeout, milliseconds(750));
  EXPECT_TRUE(slide.set_mode_stops);
  EXPECT_FALSE(slide.brake_after_effort);
  EXPECT_EQ(slide.standstill_velocity, 0.002) << "m/s, as it is prismatic";
  EXPECT_EQ(device.vendor_id, 11U);
  EXPECT_EQ(device.product_code, 12U);
  EXPECT_EQ(device.revision, 13U);
  EXPECT_EQ(device.serial, 14U);
  const drive::AxisConfig& turn = robot.axes[1];
  EXPECT_EQ(turn.joint, "turn");
  EXPECT_EQ(turn.geometry.type, drive::AxisGeometry::Type::revolute);
  EXPECT_EQ(turn.geometry.gear_ratio, 1.0);
  EXPECT_EQ(turn.geometry.direction, 1);
  EXPECT_EQ(turn.mode, "cyclic_position");
  EXPECT_EQ(turn.command_timeout, milliseconds(200));
  EXPECT_FALSE(turn.set_mode_stops);
  EXPECT_TRUE(turn.brake_after_effort);
  EXPECT_EQ(turn.standstill_velocity, 0.01);
  const canopen::DeviceConfig& other = robot.deviceOf(turn);
  EXPECT_FALSE(turn.homing || other.vendor_id || other.product_code || other.revision ||
               other.serial);
}

TEST_F(RobotKeys, OfHoming) {
  ASSERT_TRUE(robot.axes[0].homing);
  const drive::HomingOptions& homing = *robot.axes[0].homing;
  EXPECT_EQ(homing.method, 17);
  EXPECT_EQ(homing.search_velocity, 0.03);
  EXPECT_EQ(homing.zero_velocity, 0.01);
  EXPECT_EQ(homing.acceleration, 0.6);
  EXPECT_EQ(homing.offset, -0.25);
  EXPECT_EQ(homing.timeout, milliseconds(12000));
  EXPECT_FALSE(homing.required);
  EXPECT_EQ(homing.order, -4);
}

TEST_F(RobotKeys, OfAFrame) {
  ASSERT_EQ(robot.frames.size(), 1U);
  const FrameConfig& frame = robot.frames[0];
  EXPECT_EQ(frame.joint, "lift");
  EXPECT_EQ(frame.parent, "base");
  EXPECT_EQ(frame.child, "carriage");
  EXPECT_THAT(frame.xyz, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(frame.rpy, ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(frame.axis, ElementsAre(0.0, 0.6, 0.8)) << "of length 1";
}

TEST_F(RobotKeys, OfAStaticFrame) {
  EXPECT_FALSE(robot.publish_tf);
  ASSERT_EQ(robot.static_frames.size(), 1U);
  const FrameConfig& frame = robot.static_frames[0];
  EXPECT_EQ(frame.joint, "");
  EXPECT_EQ(frame.parent, "carriage");
  EXPECT_EQ(frame.child, "tip");
  EXPECT_THAT(frame.xyz, ElementsAre(4.0, 5.0, 6.0));
  EXPECT_THAT(frame.rpy, ElementsAre(0.4, 0.5, 0.6));
}

TEST_F(RobotKeys, OfTheSimulation) {
  const SimulationConfig& simulation = robot.simulated.at("slide");
  EXPECT_EQ(simulation.drive, "generic_cia402_guarding");
  EXPECT_EQ(simulation.initial_position, 0.4);
  EXPECT_EQ(simulation.lower_limit_switch, -0.6);
  EXPECT_EQ(simulation.upper_limit_switch, 0.8);
  EXPECT_EQ(simulation.home_switch, std::make_pair(-0.1, 0.1));
  EXPECT_EQ(simulation.index_offset, 0.75);
  EXPECT_EQ(simulation.time_constant, 0.02);
  EXPECT_EQ(simulation.brake_delay, 0.3);
  EXPECT_TRUE(simulation.unconfigured);
  EXPECT_EQ(simulation.vendor, 21U);
  EXPECT_EQ(simulation.product, 22U);
  EXPECT_EQ(simulation.revision, 23U);
  EXPECT_EQ(simulation.serial, 24U);
  EXPECT_EQ(simulation.with["quirks"]["colour"].Scalar(), "red");
  const SimulationConfig& plain = robot.simulated.at("turn");
  EXPECT_EQ(plain.drive, "generic_cia402") << "the profile's name";
  EXPECT_EQ(plain.initial_position, 0.0);
  EXPECT_EQ(plain.brake_delay, 0.0);
  EXPECT_FALSE(plain.unconfigured || plain.vendor || plain.product || plain.revision ||
               plain.serial || plain.lower_limit_switch || plain.upper_limit_switch ||
               plain.home_switch || plain.index_offset || plain.time_constant);
}

TEST_F(RobotKeys, OfAGroup) {
  ASSERT_EQ(robot.groups.size(), 1U);
  const GroupConfig& group = robot.groups[0];
  EXPECT_EQ(group.name, "both");
  EXPECT_THAT(group.joints, ElementsAre("turn", "lift"));
  EXPECT_FALSE(group.stop_group_on_fault);
  EXPECT_TRUE(group.allow_partial_joints_goal);
  EXPECT_EQ(group.goal_time, 2.5);
  EXPECT_EQ(group.stopped_velocity_tolerance, 0.125);
  EXPECT_EQ(group.stop_trajectory_duration, 0.75);
  EXPECT_TRUE(group.strict);
  EXPECT_EQ(group.acceleration_margin, 0.25);
  EXPECT_EQ(group.lengthening, 0.5);
  ASSERT_EQ(group.tolerances.size(), 1U);
  EXPECT_EQ(group.tolerances.at("lift").trajectory, 0.02);
  EXPECT_EQ(group.tolerances.at("lift").goal, 0.003);
}

TEST(RobotDefaults, OfWhatIsNotGiven) {
  const LoadedRobot loaded = loadText(
      "bus: {interface: can0}\n"
      "axes: {a: {node_id: 1, drive: generic_cia402, counts_per_turn: 1000,\n"
      "           limits: {velocity: 1, acceleration: 2}, homing: {method: 35}}}\n");
  EXPECT_EQ(loaded.problems, "");
  const BusConfig& bus = loaded.robot.bus;
  EXPECT_EQ(bus.bitrate, 1e6);
  EXPECT_EQ(bus.sync_period, milliseconds(4));
  EXPECT_EQ(bus.node_id, 127);
  EXPECT_EQ(bus.heartbeat, milliseconds(100));
  EXPECT_EQ(bus.sync_counter, 0);
  EXPECT_FALSE(bus.external_sync || bus.reset_all || bus.sync_window || bus.receive_all);
  EXPECT_EQ(bus.listen, milliseconds(150));
  EXPECT_EQ(bus.time_interval, milliseconds(0));
  EXPECT_EQ(loaded.robot.joint_state_rate, 50.0);
  EXPECT_FALSE(loaded.robot.omit_unknown_joints);
  EXPECT_EQ(loaded.robot.recorder.duration, milliseconds(10000));
  EXPECT_EQ(loaded.robot.recorder.post_trigger, milliseconds(500));
  EXPECT_EQ(loaded.robot.recorder.keep, 20U);
  const drive::HomingOptions& homing = *loaded.robot.axes.at(0).homing;
  EXPECT_EQ(homing.timeout, milliseconds(30000));
  EXPECT_TRUE(homing.required);
  EXPECT_EQ(homing.order, 0);
  const GroupConfig& group = loaded.robot.groups.at(0);
  EXPECT_TRUE(group.stop_group_on_fault);
  EXPECT_FALSE(group.allow_partial_joints_goal);
  EXPECT_EQ(group.goal_time, 0.4);
  EXPECT_EQ(group.stopped_velocity_tolerance, 0.01);
  EXPECT_EQ(group.stop_trajectory_duration, 0.0);
  EXPECT_FALSE(group.strict);
  EXPECT_EQ(group.acceleration_margin, 0.0);
  EXPECT_EQ(group.lengthening, 0.1);
  EXPECT_THAT(group.tolerances, IsEmpty());
}

TEST(RobotMistakes, AreToldWithWhatToDo) {
  struct Mistake {
    const char *from, *to, *problem;
  };
  const Mistake mistakes[] = {
      {"interface: can0", "interface: abcdefghijklmnop",
       "bus/interface: no network interface has a name longer than 15 letters"},
      {"sync_period: 0.004", "sync_period: 0.00009", "bus/sync_period: must be at least 0.0001 s"},
      {"sync_period: 0.004", "sync_window: 0.005",
       "bus/sync_window: must not be longer than sync_period (0.004000 s)"},
      {"sync_period: 0.004", "sync_window: 0.0010001",
       "bus/sync_window: must be a whole number of microseconds, as 1007h"},
      {"sync_period: 0.004", "time_interval: 0.009",
       "bus/time_interval: must be 0 (no TIME messages) or at least 0.01 s"},
      {"sync_period: 0.004", "heartbeat: 0.0005",
       "bus/heartbeat: must be a whole number of milliseconds, as 1017h counts"},
      {"sync_period: 0.004", "sync: mine", "bus/sync: unknown word `mine`"},
      {"shoulder:", "bus:", "axes/bus: `bus` is what diagnostics and inject_fault call the whole"},
      {"sync_period: 0.004", "sync_counter: 241", "bus/sync_counter: must be between 0 and 240"},
      {"sync_period: 0.004", "node_id: 128", "bus/node_id: must be between 1 and 127"},
      {"node_id: 1,", "node_id: 1, simulation: {lower_limit_switch: 1, upper_limit_switch: 1},",
       "lower_limit_switch must be less than upper_limit_switch"},
      {"node_id: 1,", "node_id: 1, simulation: {lower_stop: 1, upper_stop: 0.5},",
       "lower_stop must be less than upper_stop"},
      {"node_id: 1,", "node_id: 1, simulation: {index_offset: 1.5},",
       "axes/shoulder/simulation/index_offset: must be at least 0 and at most 1"},
      {"node_id: 1,", "node_id: 1, simulation: {brake_delay: -1},",
       "axes/shoulder/simulation/brake_delay: must be at least 0"},
      {"upper: 3.0", "upper: -3.0", "axes/shoulder/limits/upper: must be greater than lower"},
      {"upper: 3.0", "upper: 3.0, jerk: 0", "axes/shoulder/limits/jerk: must be greater than 0"},
      {"gear_ratio: 50.0, limits: {lower: -3.0, upper: 3.0}",
       "type: continuous, limits: {upper: 1}", "a continuous joint has neither lower nor upper"},
      {"node_id: 1,", "", "`node_id` is missing: the drive's CANopen node-ID, 1 to 127"},
      {"node_id: 1,", "node_id: 1, direction: 2,", "axes/shoulder/direction: must be between -1"},
      {"node_id: 1,", "node_id: 1, command_timeout: 0,",
       "axes/shoulder/command_timeout: must be greater than 0"},
      {"node_id: 1,", "node_id: 1, command_timeout_action: stop,",
       "axes/shoulder/command_timeout_action: unknown word `stop`"},
      {"node_id: 1,", "node_id: 1, set_mode_in_motion: coast,",
       "axes/shoulder/set_mode_in_motion: unknown word `coast`"},
      {"node_id: 1,",
       "node_id: 1, modes: [pv], pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, "
       "position_actual]},",
       "axes/shoulder/modes: mode `profile_velocity` needs `target_velocity` in an RPDO; add it to "
       "`pdos`, or leave the mode out"},
      {"node_id: 1,", "node_id: 1, pdos: {rpdo1: [controlword, target_position]},",
       "`statusword` must be in a TPDO: the axis needs it in every cycle"},
      {"method: 17", "order: 1001, method: 17", "axes/elbow/homing/order: must be between -1000"},
      {"method: 17", "method: 17, timeout: 0", "axes/elbow/homing/timeout: must be greater than 0"},
      {"homing: {method: 17", "lacks: [homing_acceleration], homing: {acceleration: 1, method: 17",
       "axes/elbow/homing/acceleration: `lacks` says that the drive has no `homing_acceleration` "
       "to "
       "take it; remove one of the two"},
      {"axes:", "unknown_joints: omitt\naxes:",
       "unknown_joints: unknown word `omitt`, did you mean `omit`?"},
      {"axes:", "recorder: {duration: 2, post_trigger: 2}\naxes:",
       "recorder/post_trigger: must be less than `duration` (2.000000)"},
      {"axes:", "recorder: {duration: 0.5}\naxes:", "recorder/duration: must be at least 1"},
      {"axes:", "recorder: {keep: 1001}\naxes:", "recorder/keep: must be between 0 and 1000"},
      {"axes:", "groups: {7: {joints: [elbow]}}\naxes:",
       "groups/7: a group is named by a letter, then letters, digits and _"},
      {"axes:", "groups: {arm: {}}\naxes:", "groups/arm: `joints` is missing: list the joints"},
      {"axes:", "groups: {arm: {joints: [elbow], constraints: {goal_time: -1}}}\naxes:",
       "groups/arm/constraints/goal_time: must be at least 0"},
      {"axes:", "groups: {arm: {joints: [elbow], stop_trajectory_duration: -1}}\naxes:",
       "groups/arm/stop_trajectory_duration: must be at least 0"},
      {"axes:",
       "groups: {arm: {joints: [elbow], constraints: {stopped_velocity_tolerance: -1}}}\naxes:",
       "groups/arm/constraints/stopped_velocity_tolerance: must be at least 0"},
      {"axes:", "couplings: [{joints: [p, r], axes: [shoulder, elbow]}]\naxes:",
       "couplings[0]: `matrix` is missing: joint space = matrix * axis space"},
      {"axes:", "couplings: [{joints: [p, r], axes: [shoulder, elbow], matrix: [[1, 2]]}]\naxes:",
       "couplings[0]/matrix: must have a row for each joint: 2, not 1"},
      {"axes:",
       "couplings: [{joints: [p], axes: [elbow], matrix: [[1]]}, {joints: [q], axes: [elbow], "
       "matrix: [[1]]}]\naxes:",
       "couplings[1]: `elbow` is coupled twice"},
      {"axes:",
       "couplings: [{joints: [p], axes: [elbow], matrix: [[1]]}, {joints: [p], axes: [shoulder], "
       "matrix: [[1]]}]\naxes:",
       "couplings[1]: joint `p` is given twice"},
      {"axes:", "couplings: [{joints: [shoulder], axes: [elbow], matrix: [[1]]}]\naxes:",
       "couplings: the joint `shoulder` is that of an axis without coupling already"},
  };
  ASSERT_EQ(loadText(kArm).problems, "");
  for (const Mistake& mistake : mistakes) {
    EXPECT_THAT(changed(mistake.from, mistake.to).problems, HasSubstr(mistake.problem))
        << mistake.to;
  }
}

TEST(RobotMistakes, WithoutAnyAxisThereIsNothingToDo) {
  EXPECT_THAT(loadText("bus: {interface: can0}\naxes: {}\n").problems,
              HasSubstr("axes: must name at least one axis"));
  EXPECT_THAT(loadText("bus: {interface: can0}\n").problems,
              HasSubstr("axes: is missing: name at least one axis with its node_id and drive"));
}

TEST(RobotWarnings, OfLimitsThatAreMissing) {
  EXPECT_THAT(changed("velocity: 2.0, acceleration: 8.0", "velocity: 2.0").robot.warnings,
              Contains("axes/shoulder/limits: no acceleration limit: the axis follows set-points "
                       "however fast they are"));
  EXPECT_THAT(changed("velocity: 2.0, acceleration: 8.0", "acceleration: 8.0").robot.warnings,
              Contains(HasSubstr("axes/shoulder/limits: no velocity limit")));
}

TEST(RobotWarnings, OfAHomePositionBeyondTheLimits) {
  const auto warnings = [](const char* offset) {
    return changed("limits: {lower: -3.0, upper: 3.0}",
                   "limits: {lower: -3.0, upper: 3.0}, homing: {method: 35, offset: " +
                       std::string(offset) + "}")
        .robot.warnings;
  };
  const char* const words =
      "axes/shoulder/homing/offset lies outside the axis' limits: after homing the axis will stand "
      "where it may not be";
  EXPECT_THAT(warnings("3.1"), Contains(words));
  EXPECT_THAT(warnings("-3.1"), Contains(words));
  EXPECT_THAT(warnings("3.0"), IsEmpty());
  EXPECT_THAT(warnings("-3.0"), IsEmpty());
}

TEST(RobotWarnings, OfASearchForHomeBeyondTheVelocityLimit) {
  const auto warnings = [](const char* speeds) {
    return changed("velocity: 2.0, acceleration: 8.0",
                   "velocity: 2.0, acceleration: 8.0}, homing: {method: 17, " + std::string(speeds))
        .robot.warnings;
  };
  EXPECT_THAT(warnings("search_velocity: 2.5, zero_velocity: 2.0"),
              Contains("axes/shoulder/homing/search_velocity: 2.5 is beyond `limits/velocity` 2: "
                       "the drive searches faster than the joint may move else"));
  EXPECT_THAT(warnings("search_velocity: 2.0, zero_velocity: 2.0"), IsEmpty());
  EXPECT_THAT(warnings("zero_velocity: 2.5"),
              Contains(HasSubstr("axes/shoulder/homing/zero_velocity: 2.5 is beyond")));
}

}  // namespace
}  // namespace cia402::config
