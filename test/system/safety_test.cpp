// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Nothing may move, or stay enabled, that should not: what commands, procedures and lost nodes
// could do to each other.
#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <string>

#include "system/robot_fixture.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr const char* kOneAxis = R"(
bus: {interface: sim, bitrate: 1000000, sync_period: 0.004}
axes:
  arm:
    node_id: 1
    drive: generic_cia402
    counts_per_turn: 131072
    gear_ratio: 100.0
    rated_torque: 0.64
    limits: {lower: -2.0, upper: 2.0, velocity: 1.5, acceleration: 4.0, effort: 120.0}
)";

constexpr const char* kThreeAxes = R"(
bus: {interface: sim, bitrate: 1000000, sync_period: 0.004}
defaults:
  drive: generic_cia402
  counts_per_turn: 131072
  gear_ratio: 100.0
  rated_torque: 0.64
  limits: {lower: -2.65, upper: 2.5, velocity: 1.5, acceleration: 1.0}
  simulation: {initial_position: -1.0, lower_limit_switch: -2.6, upper_limit_switch: 2.6}
axes:
  fast: {node_id: 1}
  first:
    node_id: 2
    homing: {method: 17, search_velocity: 0.8, zero_velocity: 0.1, acceleration: 4.0, offset: -2.6,
             order: 1}
  second:
    node_id: 3
    homing: {method: 17, search_velocity: 0.8, zero_velocity: 0.1, acceleration: 4.0, offset: -2.6,
             order: 2}
)";

constexpr const char* kTwoAxes = R"(
bus: {interface: sim, bitrate: 1000000, sync_period: 0.004}
defaults:
  drive: generic_cia402
  counts_per_turn: 131072
  gear_ratio: 100.0
  rated_torque: 0.64
  limits: {lower: -2.0, upper: 2.0, velocity: 1.5, acceleration: 4.0, effort: 120.0}
axes:
  left: {node_id: 1}
  right: {node_id: 2}
groups:
  both: {joints: [left, right], stop_group_on_fault: false}
)";

/// A robot that has booted.
class Safety : public testing::Test {
 protected:
  void boot(const std::string& yaml) {
    const LoadedRobot loaded = loadTree(YAML::Load(yaml));
    robot = std::make_unique<tools::VirtualRobot>(loaded.robot, loaded.master, loaded.drives);
    robot->start();
    ASSERT_TRUE(robot->runUntil([&] { return allReady(*robot); }, 5s)) << told(*robot);
    robot->run(100ms);
  }
  void mustSucceed(ProcedureKind kind, const std::string& name = {}) {
    const auto answer = robot->procedure(kind, name);
    ASSERT_TRUE(answer.has_value());
    ASSERT_TRUE(answer->success) << answer->message;
  }
  void setMode(const std::string& mode) {
    drive::ProcedureRequest request;
    request.kind = ProcedureKind::set_mode;
    request.mode = mode;
    const auto answer = robot->call(bus::ProcedureCommand{{}, request});
    ASSERT_TRUE(answer.has_value());
    ASSERT_TRUE(answer->success) << answer->message;
  }
  /// Gives a command without waiting for its answer.
  void post(ProcedureKind kind, const std::string& name = {}) {
    drive::ProcedureRequest request;
    request.kind = kind;
    robot->network().execute(bus::Command(bus::ProcedureCommand{name, request}), robot->now());
  }
  void stream(double value, Duration time) {
    const Time end = robot->now() + time;
    while (robot->now() < end) {
      robot->network().execute(bus::Command(bus::SetpointCommand{0, value}), robot->now());
      robot->run(10ms);
    }
  }
  bus::Answer trajectory(std::vector<double> goal, Duration time, std::optional<Time> start = {}) {
    bus::TrajectoryCommand trajectory;
    trajectory.group = robot->network().cycle().groups().front().config().name;
    trajectory.joints = robot->network().cycle().groups().front().config().joints;
    trajectory.points = {{goal, std::vector<double>(goal.size(), 0.0), {}, time}};
    trajectory.start_time = start;
    return *robot->call(trajectory);
  }
  drive::Axis& axis(std::size_t index = 0) { return robot->network().axis(index); }
  sim::Drive& drive(std::size_t index = 0) { return robot->world().drive(index); }
  sim::DriveTruth truth(std::size_t index = 0) { return drive(index).truth(robot->now()); }
  void inject(const char* fault) {
    const Result<void> injected = drive().inject(fault, robot->now());
    ASSERT_TRUE(injected.ok()) << injected.error().message;
  }
  /// Every frame of an identifier is lost, everywhere or at one drive only.
  void loseFrames(std::uint32_t id, std::string_view receiver = {}) {
    sim::FaultRule rule;
    rule.id = id;
    rule.count = 1000000;
    rule.receiver = receiver;
    robot->world().bus().faults().add(rule);
  }
  /// Fastest that the motor has turned in `time`, rad/s of the joint.
  double fastest(Duration time, std::size_t index = 0) {
    double most = 0.0;
    const Time end = robot->now() + time;
    while (robot->now() < end) {
      robot->run(1ms);
      most = std::max(most, std::fabs(truth(index).velocity_turns));
    }
    return most * 2.0 * 3.14159265358979 / 100.0;
  }

