// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The demo robot: each joint has a drive of another family, all on one bus. What the joints do is
// read from their motors.
#include <cmath>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

class DemoRobot : public testing::Test {
 protected:
  DemoRobot() : scene(loadFile("demo.yaml")) {
    for (const drive::AxisConfig& axis : scene.loaded().robot.axes) names.push_back(axis.name);
  }
  void homeAndEnable() {
    ASSERT_TRUE(scene.boot()) << scene.told();
    const bus::Answer homed = scene.procedure(ProcedureKind::home);
    ASSERT_TRUE(homed.success) << homed.message << "\n" << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
  }
  void expectAllAt(double place, double tolerance) {
    for (const std::string& name : names) {
      EXPECT_NEAR(scene.position(name), place, tolerance) << name << "\n" << scene.told();
    }
  }
  Scene scene;
  std::vector<std::string> names;
};

TEST_F(DemoRobot, BootsWithoutPowerAndFindsTheTrueZeroOfEachJoint) {
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (const std::string& name : names) {
    EXPECT_FALSE(scene.truth(name).power_stage_on) << name;
    EXPECT_LT(scene.seen(name).travel(), 1e-9) << name;
  }
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.success) << homed.message << "\n" << scene.told();
  EXPECT_THAT(homed.message, HasSubstr("home done on 5 of 5 axes"));
  scene.run(100ms);
  for (const std::string& name : names) {
    EXPECT_TRUE(scene.state(name).homed) << name;
    EXPECT_NEAR(scene.state(name).position, scene.position(name), 5e-3) << name;
  }
}

TEST_F(DemoRobot, FollowsOneTrajectoryWithAllItsJointsAtATime) {
  ASSERT_NO_FATAL_FAILURE(homeAndEnable());
  ASSERT_TRUE(scene.move({0.3, 0.3, 0.3, 0.3, 0.3}, 3500ms).success) << scene.told();
  const Time begun = scene.now();
  std::vector<double> from, worst(names.size(), 0.0);
  for (const std::string& name : names) from.push_back(scene.position(name));
  scene.watch([&] {
    const double share = std::min(1.0, toSeconds(scene.now() - begun) / 3.5);
    const double done = share * share * (3.0 - 2.0 * share);  // at rest at both ends
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double there = from[i] + (0.3 - from[i]) * done;
      worst[i] = std::max(worst[i], std::fabs(scene.position(i) - there));
    }
  });
  scene.run(4500ms);
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_LT(worst[i], 0.05) << names[i];
  }
  expectAllAt(0.3, 5e-3);
  EXPECT_THAT(scene.told(), HasSubstr("goal reached"));
  EXPECT_EQ(scene.badFloats(), 0u);
  const bus::Answer disabled = scene.procedure(ProcedureKind::disable);
  EXPECT_TRUE(disabled.success) << disabled.message;
  for (const std::string& name : names) EXPECT_FALSE(scene.truth(name).power_stage_on) << name;
}

/// A joint with a fault of its drive, by the name in the simulation, and the words for it.
struct JointFault {
  const char *joint, *fault, *code, *words;
};

class DemoRobotWithAFault : public DemoRobot, public testing::WithParamInterface<JointFault> {};

TEST_P(DemoRobotWithAFault, SaysSoStopsTheOthersAndGoesOnOnceItIsCleared) {
  ASSERT_NO_FATAL_FAILURE(homeAndEnable());
  ASSERT_TRUE(scene.move({-1.0, 0.8, 0.8, 0.8, 0.8}, 4s).success) << scene.told();
  scene.run(2s);
  scene.inject(GetParam().joint, GetParam().fault);
  scene.run(300ms);
  EXPECT_THAT(
      scene.axis(GetParam().joint).faultText(),
      AllOf(HasSubstr(GetParam().joint), HasSubstr(GetParam().code), HasSubstr(GetParam().words)));
  scene.run(1700ms);
  for (const std::string& name : names) {
    EXPECT_EQ(scene.truth(name).power_stage_on, name != GetParam().joint) << name;
    EXPECT_NEAR(scene.velocity(name), 0.0, 1e-3) << name;
  }
  scene.inject(GetParam().joint, "clear");
  scene.run(1500ms);  // a cause persists for a while
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  ASSERT_TRUE(cleared.success) << cleared.message;
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message << "\n" << scene.told();
  scene.run(200ms);
  ASSERT_TRUE(scene.move({0.3, 0.3, 0.3, 0.3, 0.3}, 4s).success) << scene.told();
  scene.run(5s);
  expectAllAt(0.3, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Each, DemoRobotWithAFault,
    testing::Values(JointFault{"shoulder", "encoder", "0x7305", "check the encoder cable"},
                    JointFault{"elbow", "overvoltage", "0xFF02", "supply over-voltage (Er.002)"},
                    JointFault{"wrist", "over_voltage", "0x3110", "over voltage"},
                    JointFault{"tool", "over_voltage", "0x000E", "supply over-voltage"},
                    JointFault{"gripper", "overcurrent", "0x2310", "over"}),
    [](const auto& tested) { return std::string(tested.param.joint); });

}  // namespace
}  // namespace cia402
