// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Commands as a robot sees them: streams, limits, trajectories, shutdown. What left on the wire is
// read from the bus.
#include "config/ready_robot.h"
#include "folders.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr double kRadPerCount = 6.283185307179586 / (131072 * 100.0);

/// Joints that nobody streams to are at rest once a trajectory has told its end.
TEST(Trajectories, FollowEachOtherAsSoonAsOneHasEnded) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.run(500ms);
  for (const double goal : {0.2, 0.4, 0.1}) {
    const std::size_t before = scene.robot().events().size();
    const bus::Answer moved = scene.move({goal, -goal}, 1s);
    ASSERT_TRUE(moved.success) << moved.message;
    const auto ended = [&] {
      const auto& events = scene.robot().events();
      return std::any_of(
          events.begin() + static_cast<std::ptrdiff_t>(before), events.end(),
          [](const bus::Event& event) { return event.text.str() == "pair: goal reached"; });
    };
    ASSERT_TRUE(scene.runUntil(ended, 3s)) << scene.told();
    EXPECT_NEAR(scene.position("left"), goal, 0.01);
  }
}

/// 607Ah as it was on the wire (RPDO1, bytes 2 to 5) of node 1, in rad, with its steps.
class WireTargets {
 public:
  explicit WireTargets(Scene& scene) {
    scene.world().bus().setMonitor([this](const can::Frame& frame, Time) { take(frame); });
  }
  double largest_step = 0.0, largest_change = 0.0;  // rad; rad between one step and the next
  void forget() { largest_step = largest_change = 0.0; }

 private:
  void take(const can::Frame& frame) {
    if (frame.id != 0x201 || frame.size < 6) return;
    std::uint32_t raw = 0;
    for (unsigned i = 0; i < 4; ++i) raw |= std::uint32_t{frame.data[2 + i]} << (8 * i);
    const double target = static_cast<std::int32_t>(raw) * kRadPerCount;
    if (count_ > 0) {
      const double step = target - last_;
      largest_step = std::max(largest_step, std::abs(step));
      if (count_ > 1) largest_change = std::max(largest_change, std::abs(step - last_step_));
      last_step_ = step;
    }
    last_ = target;
    ++count_;
  }
  double last_ = 0.0, last_step_ = 0.0;
  unsigned count_ = 0;
};

constexpr double kPeriod = 0.004;
constexpr double kStepLimit = 1.5 * kPeriod * 1.001;                               // velocity limit
constexpr double kChangeLimit = 4.0 * kPeriod * kPeriod * 1.1 + 2 * kRadPerCount;  // acceleration

class Commands : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(scene.boot());
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  }
  Scene scene{loadText(genericPair())};
};

TEST_F(Commands, AStreamedPositionIsApproachedWithinTheLimitsOnTheWire) {
  WireTargets wire(scene);
  scene.run(2s);  // a long rest must not be made good in one step
  ASSERT_EQ(scene.setpoint("left", 2.0), "");
  scene.run(700ms);
  ASSERT_EQ(scene.setpoint("left", -1.0), "");
  scene.run(5s);
  EXPECT_NEAR(scene.position("left"), -1.0, 1e-3);
  EXPECT_LE(wire.largest_step, kStepLimit);
  EXPECT_LE(wire.largest_change, kChangeLimit);
  EXPECT_GT(wire.largest_step, 0.0);
}

TEST_F(Commands, AStreamGoesOnSmoothlyAfterAHostThatSlept) {
  WireTargets wire(scene);
  ASSERT_EQ(scene.setpoint("left", 2.0), "");
  scene.run(500ms);
  scene.robot().freeze(60ms);
  scene.run(3s);
  EXPECT_LE(wire.largest_step, kStepLimit);
  EXPECT_NEAR(scene.position("left"), 2.0, 1e-3) << scene.told();
}

TEST_F(Commands, ATrajectoryGoesOnWhereItWasAfterAHostThatSlept) {
  WireTargets wire(scene);
  ASSERT_TRUE(scene.move({2.0, 2.0}, 2s).success);
  scene.run(1s);
  scene.robot().freeze(14ms);  // more than three cycles, at 1.5 rad/s
  scene.run(3s);
  EXPECT_LE(wire.largest_step, kStepLimit);
  EXPECT_NEAR(scene.position("left"), 2.0, 1e-3) << scene.told();
}

TEST_F(Commands, AVelocityStreamThatDriesUpStopsTheAxis) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csv").success);
  scene.stream("left", 1.0, 1s);
  ASSERT_NEAR(scene.velocity("left"), 1.0, 0.02);
  const double at = scene.position("left");
  scene.run(180ms + 200ms + 300ms);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3);
  EXPECT_LT(scene.position("left") - at, 1.0 * 0.2 + 1.0 / (2 * 4.0) + 0.05);
  EXPECT_TRUE(scene.truth("left").power_stage_on) << "stopped, not disabled";
}

TEST_F(Commands, AVelocityStopsBeforeThePositionLimit) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csv").success);
  for (int i = 0; i < 300; ++i) {
    (void)scene.setpoint("left", 1.5);  // refused or braked near the limit, both are well
    scene.run(10ms);
  }
  EXPECT_LE(scene.seen("left").highest, 2.5 + 2e-3);
  EXPECT_GT(scene.seen("left").highest, 2.3);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-2);
}

