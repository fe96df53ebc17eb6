// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Set-points for all joints of a group at once: all are taken, or none.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "bus/group_scene.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

config::RobotConfig armIn(const std::string& shoulder, const std::string& elbow) {
  config::RobotConfig robot = test::testRobot();
  robot.axes[0].mode = shoulder;
  robot.axes[1].mode = elbow;
  return robot;
}

struct SetPointWorld : RobotWorld {
  explicit SetPointWorld(const config::RobotConfig& config) : RobotWorld(config) { enable(); }
  explicit SetPointWorld(const std::string& mode) : SetPointWorld(armIn(mode, mode)) {}

  /// @return the refusal; empty if they were taken.
  std::string command(std::vector<double> values, std::optional<Time> came = {}) {
    const auto answers = begin(GroupSetpointsCommand{0, std::move(values), came});
    return answers->empty() ? std::string() : answers->front().message;
  }
  /// What either drive is commanded from now on does not change.
  void expectNothingBegins(const std::string& what) {
    const std::int32_t before[] = {drives[0].target_position, drives[1].target_position,
                                   drives[0].target_velocity, drives[1].target_velocity};
    run(200ms);
    EXPECT_EQ(drives[0].target_position, before[0]) << what;
    EXPECT_EQ(drives[1].target_position, before[1]) << what;
    EXPECT_EQ(drives[0].target_velocity, before[2]) << what;
    EXPECT_EQ(drives[1].target_velocity, before[3]) << what;
  }
};

/// In which cycle a drive got its first target other than 0.
std::size_t firstOther(const std::vector<std::int32_t>& targets) {
  std::size_t i = 0;
  while (i < targets.size() && targets[i] == 0) ++i;
  return i;
}

TEST(GroupSetPoints, OfPositionsReachAllDrivesInTheSameCycle) {
  SetPointWorld world("cyclic_position");
  for (auto& drive : world.drives) drive.targets.clear();
  ASSERT_EQ(world.command({0.5, -0.3}), "");
  world.run(1s);
  EXPECT_EQ(world.drives[0].position, 50000);
  EXPECT_EQ(world.drives[1].position, -30000);
  EXPECT_EQ(firstOther(world.drives[0].targets), firstOther(world.drives[1].targets));
  EXPECT_LT(firstOther(world.drives[0].targets), 3u);
}

TEST(GroupSetPoints, OfVelocitiesEndAfterTheTimeOut) {
  SetPointWorld world("cyclic_velocity");
  ASSERT_EQ(world.command({1.0, -0.5}), "");
  world.run(190ms);
  EXPECT_EQ(world.drives[0].target_velocity, 100000);
  EXPECT_EQ(world.drives[1].target_velocity, -50000);
  world.run(130ms);  // 1 rad/s at 10 rad/s^2
  EXPECT_EQ(world.drives[0].target_velocity, 0);
  EXPECT_EQ(world.drives[1].target_velocity, 0);
  EXPECT_TRUE(world.axis(0).stream().dried_up);
  EXPECT_TRUE(world.axis(1).stream().dried_up);
}

TEST(GroupSetPoints, TheTimeOutCountsFromWhenTheyCame) {
  SetPointWorld world("cyclic_velocity");
  ASSERT_EQ(world.command({1.0, 1.0}, world.now - 150ms), "");
  world.run(60ms);
  EXPECT_TRUE(world.axis(0).stream().dried_up);
}

TEST(GroupSetPoints, OfEffortsReachAllAxes) {
  SetPointWorld world("cyclic_torque");
  ASSERT_EQ(world.command({2.0, -3.0}), "");
  world.run(10ms);
  EXPECT_DOUBLE_EQ(world.axis(0).target(), 2.0);
  EXPECT_DOUBLE_EQ(world.axis(1).target(), -3.0);
}

TEST(GroupSetPoints, ThatAreNotOnePerJointAreRefusedWithTheOrder) {
  SetPointWorld world("cyclic_position");
  for (const std::vector<double>& values :
       {std::vector<double>{}, {0.5}, {0.5, 0.5, 0.5}, std::vector<double>(1000, 0.5)}) {
    EXPECT_THAT(world.command(values),
                AllOf(HasSubstr("arm: set-points refused, nothing moves for them: " +
                                std::to_string(values.size()) + " came for 2 joints"),
                      HasSubstr("shoulder, elbow")));
  }
  world.expectNothingBegins("wrong count");
}

TEST(GroupSetPoints, OfWhichOneIsNoNumberMoveNobody) {
  SetPointWorld world("cyclic_position");
  for (const double bad : {kNoNumber, HUGE_VAL, -HUGE_VAL}) {
    EXPECT_THAT(world.command({0.5, bad}), HasSubstr("elbow: it is not a finite number"));
    EXPECT_THAT(world.command({bad, 0.5}), HasSubstr("shoulder: it is not a finite number"));
  }
  world.expectNothingBegins("NaN");
}

