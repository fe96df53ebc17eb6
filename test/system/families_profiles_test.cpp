// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Profile modes of each family: targets that change in motion, and what the bits of the statusword
// tell of them.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;

std::vector<FamilyMode> familiesIn(const char* mode) {
  std::vector<FamilyMode> modes = families();
  for (FamilyMode& one : modes) one.mode = mode;
  return modes;
}

class FamilyGoals : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilyGoals, ThatChangeInMotionCountAtOnce) {
  FamilyScene scene(familyJoint(GetParam()));
  ASSERT_EQ(scene.setpoint("joint", 1.6), "");
  scene.run(800ms);
  const double speed = scene.velocity("joint"), from = scene.position("joint");
  ASSERT_GT(speed, 0.7);
  EXPECT_FALSE(scene.state("joint").target_reached);
  ASSERT_EQ(scene.setpoint("joint", -0.3), "");
  scene.run(200ms);
  ASSERT_EQ(scene.setpoint("joint", -0.4), "") << "one after the other";
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), -0.4, 1.1 * oneCount(GetParam()) + 1e-6) << scene.told();
  EXPECT_TRUE(scene.state("joint").target_reached);
  // 0.8 rad/s end by 4 rad/s^2 within 0.08 rad.
  EXPECT_LT(scene.seen("joint").highest, from + 0.08 * 1.1 + speed * 0.06);
}

INSTANTIATE_TEST_SUITE_P(All, FamilyGoals, testing::ValuesIn(familiesIn("pp")), familyName);

class FamilySpeeds : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilySpeeds, ThatChangeInMotionAreReachedAndBits10And12TellIt) {
  FamilyScene scene(familyJoint(GetParam()));
  const auto bit = [&](unsigned number) {
    return ((scene.truth("joint").statusword >> number) & 1U) != 0;
  };
  // The iD286 prints bit 12 set while it turns [L1899-1909].
  const bool tells_turning = GetParam().family != std::string(kId286Cnfa);
  EXPECT_TRUE(bit(12)) << "it stands";
  for (const double speed : {0.5, 0.2, -0.3, 0.6}) {
    scene.stream("joint", speed, 700ms);
    EXPECT_NEAR(scene.velocity("joint"), speed, 2e-3);
    EXPECT_EQ(bit(12), !tells_turning) << speed;
    EXPECT_TRUE(bit(10)) << speed;
    EXPECT_TRUE(scene.state("joint").target_reached) << speed;
  }
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_TRUE(bit(12));
}

INSTANTIATE_TEST_SUITE_P(All, FamilySpeeds, testing::ValuesIn(familiesIn("pv")), familyName);

}  // namespace
}  // namespace cia402
