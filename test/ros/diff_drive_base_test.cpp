// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/diff_drive_base.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace cia402::ros_node {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// Two wheels on the left, one on the right, which turn as they are told; 50 steps a second.
struct DiffDriveTest : testing::Test {
  static DiffDriveOptions options() {
    DiffDriveOptions options;
    options.left = {"front_left", "rear_left"};
    options.right = {"right"};
    options.geometry = {0.4, 0.1};
    options.limits = {0.5, 1.0, 1.0, 2.0, 8.0};
    return options;
  }

  void command(double linear, double angular) {
    ASSERT_EQ(base.command({linear, angular}, now), "");
  }
  void measure() { base.measured(wheels, now); }
  /// One step; the wheels turn by what was commanded, if that is so.
  void step() {
    now += 20ms;
    speeds = base.step(now);
    if (speeds) {
      wheels[0] += speeds->left * 0.02;
      wheels[1] += speeds->left * 0.02;
      wheels[2] += speeds->right * 0.02;
    }
    if (measures) measure();
    for (std::string& text : base.takeNews()) news.push_back(text);
  }
  void run(Duration duration) {
    for (const Time end = now + duration; now < end;) step();
  }
  /// Commands again and again.
  void drive(double linear, double angular, Duration duration) {
    for (const Time end = now + duration; now < end;) {
      command(linear, angular);
      step();
    }
  }

  DiffDriveBase base{options()};
  Time now{10s};
  std::vector<double> wheels{100.0, -5.0, 7.0};
  std::optional<motion::WheelSpeeds> speeds;
  std::vector<std::string> news;
  bool measures = true;
};

TEST_F(DiffDriveTest, LeavesTheDriverAloneUntilSomebodyCommands) {
  run(1s);
  EXPECT_FALSE(speeds.has_value());
  EXPECT_THAT(news, IsEmpty());
}

TEST_F(DiffDriveTest, FollowsCommandsAndKeepsAccountOfItsWay) {
  measure();
  drive(0.3, 0.0, 2s);
  EXPECT_NEAR(speeds->left, 3.0, 1e-9);
  EXPECT_NEAR(speeds->right, 3.0, 1e-9);
  // 0.3 s to 0.3 m/s, the first step of which takes no time
  EXPECT_NEAR(base.odometry().pose().position.x(), 0.3 * 1.85, 0.01);
  EXPECT_NEAR(base.velocity().linear, 0.3, 1e-9);
  drive(0.0, 0.5, 2s);
  EXPECT_NEAR(speeds->left, -1.0, 1e-9);
  EXPECT_NEAR(speeds->right, 1.0, 1e-9);
  EXPECT_NEAR(base.velocity().angular, 0.5, 1e-9);
  EXPECT_THAT(news, IsEmpty());
}

TEST_F(DiffDriveTest, StopsByItsRampHalfASecondAfterTheLastCommandAndSaysSoOnce) {
  measure();
  drive(0.4, 0.0, 1s);
  run(480ms);  // it came a step before
  EXPECT_NEAR(speeds->left, 4.0, 1e-9) << "0.5 s are within the time-out";
  EXPECT_THAT(news, IsEmpty());
  double before = speeds->left;
  for (int i = 0; i < 20; ++i) {  // 0.4 m/s at 1 m/s^2
    step();
    EXPECT_LE(before - speeds->left, 0.2 + 1e-9);
    before = speeds->left;
  }
  EXPECT_NEAR(before, 0.0, 1e-9);
  run(1s);
  EXPECT_THAT(news, ElementsAre(HasSubstr("cmd_vel has not come for 0.5 s")));
  EXPECT_FALSE(speeds.has_value()) << "zeros have been said";
}

TEST_F(DiffDriveTest, SaysNothingWhereTheLastCommandWasToStand) {
  measure();
  drive(0.4, 0.0, 500ms);
  drive(0.0, 0.0, 1s);
  run(2s);
  EXPECT_THAT(news, IsEmpty());
}

TEST_F(DiffDriveTest, RefusesWhatIsNoNumberAndDoesNotTakeItForACommand) {
  measure();
  drive(0.4, 0.0, 1s);
  for (int i = 0; i < 60; ++i) {
    EXPECT_THAT(base.command({kNothing, 0.0}, now), HasSubstr("linear.x nan"));
    EXPECT_NE(base.command({0.0, HUGE_VAL}, now), "");
    step();
  }
  EXPECT_NEAR(speeds.value_or(motion::WheelSpeeds{}).left, 0.0, 1e-9) << "its time-out came";
}

TEST_F(DiffDriveTest, DoesNotSetOffWhileItsWheelsAreNotKnown) {
  measures = false;
  drive(0.4, 0.0, 1s);
  EXPECT_EQ(speeds->left, 0.0);
  EXPECT_THAT(news, ElementsAre(HasSubstr("no joint_states with the wheels have come yet")));
}

TEST_F(DiffDriveTest, StopsWhereJointStatesDoNotComeAndGoesOnWithThem) {
  measure();
  drive(0.4, 0.0, 1s);
  measures = false;
  drive(0.4, 0.0, 700ms);
  EXPECT_EQ(speeds->left, 0.0);
  EXPECT_THAT(news, ElementsAre(HasSubstr("have not come for 0.2 s")));
  const double before = base.odometry().pose().position.x();
  measures = true;
  drive(0.4, 0.0, 1s);
  EXPECT_NEAR(speeds->left, 4.0, 1e-9);
  // What the wheels turned meanwhile is counted: they have been seen to go on without a jump.
  EXPECT_NEAR(base.odometry().pose().position.x(), (wheels[2] - 7.0) * 0.1, 1e-9);
  EXPECT_GT(base.odometry().pose().position.x(), before);
}

TEST_F(DiffDriveTest, StopsWhereAWheelIsNotKnownAndNamesIt) {
  measure();
  drive(0.4, 0.0, 1s);
  const double before = base.odometry().pose().position.x();
  const double known = wheels[1];
  wheels[1] = kNothing;
  drive(0.4, 0.0, 1s);
  EXPECT_EQ(speeds->left, 0.0);
  EXPECT_THAT(news, ElementsAre(HasSubstr("the position of rear_left is not known")));
  EXPECT_EQ(base.odometry().pose().position.x(), before);
  wheels[1] = known - 40.0;  // its drive was started again
  measure();
  EXPECT_EQ(base.odometry().pose().position.x(), before);
  drive(0.4, 0.0, 100ms);
  EXPECT_GT(base.odometry().pose().position.x(), before);
  EXPECT_LT(base.odometry().pose().position.x(), before + 0.04);
}

TEST_F(DiffDriveTest, DoesNotTakeAnotherZeroForAWay) {
  measure();
  drive(0.2, 0.0, 1s);
  const double before = base.odometry().pose().position.x();
  wheels[2] += 50.0;  // set_position
  measure();
  EXPECT_EQ(base.odometry().pose().position.x(), before);
  drive(0.2, 0.0, 100ms);
  EXPECT_NEAR(base.odometry().pose().position.x(), before + 0.02, 0.005);
  EXPECT_NEAR(base.odometry().pose().heading, 0.0, 1e-9);
  EXPECT_THAT(news, ElementsAre(HasSubstr("right would have turned by 50")));
}

}  // namespace
}  // namespace cia402::ros_node