  std::unique_ptr<tools::VirtualRobot> robot;
};

TEST_F(Safety, DeclaringThePositionOfAnAxisUnderAStreamMovesNothing) {
  boot(kOneAxis);
  mustSucceed(ProcedureKind::enable);
  stream(0.5, 1s);
  robot->run(500ms);
  ASSERT_NEAR(axis().state().position, 0.5, 1e-3);
  drive::ProcedureRequest request;
  request.kind = ProcedureKind::set_position;
  request.position = 0.0;
  const auto answer = robot->call(bus::ProcedureCommand{"arm", request});
  ASSERT_TRUE(answer && answer->success) << answer->message;
  EXPECT_LT(fastest(1s), 1e-3);
  EXPECT_NEAR(axis().state().position, 0.0, 1e-3);
}

TEST_F(Safety, DeclaringThePositionUnderATrajectoryMovesNothing) {
  boot(kTwoAxes);
  mustSucceed(ProcedureKind::enable);
  ASSERT_TRUE(trajectory({0.5, 0.5}, 1s).success);
  robot->run(1500ms);
  // The joints wait for the beginning of the next trajectory.
  ASSERT_TRUE(trajectory({0.6, 0.6}, 1s, robot->now() + 1s).success);
  robot->run(100ms);
  drive::ProcedureRequest request;
  request.kind = ProcedureKind::set_position;
  request.position = 0.0;
  const auto answer = robot->call(bus::ProcedureCommand{"left", request});
  ASSERT_TRUE(answer && answer->success) << answer->message;
  EXPECT_LT(fastest(3s), 1e-3);
}

TEST_F(Safety, AVelocityAxisComesToRestWhenAProcedureTakesItsStream) {
  boot(kOneAxis);
  setMode("cyclic_velocity");
  mustSucceed(ProcedureKind::enable);
  stream(0.3, 500ms);
  mustSucceed(ProcedureKind::enable);
  robot->run(1s);
  EXPECT_LT(fastest(500ms), 1e-3);
}

TEST_F(Safety, AHaltOfAMovingAxisStopsItsSetPointsByARamp) {
  boot(kOneAxis);
  mustSucceed(ProcedureKind::enable);
  stream(1.9, 700ms);
  const double moving = fastest(4ms);
  ASSERT_GT(moving, 0.5);
  post(ProcedureKind::halt);
  double last = axis().target(), last_step = moving * 0.004, hardest = 0.0;
  for (int i = 0; i < 200; ++i) {
    robot->run(4ms);
    const double step = axis().target() - last;
    hardest = std::max(hardest, std::fabs(step - last_step) / 0.004 / 0.004);
    last = axis().target();
    last_step = step;
  }
  EXPECT_LT(hardest, 30.0) << "rad/s^2; a dead stop is far more than the 4.0 of the limits";
  EXPECT_LT(fastest(300ms), 1e-3);
}

