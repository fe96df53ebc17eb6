// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A Damiao whose firmware has torques, currents and windows in 16 bits: the driver learns that, and
// the motor does what one with 32 bits does.
#include "system/families_bus_scene.h"
#include "system/field_profile.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

/// How the drive encodes them, and how the axis is told to.
struct HalfCoding {
  const char* name;
  const char* simulated;
  const char* key;
  unsigned plus, minus;  ///< 6071h of 1.5 and -1.5 N m, computed from 3FC00000h and BFC00000h
};
void PrintTo(const HalfCoding& coding, std::ostream* out) { *out << coding.name; }

std::string sixteenBits(const HalfCoding& coding, const std::string& more = {}) {
  std::string encodings;
  for (const char* object : {"6068", "606D", "606E", "606F", "6071", "6072", "6077", "6078"}) {
    encodings +=
        (encodings.empty() ? "\"" : ", \"") + std::string(object) + ":00\": " + coding.simulated;
  }
  std::string yaml = damiaoJoint(coding.key + more);
  const std::string from = "simulation: {";
  return yaml.replace(
      yaml.find(from), from.size(),
      "simulation: {drive: damiao_dm_half, with: {encodings: {" + encodings + "}}, ");
}

std::string inMode(std::string yaml, const std::string& mode) {
  return yaml.replace(yaml.find("mode: cyclic_position"), 21, "mode: " + mode);
}

class HalfFloatsOfADamiao : public testing::TestWithParam<HalfCoding> {
 protected:
  /// Velocities that the motor has after a torque has acted on it.
  static std::vector<double> pushed(const std::string& yaml) {
    ReadyScene scene(inMode(yaml, "profile_torque"));
    std::vector<double> reached;
    for (const double torque : {0.15, -0.15}) {
      EXPECT_EQ(scene.setpoint("joint", torque), "");
      scene.run(24ms);
      reached.push_back(scene.velocity("joint"));
      scene.stream("joint", 0.0, 600ms);
    }
    return reached;
  }
};

TEST_P(HalfFloatsOfADamiao, TurnTheMotorAsThoseOf32BitsDo) {
  const std::vector<double> whole = pushed(damiaoJoint());
  const std::vector<double> half = pushed(sixteenBits(GetParam()));
  ASSERT_GT(whole[0], 0.3);
  ASSERT_LT(whole[1], -0.3);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_NEAR(half[i], whole[i], 0.02 * std::abs(whole[i]));
  }
}

TEST_P(HalfFloatsOfADamiao, HoldWhatIsCommandedAndTellItInNewtonMetres) {
  Scene scene(loadText(inMode(sixteenBits(GetParam()), "profile_torque")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.inject("joint", "blocked_rotor");
  for (const double torque : {1.5, -1.5}) {
    scene.stream("joint", torque, 400ms);
    EXPECT_EQ(numberIn(scene, 0x6071), torque > 0 ? GetParam().plus : GetParam().minus);
    EXPECT_NEAR(scene.state("joint").effort, torque, 0.009 * 1.5);
    const auto current = scene.call(bus::ReadObjectCommand{"joint", "current_actual"});
    EXPECT_NEAR(current.number, torque / 3.0 * 7.0, 0.02 * 3.5) << "7 A at the rated 3 N m";
  }
  EXPECT_EQ(scene.badFloats(), 0u);
}

TEST_P(HalfFloatsOfADamiao, AreMappedAndWrittenAsWideAsTheyAre) {
  TracedScene scene(inMode(sixteenBits(GetParam()), "velocity_torque"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  std::size_t mapped = 0;
  for (const std::string& line : scene.writes(4)) {
    EXPECT_EQ(line.find(" 20 00 71 60"), std::string::npos) << line;
    EXPECT_EQ(line.find(" 20 00 77 60"), std::string::npos) << line;
    if (line.find(" 10 00 77 60") != std::string::npos) ++mapped;
    const bool limit = line.substr(3, 5) == "72 60";  // 6072h
    if (limit) {
      EXPECT_EQ(line.substr(0, 2), "2B") << line;
    }
  }
  EXPECT_GT(mapped, 0U);
  ASSERT_EQ(scene.setpoint("joint", 0.5), "");
  scene.run(100ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.5, 0.01);
}

TEST_P(HalfFloatsOfADamiao, DoNotDriftOverReadingAndWriting) {
  Scene scene(loadText(sixteenBits(GetParam())));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.call(bus::WriteObjectCommand{"joint", "position_window_time", "0.3"}).success);
  const std::uint64_t first = numberIn(scene, 0x6068);
  EXPECT_NE(first, 0x3E4CU);
  for (int i = 0; i < 20; ++i) {
    const auto read = scene.call(bus::ReadObjectCommand{"joint", "position_window_time"});
    EXPECT_NEAR(read.number, 0.3, 0.004 * 0.3);
    const std::string number = read.text.substr(0, read.text.find(' '));
    ASSERT_TRUE(
        scene.call(bus::WriteObjectCommand{"joint", "position_window_time", number}).success);
    ASSERT_EQ(numberIn(scene, 0x6068), first);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, HalfFloatsOfADamiao,
    testing::Values(HalfCoding{"upper_half", "bfloat16", "", 0x3FC0, 0xBFC0},
                    HalfCoding{"by_65535_unsigned", "scaled_unsigned",
                               ", half_floats: float32_by_65535_unsigned", 0x3FC0, 0xBFC1},
                    HalfCoding{"by_65535_signed", "scaled_signed",
                               ", half_floats: float32_by_65535_signed", 0x3FC0, 0xBFC0}),
    [](const auto& tested) { return std::string(tested.param.name); });

std::string withRows(const std::string& rows, const std::string& encodings) {
  std::string yaml = damiaoJoint();
  const std::string from = "simulation: {";
  return yaml.replace(
      yaml.find(from), from.size(),
      "simulation: {with: {dictionary: [" + rows + "], encodings: {" + encodings + "}}, ");
}

TEST(HalfFloatsOfADrive, AreLearntObjectByObject) {
  Scene scene(loadText(
      inMode(withRows("[0x6077, 0, torque_actual_value, int16, ro, t, 0]", "\"6077:00\": bfloat16"),
             "profile_torque")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.inject("joint", "blocked_rotor");
  scene.stream("joint", -2.0, 300ms);
  EXPECT_EQ(numberIn(scene, 0x6071), 0xC0000000U);
  EXPECT_EQ(numberIn(scene, 0x6077), 0xC000U);
  EXPECT_EQ(scene.state("joint").effort, -2.0);
}

// 0x3F00 in 32 bits, as chapter 3 prints 606Dh, is 2.3e-41.
TEST(HalfFloatsOfADrive, InABoxOf32BitsAreWarnedOf) {
  Scene scene(loadText(withRows("[0x606D, 0, velocity_window, uint32, rw, t, 0x3F00]", "")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("606D:00 velocity_window holds 0x00003F00"),
                                  HasSubstr("looks like the 16 bits of a float")));
}

TEST(HalfFloatsOfADrive, ThatTheProfileDoesNotKnowAreRefusedInTheFile) {
  EXPECT_THAT(problemsOfRobot(genericPair(", half_floats: bfloat16")),
              HasSubstr("axes/left/half_floats: profile generic_cia402 has no floats"));
  EXPECT_THAT(problemsOfRobot(damiaoJoint(", half_floats: float32")),
              HasSubstr("axes/joint/half_floats"));
}

}  // namespace
}  // namespace cia402