TEST_F(Commands, ASetPointBeyondTheLimitsEndsAtTheLimit) {
  ASSERT_EQ(scene.setpoint("left", 9.0), "");
  scene.run(4s);
  EXPECT_NEAR(scene.position("left"), 2.5, 1e-3);
  EXPECT_LE(scene.seen("left").highest, 2.5 + 1e-4);
}

TEST_F(Commands, TrajectoriesThatCannotBeFollowedAreRefusedAndNothingMoves) {
  scene.forget();
  const auto far = scene.move({3.0, 0.0}, 9s);
  EXPECT_FALSE(far.success);
  EXPECT_THAT(far.message, HasSubstr("left"));
  const auto fast = scene.move({2.0, 0.0}, 500ms);
  EXPECT_FALSE(fast.success);
  EXPECT_THAT(fast.message, HasSubstr("left"));
  EXPECT_FALSE(scene.move({std::nan(""), 0.0}, 3s).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "right").success);
  const auto disabled = scene.move({0.5, 0.5}, 3s);
  EXPECT_FALSE(disabled.success);
  EXPECT_THAT(disabled.message, HasSubstr("right"));
  scene.run(500ms);
  EXPECT_LT(scene.seen("left").travel(), 1e-4);
  EXPECT_LT(scene.seen("right").travel(), 1e-4);
}

TEST_F(Commands, ANewTrajectoryTakesOverSmoothly) {
  WireTargets wire(scene);
  ASSERT_TRUE(scene.move({2.0, 1.0}, 5s).success);
  scene.run(2s);
  ASSERT_TRUE(scene.move({-0.5, 0.0}, 6s).success);
  scene.run(1s);
  ASSERT_TRUE(scene.move({0.5, 0.0}, 5s).success);
  scene.run(7s);
  EXPECT_NEAR(scene.position("left"), 0.5, 1e-3);
  EXPECT_LE(wire.largest_step, kStepLimit);
  EXPECT_LE(wire.largest_change, kChangeLimit);
}

TEST_F(Commands, AnEmptyTrajectoryRampsTheGroupDown) {
  WireTargets wire(scene);
  ASSERT_TRUE(scene.move({2.0, -2.0}, 4s).success);
  scene.run(2s);
  ASSERT_GT(scene.velocity("left"), 0.5);
  EXPECT_TRUE(scene.stopGroup().success);
  scene.run(700ms);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3);
  EXPECT_NEAR(scene.velocity("right"), 0.0, 1e-3);
  EXPECT_LT(scene.position("left"), 1.6);
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  EXPECT_LE(wire.largest_step, kStepLimit);
  EXPECT_LE(wire.largest_change, kChangeLimit);
  ASSERT_TRUE(scene.move({0.0, 0.0}, 4s).success) << "ready for the next one";
}

TEST_F(Commands, HaltStopsAndEnableReleasesWithoutGoingOn) {
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "pp").success);
  ASSERT_EQ(scene.setpoint("left", 2.0), "");
  scene.run(800ms);
  ASSERT_GT(scene.velocity("left"), 0.5);
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "left").success);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-2);
  scene.forget();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  scene.run(1s);
  EXPECT_LT(scene.seen("left").travel(), 2e-3);
}

TEST_F(Commands, QuickStopIsHardAndEndsWithoutPower) {
  ASSERT_TRUE(scene.move({2.0, 2.0}, 4s).success);
  scene.run(2s);
  const double at = scene.position("left");
  const double speed = scene.velocity("left");
  ASSERT_TRUE(scene.procedure(ProcedureKind::quick_stop).success);
  scene.run(100ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on || scene.truth("right").power_stage_on);
  EXPECT_LT(scene.position("left") - at, speed * speed / (2 * 8.0) + speed * 0.05);
}

TEST(Shutdown, InMotionStopsDisablesAndLeavesTheDrivesPreOperational) {
  Scene scene(loadFile("arm.yaml"));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::home).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  const auto moving = scene.move({-1.6, 0.9, 0.6, 0.6}, 3s);
  ASSERT_TRUE(moving.success) << moving.message;
  scene.run(1500ms);
  ASSERT_GT(std::abs(scene.velocity("wrist")), 0.1);
  scene.forget();
  const Time began = scene.now();
  scene.robot().network().beginShutdown(began);
  ASSERT_TRUE(scene.runUntil([&] { return scene.robot().network().shutDown(); }, 2s));
  EXPECT_LT(scene.now() - began, 2s);
  scene.run(20ms);
  for (const char* axis : {"shoulder", "elbow", "wrist", "gripper"}) {
    EXPECT_FALSE(scene.truth(axis).power_stage_on) << axis;
    EXPECT_FALSE(scene.truth(axis).moving) << axis;
    EXPECT_EQ(scene.truth(axis).nmt, canopen::NmtState::pre_operational) << axis;
  }
  EXPECT_LE(scene.seen("wrist").fastest, 2.5 * 1.1);
  EXPECT_THAT(scene.procedure(ProcedureKind::enable).message, HasSubstr("shutting down"));
}

