// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/families.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "campaign/oracle_fixture.h"
#include "campaign/robot_plan.h"

namespace cia402::campaign {
namespace {

std::set<std::string> profiles() {
  std::set<std::string> names;
  const std::string folder = cia402::test::configFolder() + "/drives";
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.path().extension() == ".yaml") names.insert(file.path().stem().string());
  }
  return names;
}

TEST(Families, AreAllProfilesThatThereAre) {
  std::set<std::string> names;
  double shares = 0.0;
  for (const Family& known : families()) {
    names.insert(known.profile);
    shares += known.share;
  }
  EXPECT_EQ(names, profiles());
  EXPECT_NEAR(shares, 1.0, 1e-9);
}

// Six of them: the rarest one is an eighth of the axes that sit alone, of which there are hundreds.
TEST(Families, AreAllDrawnAndTheirRobotsLoad) {
  std::set<std::string> drawn;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const RobotPlan plan = planRobot(random);
    for (const AxisPlan& axis : plan.axes) drawn.insert(axis.family->profile);
    if (seed > 25) continue;
    const auto loaded = loadRobot(plan.yaml, cia402::test::configFolder());
    ASSERT_TRUE(loaded) << loaded.error().message << "\n" << plan.yaml;
    for (std::size_t i = 0; i < plan.axes.size(); ++i) {
      for (const ModePlan& mode : plan.axes[i].family->modes) {
        const drive::ModeSpec* const spec = loaded->robot.axes[i].profile->mode(mode.name);
        ASSERT_NE(spec, nullptr) << mode.name;
        const char kind = spec->kind == drive::ControlKind::position   ? 'p'
                          : spec->kind == drive::ControlKind::velocity ? 'v'
                                                                       : 't';
        EXPECT_EQ(kind, mode.kind) << mode.name;
      }
    }
  }
  EXPECT_EQ(drawn, profiles());
}

constexpr char kMixedRobot[] = R"(
bus: {interface: can0, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1, sync_counter: 0}
axes:
  dm5: {node_id: 1, drive: megmeet_dm5, counts_per_turn: 8388608, gear_ratio: 50.0, rated_torque: 1.27,
    limits: {velocity: 1, acceleration: 4, effort: 60}}
  stepper: {node_id: 2, drive: nimotion_stepper, counts_per_turn: 4000, gear_ratio: 50.0,
    limits: {velocity: 1, acceleration: 4}}
  percent: {node_id: 3, drive: id286_cnfa, keeps: [motor_current], counts_per_turn: 10000,
    gear_ratio: 50.0, rated_torque: 1.0, limits: {velocity: 1, acceleration: 4}}
  generic: {node_id: 4, drive: generic_cia402, counts_per_turn: 4096, gear_ratio: 50.0,
    rated_torque: 1.0, limits: {velocity: 1, acceleration: 4}}
)";

// By the manuals: Er.036, Er.039 and Er.040 of the DM5 take the power at once (L1424); the others
// know no such fault. A NiMotion and an iD286 have no 1016h; 6071h of the latter counts percent.
TEST(Families, DifferInWhatTheirDrivesDoAlone) {
  const Stage stage(loadedRobot(kMixedRobot), 1);
  const auto& axes = stage.axes();
  EXPECT_TRUE(axes[0].loss_coasts && axes[0].limit_coasts && axes[0].watches_master);
  EXPECT_FALSE(axes[1].loss_coasts || axes[1].limit_coasts || axes[1].watches_master);
  EXPECT_FALSE(axes[2].watches_master);
  EXPECT_FALSE(axes[3].loss_coasts || axes[3].limit_coasts);
  EXPECT_TRUE(axes[3].watches_master);
  EXPECT_NEAR(axes[2].effort_per_count, 10.0 * axes[3].effort_per_count, 1e-9);
}

class PowerOfMixedRobot : public OracleTest {
 protected:
  PowerOfMixedRobot() : OracleTest(makePowerOracle, kMixedRobot) {}
  /// It turns at its limit, and has no power and a fault from the next look on.
  std::size_t letGo(std::size_t axis) {
    look();
    truths_[axis].velocity = 1.0;
    look();
    truths_[axis].power = false;
    truths_[axis].statusword = 0x0008;
    look();
    return findings_.size();
  }
};

TEST_F(PowerOfMixedRobot, MayGoWhereADriveMissesItsMasterAndLetsGoByItsManual) {
  conditions_.lossy = now() + std::chrono::seconds(1);
  EXPECT_EQ(letGo(0), 0U);
  EXPECT_EQ(letGo(3), 1U) << "which brakes then";
}

TEST_F(PowerOfMixedRobot, MayNotGoWhereNothingIsWrong) { EXPECT_EQ(letGo(0), 1U); }

TEST_F(PowerOfMixedRobot, MayGoAtALimitSwitchWhereThatIsAFault) {
  truths_[0].at_switch = truths_[3].at_switch = true;
  EXPECT_EQ(letGo(0), 0U);
  EXPECT_EQ(letGo(3), 1U);
}

}  // namespace
}  // namespace cia402::campaign
