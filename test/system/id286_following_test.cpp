// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Following errors of an iD286-CNFA as the driver sees them: the drive has no 60F4h, and its alarm
// 19 may come late.
#include "system/id286_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

/// Its alarm comes at 30000 counts of the encoder only, 0.377 rad of the joint.
std::string lateAlarm(const char* mode) {
  return familyJoint({kId286Cnfa, "10000", mode},
                     ", simulation: {with: {dictionary: [[0x2102, 0, following_error_threshold, "
                     "uint16, rw, -, 30000, 1, 30000]]}}");
}

class Id286Following : public testing::TestWithParam<const char*> {};

TEST_P(Id286Following, ErrorsAreSeenByTheDriverBeforeTheDriveTellsThem) {
  FamilyScene scene(lateAlarm(GetParam()));
  scene.inject("joint", "blocked_rotor");
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(2s);
  EXPECT_EQ(scene.state("joint").error_code, 0) << "no alarm";
  EXPECT_THAT(scene.told(),
              AllOf(HasSubstr("joint (node 1)"), HasSubstr("what was commanded is given up")));
  scene.forget();
  scene.inject("joint", "clear");
  scene.expectStands(2s, 2e-3);
  ASSERT_EQ(scene.setpoint("joint", 0.2), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.2, 2e-3) << scene.told();
}

// Nothing is given up of a goal that is far, slow or changed under way.
TEST_P(Id286Following, ThatIsWellIsLeftAlone) {
  FamilyScene scene(replaced(lateAlarm(GetParam()), "velocity: 0.8", "velocity: 0.2"));
  const auto told = scene.axis("joint").noticeCount();
  ASSERT_EQ(scene.setpoint("joint", 0.6), "");
  scene.run(2s);
  ASSERT_EQ(scene.setpoint("joint", -0.1), "");
  scene.run(5s);
  EXPECT_NEAR(scene.position("joint"), -0.1, 2e-3);
  EXPECT_EQ(scene.axis("joint").noticeCount(), told) << scene.told();
}

class Id286Runaway : public testing::TestWithParam<const char*> {};

// A motor that turns, but too slowly, ends a trajectory by the tolerance of the path.
TEST(Id286Trajectory, FromWhichTheMotorFallsBehindIsStopped) {
  FamilyScene scene(
      familyJoint({kId286Cnfa, "10000", "position_by_velocity"},
                  ", write: [{object: max_motor_speed, value: 0.3}]") +
      "groups:\n  arm: {joints: [joint], constraints: {joint: {trajectory: 0.05, goal: 0.01}}}\n");
  ASSERT_TRUE(scene.move({-0.8}, 2s).success);
  scene.run(1500ms);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("trajectory stopped: joint"), HasSubstr("tolerance")));
  scene.run(2s);
  EXPECT_GT(scene.position("joint"), -0.7) << "it did not go on";
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_EQ(scene.state("joint").error_code, 0);
}

// A wrong 20C9h in closed loop: at the first command the motor runs the other way, as hard as it
// may. 2102h ends it by alarm 19: at 1000 counts, 0.1 turns of the motor or 0.0126 rad of the
// joint, where 1.2 * 250 turns/s^2 make 7.7 turns/s of it. The drive lets the motor go, which its
// friction of 0.05 * 250 turns/s^2 stops within 2.4 turns or 0.3 rad. Nothing moves it after that.
TEST_P(Id286Runaway, IsEndedByTheAlarmOfTheDriveAndTold) {
  FamilyScene scene(familyJoint({kId286Cnfa, "10000", GetParam()}));
  scene.inject("joint", "reversed_motor");
  scene.forget();
  scene.expectStands(500ms);
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(200ms);
  EXPECT_LT(scene.position("joint"), -0.0126) << "it runs away";
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << scene.told();
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("0x0019"));
  scene.run(3s);
  EXPECT_GT(scene.position("joint"), -0.0126 - 0.3 - 0.03);
  scene.expectStands(1s);
  EXPECT_THAT(scene.setpoint("joint", 0.3), HasSubstr("joint (node 1)"));
}

INSTANTIATE_TEST_SUITE_P(In, Id286Runaway, testing::Values("pp", "position_by_set_points"),
                         [](const auto& tested) { return std::string(tested.param); });

INSTANTIATE_TEST_SUITE_P(In, Id286Following,
                         testing::Values("pp", "position_by_velocity", "position_by_set_points"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace cia402
