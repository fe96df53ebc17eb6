// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives of another class, which the driver does not serve: it says so in words, claims nothing,
// and leaves no power behind. What they do was seen in recordings of a Tongyi IxL.
#include "system/field_profile.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

TEST(UnservedDrive, ThatStaysPreOperationalIsNotReady) {
  Scene scene(loadText(fieldPair("", "communication: {stays_pre_operational: true}")));
  EXPECT_FALSE(scene.boot());
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): "));
  EXPECT_THAT(scene.told(),
              HasSubstr("its heartbeat did not say operational (but pre-operational) in time"));
  const bus::Answer answer = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("left (node 1)"));
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "right").success) << "the other is served";
}

TEST(UnservedDrive, ThatShowsNoStateIsNotSaidToBeEnabledAndHasNoPowerAfterwards) {
  Scene scene(loadText(fieldPair("", "quirks: {shows_no_state: true}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const double before = scene.position("left");
  const bus::Answer answer = scene.procedure(ProcedureKind::enable, "left");
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, AllOf(HasSubstr("left"), HasSubstr("switch on disabled")));
  scene.run(500ms);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_NEAR(scene.position("left"), before, 1e-4);
  EXPECT_FALSE(scene.move({before + 0.3, 0.0}, 1s).success);
}

TEST(UnservedDrive, ThatHomesByAnObjectIsNotSaidToBeHomed) {
  ReadyScene scene(fieldPair("",
                             "objects: {homing_start: \"60FB:04\"}, "
                             "dictionary: [[0x60FB, 4, homing_start, uint8, rw, \"-\", 0]]",
                             ", homing: {method: 17, search_velocity: 0.5, zero_velocity: 0.1, "
                             "timeout: 3.0}"));
  const double before = scene.position("left");
  const bus::Answer answer = scene.procedure(ProcedureKind::home, "left");
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("left"));
  EXPECT_THAT(answer.message, HasSubstr("homing"));
  EXPECT_FALSE(scene.state("left").homed);
  EXPECT_NEAR(scene.position("left"), before, 1e-4) << "nothing began";
}

}  // namespace
}  // namespace cia402