TEST_F(Safety, AVelocityAxisStopsAtItsLimitAndDoesNotCreepOn) {
  boot(kOneAxis);
  setMode("cyclic_velocity");
  mustSucceed(ProcedureKind::enable);
  stream(-1.5, 6s);
  EXPECT_LT(fastest(500ms), 1e-4);
  EXPECT_EQ(axis().target(), 0.0);
  EXPECT_GT(axis().state().position, -2.01);
}

TEST_F(Safety, AVelocityAxisThatOvershootsItsLimitDoesNotRunOn) {
  boot(std::string(kOneAxis) + "    simulation: {time_constant: 0.3}\n");
  setMode("cyclic_velocity");
  mustSucceed(ProcedureKind::enable);
  // The stream ends just before the limit, so that nothing but the driver's own care stops it.
  while (axis().state().position > -1.97) stream(-1.5, 10ms);
  robot->run(300ms);
  ASSERT_LT(axis().state().position, -2.0) << "the test needs an overshoot";
  robot->run(2s);
  EXPECT_EQ(axis().target(), 0.0);
  EXPECT_LT(fastest(500ms), 1e-3);
}

TEST_F(Safety, HaltDuringEnableLeavesTheAxisDisabled) {
  boot(kOneAxis);
  post(ProcedureKind::enable);
  ASSERT_TRUE(robot->runUntil(
      [&] {
        return axis().state().state == drive::State::ready_to_switch_on ||
               axis().state().state == drive::State::switched_on;
      },
      2s));
  const auto answer = robot->procedure(ProcedureKind::halt);
  ASSERT_TRUE(answer.has_value());
  robot->run(1s);
  EXPECT_FALSE(truth().power_stage_on) << answer->message;
  EXPECT_FALSE(axis().state().ready_for_motion);
}

class StopDuringRecover : public Safety, public testing::WithParamInterface<ProcedureKind> {};

TEST_P(StopDuringRecover, EndsTheRecoveryOfAnAxisWhoseNodeStillBoots) {
  boot(kOneAxis);
  inject("power_cycle");
  ASSERT_TRUE(
      robot->runUntil([&] { return axis().state().health == fieldbus::Health::booting; }, 10s));
  post(ProcedureKind::recover);
  robot->run(2ms);
  ASSERT_NE(axis().state().health, fieldbus::Health::ready);
  post(GetParam());
  robot->run(5s);
  ASSERT_EQ(axis().state().health, fieldbus::Health::ready) << told(*robot);
  EXPECT_FALSE(truth().power_stage_on);
}

INSTANTIATE_TEST_SUITE_P(Kinds, StopDuringRecover,
                         testing::Values(ProcedureKind::disable, ProcedureKind::quick_stop,
                                         ProcedureKind::halt));

TEST_F(Safety, AJointThatFellOutDoesNotJumpIntoTheNextTrajectory) {
  boot(kTwoAxes);
  mustSucceed(ProcedureKind::enable);
  ASSERT_TRUE(trajectory({1.0, 1.0}, 3s).success);
  robot->run(500ms);
  // Goes on from where the first one would have brought it.
  ASSERT_TRUE(trajectory({1.2, 1.2}, 5s, robot->now() + 2s).success);
  robot->run(200ms);
  mustSucceed(ProcedureKind::disable, "left");
  robot->run(1s);
  mustSucceed(ProcedureKind::enable, "left");
  const double before = axis(0).state().position;
  EXPECT_LT(fastest(5s, 0), 1e-3);
  EXPECT_NEAR(axis(0).state().position, before, 1e-3);
}

