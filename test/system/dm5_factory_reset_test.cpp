// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// P02.22 = 2 of a DM5: the factory's values [L3181].
#include "bus/jobs/factory_reset.h"
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kDm5{"megmeet_dm5", "8388608", "csp"};

bus::Answer resetDm5(Scene& scene, bool confirm) {
  return scene.call(bus::FactoryResetCommand{"joint", confirm});
}

TEST(Dm5FactoryReset, BringsBackWhatTheFactoryHasSet) {
  FamilyScene scene(familyJoint(kDm5));
  EXPECT_EQ(scene.number(0x2002, 1), 7U) << "P02.00, by `adjust`";
  const std::uint64_t factory = scene.number(0x2008, 1);
  ASSERT_TRUE(scene.call(bus::WriteObjectCommand{"joint", "speed_gain", "355"}).success);
  scene.mustSucceed(ProcedureKind::disable);
  scene.run(500ms);
  const bus::Answer asked = resetDm5(scene, false);
  EXPECT_FALSE(asked.success);
  EXPECT_THAT(asked.message, AllOf(HasSubstr("parameter_initialisation (2002:17) = 2"),
                                   HasSubstr("P02.00"), HasSubstr("confirm: true")));
  EXPECT_EQ(scene.number(0x2008, 1), 355U);
  const bus::Answer reset = resetDm5(scene, true);
  EXPECT_TRUE(reset.success) << reset.message;
  EXPECT_THAT(reset.message,
              AllOf(HasSubstr("all parameters by parameter_initialisation (2002:17)"),
                    HasSubstr("set P02.00"), HasSubstr("is disabled, not homed")));
  EXPECT_EQ(scene.number(0x2008, 1), factory);
  EXPECT_EQ(scene.number(0x2002, 1), 0U) << "local speed, as from the factory";
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  scene.forget();
  scene.mustSucceed(ProcedureKind::enable);
  EXPECT_EQ(scene.number(0x2002, 1), 7U);
  scene.run(300ms);
  expectNothingMoved(scene, "joint");
}

TEST(Dm5FactoryReset, IsRefusedWhileTheAxisIsEnabled) {
  FamilyScene scene(familyJoint(kDm5));
  const bus::Answer refused = resetDm5(scene, true);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("the axis is not disabled"));
  EXPECT_EQ(scene.number(0x2002, 1), 7U);
}

// 1 clears the fault memory, 3 the motor's type: written as an object, while it is disabled.
TEST(Dm5FactoryReset, IsTheNumberTwoAlone) {
  FamilyScene scene(familyJoint(kDm5));
  scene.mustSucceed(ProcedureKind::disable);
  scene.run(500ms);
  ASSERT_TRUE(scene.call(bus::WriteObjectCommand{"joint", "speed_gain", "355"}).success);
  const auto cleared = scene.call(bus::WriteObjectCommand{"joint", "2002:17", "1"});
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_EQ(scene.number(0x2008, 1), 355U);
  EXPECT_EQ(scene.number(0x2002, 1), 7U);
}

}  // namespace
}  // namespace cia402