/// Starts what the node would start of a robot's file, on a bus without drives.
/// @return how many frames were sent within two seconds.
unsigned framesOf(const YAML::Node& tree, Problems& problems) {
  const auto ready = config::readyRobot(
      tree, config::profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  if (!ready) return 0;
  unsigned frames = 0;
  tools::VirtualRobot robot(ready->robot, ready->master, {});
  robot.world().bus().setMonitor([&](const can::Frame&, Time) { ++frames; });
  robot.start();
  robot.run(2s);
  return frames;
}

unsigned framesOf(const std::string& file, Problems& problems) {
  return framesOf(config::readRobotFile(file, problems), problems);
}

// The node itself is heard on the wire in test/vcan/vcan_test.py.
TEST(Configuration, WithMistakesIsRefusedWithAllOfThemAtOnceAndSendsNothing) {
  Problems problems;
  EXPECT_GT(framesOf(cia402::test::configFolder() + "/robots/arm.yaml", problems), 500U);
  EXPECT_EQ(framesOf(cia402::test::testFolder() + "/config/ten_mistakes.yaml", problems), 0U);
  EXPECT_EQ(problems.list().size(), 10u) << problems.text();
}

/// What the loader has to say of a robot's text.
std::string problemsOf(const std::string& yaml) {
  Problems problems;
  const auto profiles = config::profilesIn({cia402::test::configFolder() + "/drives"});
  config::loadRobot(YAML::Load(yaml), profiles, problems);
  return problems.text();
}

struct Advice {
  const char* axis;     ///< options of the left axis with which its group is refused
  const char* says;     ///< the advice
  const char* follows;  ///< the options with which it was followed
};

class RefusedGroup : public testing::TestWithParam<Advice> {};

TEST_P(RefusedGroup, FollowsTrajectoriesOnceItsAdviceIsFollowed) {
  const Advice& advice = GetParam();
  const std::string problems = problemsOf(genericPair(advice.axis));
  EXPECT_THAT(problems, HasSubstr("`left` cannot follow trajectories"));
  EXPECT_THAT(problems, HasSubstr(advice.says));
  const std::string followed = genericPair(advice.follows);
  ASSERT_EQ(problemsOf(followed), "");
  Scene scene(loadText(followed));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  const bus::Answer switched = scene.procedure(ProcedureKind::set_mode, "left", "csp");
  ASSERT_TRUE(switched.success) << switched.message;
  const bus::Answer moved = scene.move({0.4, -0.3}, 1s);
  ASSERT_TRUE(moved.success) << moved.message;
  scene.run(2s);
  EXPECT_NEAR(scene.position("left"), 0.4, 0.001);
  EXPECT_NEAR(scene.position("right"), -0.3, 0.001);
}

INSTANTIATE_TEST_SUITE_P(
    Advice, RefusedGroup,
    testing::Values(
        Advice{", mode: pv, modes: []", "add cyclic_position to `axes/left/modes`",
               ", mode: pv, modes: [cyclic_position]"},
        Advice{
            ", mode: pv, pdos: {rpdo1: [controlword, mode_of_operation, target_velocity], tpdo1: "
            "[statusword, position_actual, mode_display]}",
            "map target_position into an RPDO in `axes/left/pdos`",
            ", mode: pv, pdos: {rpdo1: [controlword, mode_of_operation, target_velocity], rpdo2: "
            "[target_position], tpdo1: [statusword, position_actual, mode_display]}"}),
    [](const auto& param) {
      return std::string(param.index == 0 ? "AddTheMode" : "MapTheTarget");
    });

TEST(RefusedGroupOfTwo, LoadsWithoutTheJoint) {
  std::string yaml = genericPair(", mode: pv, modes: []");
  EXPECT_THAT(problemsOf(yaml), HasSubstr("or leave its joint out of the group"));
  yaml.replace(yaml.find("joints: [left, right]"), 21, "joints: [right]");
  EXPECT_EQ(problemsOf(yaml), "");
}

// Robots that would run if nobody minded.
TEST(Configuration, WithOneMistakeSendsNothing) {
  struct Mistake {
    std::vector<std::string> path;
    const char* value;
  };
  for (const Mistake& mistake :
       {Mistake{{"axes", "shoulder", "colour"}, "red"}, Mistake{{"bus", "sync_perod"}, "0.004"},
        Mistake{{"bus", "sync_period"}, "0.001"},
        Mistake{{"axes", "elbow", "homing", "method"}, "99"}}) {
    Problems problems;
    YAML::Node tree =
        config::readRobotFile(cia402::test::configFolder() + "/robots/arm.yaml", problems);
    YAML::Node at = tree;
    for (const std::string& key : mistake.path) at.reset(at[key]);
    at = mistake.value;
    EXPECT_EQ(framesOf(tree, problems), 0U) << mistake.path.back();
    EXPECT_EQ(problems.list().size(), 1U) << problems.text();
    EXPECT_THAT(problems.text(), HasSubstr(mistake.path.back()));
  }
}

}  // namespace
}  // namespace cia402
