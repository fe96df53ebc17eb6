// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Joints of any gear, lead, direction and offset: the motor turns by as much as the SI amount that
// was commanded says, within a count of the drive.
#include <random>

#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using testing::HasSubstr;

constexpr double kTurn = 6.283185307179586;

/// A joint that is drawn.
struct DrawnJoint {
  bool prismatic = false;
  double gear = 1.0, lead = 1.0, offset = 0.0;
  int direction = 1;

  double perTurn() const { return (prismatic ? lead : kTurn) / gear; }  ///< of the motor
  /// Of this joint instead of that of familyJoint(): it may turn its motor by 12 turns each way, by
  /// 4 turns a second at most.
  std::string yaml(const FamilyMode& tested) const {
    const std::string start = ", simulation: {initial_position: " + std::to_string(offset) + "}";
    std::string text = replaced(
        familyJoint(tested, start), "gear_ratio: 50.0",
        "gear_ratio: " + std::to_string(gear) + ", direction: " + std::to_string(direction) +
            ", position_offset: " + std::to_string(offset) +
            (prismatic ? ", type: prismatic, lead: " + std::to_string(lead) : std::string()));
    const std::size_t limits = text.find("limits: {"), end = text.find('}', limits);
    const auto turns = [this](double number) { return std::to_string(number * perTurn()); };
    return text.replace(limits, end - limits,
                        "limits: {lower: " + std::to_string(offset - 12.0 * perTurn()) +
                            ", upper: " + std::to_string(offset + 12.0 * perTurn()) +
                            ", velocity: " + turns(4.0) + ", acceleration: " + turns(30.0));
  }
};

std::vector<DrawnJoint> drawnJoints() {
  std::mt19937 draw(402);
  const auto within = [&draw](double low, double high) {
    return low + (high - low) * static_cast<double>(draw() % 100000) / 1e5;
  };
  std::vector<DrawnJoint> joints;
  for (int i = 0; i < 8; ++i) {
    DrawnJoint joint;
    joint.prismatic = i % 2 == 1;
    joint.gear =
        std::round(100.0 * (joint.prismatic ? within(1.0, 5.0) : within(1.0, 160.0))) / 100.0;
    joint.lead = std::round(1e5 * within(0.002, 0.05)) / 1e5;
    joint.offset = std::round(1e3 * within(-1.0, 1.0)) / 1e3;
    joint.direction = i % 4 < 2 ? -1 : 1;
    joints.push_back(joint);
  }
  return joints;
}

class FamilyUnits : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilyUnits, TurnTheMotorByWhatIsCommanded) {
  const double counts = std::stod(GetParam().counts_per_turn);
  const bool rpm = GetParam().mode == std::string("vl");
  for (const DrawnJoint& joint : drawnJoints()) {
    FamilyScene scene(joint.yaml(GetParam()));
    const auto motor = [&] { return scene.truth("joint").position_turns; };
    EXPECT_NEAR(scene.state("joint").position, joint.offset, joint.perTurn() / counts + 1e-6);
    for (const double turns : {3.137, -7.771, 0.219}) {
      if (scene.kind() == ControlKind::position) {
        const double goal = joint.offset + joint.direction * turns * joint.perTurn();
        ASSERT_EQ(scene.setpoint("joint", goal), "");
        scene.run(6s);
        EXPECT_NEAR(motor(), turns, 1.01 / counts + 1e-6) << joint.gear << scene.told();
        EXPECT_NEAR(scene.state("joint").position, goal, 1.5 * joint.perTurn() / counts + 1e-6);
      } else if (scene.kind() == ControlKind::velocity) {
        const double speed = turns / 4.0;
        scene.stream("joint", joint.direction * speed * joint.perTurn(), 400ms);
        EXPECT_NEAR(scene.truth("joint").velocity_turns, speed,
                    rpm ? 0.51 / 60.0 : 1.01 / counts + 1e-4);
      } else if (joint.direction > 0 || GetParam().family != std::string(kId286Cnfa)) {
        const double pushed = motor();
        scene.stream("joint",
                     joint.direction * 0.2 * 1.27 * joint.gear * kTurn /
                         (joint.prismatic ? joint.lead : kTurn),
                     100ms);
        EXPECT_GT(motor() - pushed, 0.0) << "a positive effort of the motor";
        scene.run(1s);
        scene.mustSucceed(drive::ProcedureKind::enable);
      }
    }
    EXPECT_EQ(scene.state("joint").error_code, 0) << scene.told();
  }
}

INSTANTIATE_TEST_SUITE_P(All, FamilyUnits, testing::ValuesIn(familyModes()), familyModeName);

class FamilyRange : public testing::TestWithParam<FamilyMode> {};

// 1e6 rad are 7957747 turns of the motor: 3.2e10, 8e10 and 6.7e13 counts.
TEST_P(FamilyRange, OfATravelThatTheDriveCannotCountIsRefusedBeforeAFrameIsSent) {
  Problems problems;
  config::loadRobot(YAML::Load(replaced(familyJoint(GetParam()), "lower: -2.5, upper: 2.5",
                                        "lower: -1.0e6, upper: 1.0e6")),
                    config::profilesIn({test::configFolder() + "/drives"}), problems);
  EXPECT_THAT(problems.text(), testing::AllOf(HasSubstr("axes/joint/limits"),
                                              HasSubstr("would wrap around inside these limits")));
}

INSTANTIATE_TEST_SUITE_P(All, FamilyRange, testing::ValuesIn(families()), familyName);

}  // namespace
}  // namespace cia402
