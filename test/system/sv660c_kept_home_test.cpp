// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Statusword bit 15 of an SV660C: the drive knows its home [L618].
#include "system/kept_home.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

std::string sv660cKept(const std::string& more) {
  return sv660cJoint(", homing: {method: 35, offset: 0.5" + more + "}", "initial_position: 1.1");
}

TEST(Sv660cKeptHome, CountsOnceTheDriveIsBack) {
  Scene scene(loadText(sv660cKept(kKeptByDrive)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(200ms);
  EXPECT_FALSE(scene.state("joint").homed) << "bit 15 is 0 after power-on";
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", 0.8), "");
  scene.run(2s);
  loseAndRecover(scene);
  EXPECT_TRUE(scene.state("joint").homed) << scene.told();
  EXPECT_NEAR(scene.state("joint").position, 0.8, 1e-5);
  ASSERT_EQ(scene.setpoint("joint", 0.2), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 1.1 - 0.5 + 0.2, 1e-5) << "0.5 was at 1.1";
  EXPECT_EQ(sv660cNumber(scene, 0x607D, 2), 1989437U) << "its limits are back, too";
}

TEST(Sv660cKeptHome, CountsOnlyWhereTheAxisSaysSo) {
  Scene scene(loadText(sv660cKept("")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  loseAndRecover(scene);
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_THAT(scene.setpoint("joint", 0.2), HasSubstr("not homed"));
}

// Its encoder is incremental: it begins anew without power.
TEST(Sv660cKeptHome, IsGoneWithThePower) {
  Scene scene(loadText(sv660cKept(kKeptByDrive)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  scene.inject("joint", "power_cycle");
  scene.run(4s);
  EXPECT_THAT(scene.procedure(ProcedureKind::recover, "joint").message,
              HasSubstr("joint is not homed: home"));
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_THAT(scene.setpoint("joint", 0.2), HasSubstr("not homed"));
}

// What a person declares is no home of the drive.
TEST(Sv660cKeptHome, HasNothingToDoWithWhatIsDeclared) {
  Scene scene(loadText(sv660cKept(kKeptByDrive)));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(declare(scene, "joint", -0.3).success);
  scene.run(500ms);
  EXPECT_TRUE(scene.state("joint").homed);
  EXPECT_NEAR(scene.state("joint").position, -0.3, 1e-5);
  loseAndRecover(scene);
  EXPECT_FALSE(scene.state("joint").homed) << "bit 15 is still 0";
}

TEST(Sv660cKeptHome, IsRefusedOfADriveThatSaysNothingOfIt) {
  Problems problems;
  std::string yaml = genericPair(", homing: {method: 37, kept_by_drive: true}");
  config::loadRobot(YAML::Load(yaml), config::profilesIn({test::configFolder() + "/drives"}),
                    problems);
  EXPECT_THAT(problems.text(), HasSubstr("axes/left/homing/kept_by_drive: profile generic_cia402 "
                                         "has no bit"));
}

}  // namespace
}  // namespace cia402