TEST_F(Safety, AQuickStopByTheDriveItselfIsNotCutOff) {
  boot(kOneAxis);
  mustSucceed(ProcedureKind::enable);
  stream(1.9, 700ms);
  ASSERT_GT(fastest(4ms), 0.5);
  loseFrames(0x77F, "arm");  // the drive misses the master: 6007h makes it quick-stop
  const auto stopsItself = [&] {
    return (drive(0).dictionary().find({0x6041, 0})->number & 0x6FU) == 0x07U;
  };
  ASSERT_TRUE(robot->runUntil(stopsItself, 2s));
  ASSERT_GT(fastest(1ms), 0.3);
  while (fastest(1ms) > 0.05) {
    ASSERT_TRUE(truth().power_stage_on) << "coasting at " << fastest(1ms) << " rad/s";
  }
  robot->run(1s);
  EXPECT_FALSE(truth().power_stage_on);
}

TEST_F(Safety, ADisabledAxisIsNotHomedByAJobThatWaitsForOthers) {
  boot(kThreeAxes);
  std::optional<bus::Answer> homed;
  drive::ProcedureRequest request;
  request.kind = ProcedureKind::home;
  const auto take = [&](const bus::Answer& answer) { homed = answer; };
  robot->network().execute(bus::Command(bus::ProcedureCommand{{}, request}, take), robot->now());
  robot->run(500ms);
  ASSERT_TRUE(robot->procedure(ProcedureKind::disable, "second")->success);
  EXPECT_LT(fastest(10s, 2), 1e-6);
  EXPECT_FALSE(truth(2).power_stage_on);
  ASSERT_TRUE(homed.has_value());
  EXPECT_FALSE(homed->success);
  EXPECT_THAT(homed->message, HasSubstr("disable"));
}

TEST_F(Safety, NoHomingBeginsDuringTheShutdown) {
  boot(kThreeAxes);
  mustSucceed(ProcedureKind::enable, "fast");
  drive::ProcedureRequest request;
  request.kind = ProcedureKind::home;
  std::optional<bus::Answer> homed;
  const auto take = [&](const bus::Answer& answer) { homed = answer; };
  robot->network().execute(bus::Command(bus::ProcedureCommand{{}, request}, take), robot->now());
  // The first axis is homed while the stream of another one still ramps down.
  ASSERT_TRUE(robot->runUntil([&] { return axis(1).state().homed; }, 10s));
  stream(1.9, 20ms);
  robot->network().beginShutdown(robot->now());
  EXPECT_LT(fastest(3s, 2), 1e-6);
  EXPECT_TRUE(robot->network().shutDown());
  EXPECT_FALSE(truth(2).power_stage_on);
  ASSERT_TRUE(homed.has_value());
  EXPECT_FALSE(homed->success);
}

TEST_F(Safety, ANodeWhoseHeartbeatsAloneAreLostDoesNotRunOn) {
  boot(kOneAxis);
  setMode("cyclic_velocity");
  mustSucceed(ProcedureKind::enable);
  stream(0.5, 500ms);
  ASSERT_GT(fastest(4ms), 0.4);
  loseFrames(0x701);
  stream(0.5, 500ms);
  EXPECT_LT(fastest(1s), 1e-3) << told(*robot);
}

TEST_F(Safety, TheModeThatWasSetIsTheModeThatIsShownThoughTwoShareANumber) {
  boot(R"(
bus: {interface: sim, bitrate: 1000000, sync_period: 0.004}
axes:
  arm: {node_id: 1, drive: damiao_dm, limits: {lower: -2.0, upper: 2.0, velocity: 1.5, acceleration: 4.0, effort: 5.0}}
)");
  mustSucceed(ProcedureKind::enable);
  setMode("profile_position");
  ASSERT_NE(axis().state().mode, nullptr);
  EXPECT_EQ(axis().state().mode->name, "profile_position");
  EXPECT_FALSE(trajectory({0.5}, 1s).success);
  setMode("cyclic_velocity");
  EXPECT_EQ(axis().state().mode->name, "cyclic_velocity");
}

}  // namespace
}  // namespace cia402
