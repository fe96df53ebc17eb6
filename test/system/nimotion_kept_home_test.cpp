// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Statusword bit 15 of a NiMotion: it was homed since its power came [768].
#include "drive/profile/status_bits.h"
#include "system/families_motion.h"
#include "system/kept_home.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The negative limit switch, where it homes, lies at -0.4 rad and is to read 0.3.
std::string nimotionKept(const std::string& more) {
  return familyJoint(nimotionIn("pp"),
                     ", homing: {method: 17, search_velocity: 0.4, zero_velocity: 0.05, "
                     "acceleration: 2.0, offset: 0.3" +
                         more + "}, simulation: {lower_limit_switch: -0.4}" + kNimotionSwitches);
}

std::string bitsOf(Scene& scene) {
  const drive::AxisState& state = scene.state("joint");
  return drive::statusBitsText(state.statusword, state.mode,
                               scene.loaded().robot.axes[0].profile->status_words);
}

TEST(NimotionKeptHome, CountsWithItsOffsetOnceTheDriveIsBack) {
  Scene scene(loadText(nimotionKept(kKeptByDrive)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.run(200ms);
  EXPECT_FALSE(scene.state("joint").homed) << "bit 15 is 0 after power-on";
  EXPECT_THAT(bitsOf(scene), Not(HasSubstr("homed since power-on")));
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  EXPECT_EQ(scene.truth("joint").statusword & 0x8000, 0x8000);
  scene.run(50ms);
  EXPECT_THAT(bitsOf(scene), HasSubstr("homed since power-on")) << "and people are shown it";
  ASSERT_EQ(scene.setpoint("joint", 0.8), "");
  scene.run(2s);
  loseAndRecover(scene);
  EXPECT_TRUE(scene.state("joint").homed) << scene.told();
  EXPECT_NEAR(scene.state("joint").position, 0.8, 1e-4);
  ASSERT_EQ(scene.setpoint("joint", 0.5), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), -0.4 - 0.3 + 0.5, 2e-3) << "0.3 was at -0.4";
  const double counts = (2.5 - 0.3) / 6.283185307179586 * 50.0 * 4000.0;
  const sim::Entry* limit = scene.drive("joint").dictionary().find({0x607D, 2});
  EXPECT_NEAR(static_cast<double>(sim::asSigned(*limit)), counts, 1.0) << "its limits are back";
}

TEST(NimotionKeptHome, CountsOnlyWhereTheAxisSaysSo) {
  Scene scene(loadText(nimotionKept("")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  loseAndRecover(scene);
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_THAT(bitsOf(scene), HasSubstr("homed since power-on")) << "the drive still says so";
  EXPECT_THAT(scene.setpoint("joint", 0.2), HasSubstr("not homed"));
}

// Its encoder is incremental: "since this power-on" [768].
TEST(NimotionKeptHome, IsGoneWithThePower) {
  Scene scene(loadText(nimotionKept(kKeptByDrive)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  scene.inject("joint", "power_cycle");
  scene.run(4s);
  EXPECT_THAT(scene.procedure(ProcedureKind::recover, "joint").message,
              HasSubstr("joint is not homed: home"));
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_THAT(bitsOf(scene), Not(HasSubstr("homed since power-on")));
}

// The edge of a virtual input is no homing of the drive.
TEST(NimotionKeptHome, IsRefusedWithTheMethodThatIsNoHomingOfTheDrive) {
  Problems problems;
  config::loadRobot(
      YAML::Load(familyJoint(nimotionIn("pp"), ", homing: {method: 35, kept_by_drive: true}")),
      config::profilesIn({test::configFolder() + "/drives"}), problems);
  EXPECT_THAT(problems.text(), AllOf(HasSubstr("axes/joint/homing/kept_by_drive: method 35"),
                                     HasSubstr("does not know its home by it")));
}

}  // namespace
}  // namespace cia402