struct Beyond {
  const char* mode;
  double most;  // of the shoulder
  const char* words;
};

TEST(GroupSetPoints, OfWhichOneIsBeyondALimitMoveNobody) {
  for (const Beyond& limit : {Beyond{"cyclic_position", 3.0, "beyond its limits"},
                              Beyond{"cyclic_velocity", 2.0, "beyond its limit of velocity"},
                              Beyond{"cyclic_torque", 5.0, "beyond its limit of effort"}}) {
    SCOPED_TRACE(limit.mode);
    SetPointWorld world(limit.mode);
    for (const double sign : {1.0, -1.0}) {
      EXPECT_THAT(world.command({sign * limit.most * 1.001, 0.1}),
                  AllOf(HasSubstr("shoulder: "), HasSubstr(limit.words)));
    }
    world.expectNothingBegins("beyond");
    EXPECT_DOUBLE_EQ(world.axis(1).target(), 0.0);
    EXPECT_EQ(world.command({-limit.most, 0.1}), "") << "at the limit";
  }
}

TEST(GroupSetPoints, AreRefusedWhereOneJointIsNotReady) {
  SetPointWorld world("cyclic_position");
  ASSERT_TRUE(world.call(ProcedureKind::disable, "elbow").success);
  EXPECT_THAT(world.command({0.5, 0.5}), HasSubstr("elbow (node 2): not enabled"));
  world.expectNothingBegins("disabled");
}

TEST(GroupSetPoints, AreRefusedWhileATrajectoryMovesOneOfTheJoints) {
  SetPointWorld world("cyclic_position");
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  world.run(500ms);
  EXPECT_THAT(world.command({0.0, 0.5}), HasSubstr("follows a trajectory of group arm"));
  world.run(2s);
  EXPECT_EQ(world.drives[0].position, 100000);
  EXPECT_EQ(world.drives[1].position, 0);
}

TEST(GroupSetPoints, DoNotMixPositionsAndVelocities) {
  SetPointWorld world(armIn("cyclic_position", "cyclic_velocity"));
  EXPECT_THAT(world.command({0.5, 0.5}),
              AllOf(HasSubstr("shoulder is in mode cyclic_position, elbow is in mode "
                              "cyclic_velocity"),
                    HasSubstr("set_mode first")));
  world.expectNothingBegins("mixed");
}

TEST(GroupSetPoints, ThatWaitedLongerThanTheTimeOutAreRefused) {
  SetPointWorld world("cyclic_position");
  EXPECT_THAT(world.command({0.5, 0.5}, world.now - 201ms),
              AllOf(HasSubstr("it waited for 0.201 s"), HasSubstr("command_timeout (0.2 s)")));
  world.expectNothingBegins("stale");
  EXPECT_EQ(world.command({0.5, 0.5}, world.now - 200ms), "");
}

TEST(GroupSetPoints, OfOneAxisThatWaitedTooLongIsRefused) {
  SetPointWorld world("cyclic_position");
  const auto stale = world.begin(SetpointCommand{1, 0.5, world.now - 201ms});
  ASSERT_EQ(stale->size(), 1u);
  EXPECT_THAT(stale->front().message, HasSubstr("elbow: set-point refused: it waited for"));
  world.expectNothingBegins("stale");
}

TEST(GroupSetPoints, FromTheFutureCountAsJustCome) {
  SetPointWorld world("cyclic_velocity");
  ASSERT_EQ(world.command({1.0, 1.0}, world.now + 10s), "");
  world.run(220ms);
  EXPECT_TRUE(world.axis(0).stream().dried_up);
}

TEST(GroupSetPoints, ThatAreRefusedLeaveTheStreamBeforeToItsTimeOut) {
  SetPointWorld world("cyclic_velocity");
  ASSERT_EQ(world.command({1.0, 1.0}), "");
  world.run(150ms);
  EXPECT_NE(world.command({1.0, kNoNumber}), "");
  world.run(60ms);
  EXPECT_TRUE(world.axis(0).stream().dried_up);
}

TEST(GroupSetPoints, LeadAJointThatStandsBeyondItsLimitBackOnly) {
  config::RobotConfig robot = armIn("cyclic_position", "cyclic_position");
  robot.axes[0].limits.upper = -0.1;  // it stands at 0
  SetPointWorld world(robot);
  EXPECT_THAT(world.command({0.1, 0.0}), HasSubstr("beyond its limits"));
  world.expectNothingBegins("further out");
  EXPECT_EQ(world.command({-0.05, 0.0}), "");
}

}  // namespace
}  // namespace cia402::bus
