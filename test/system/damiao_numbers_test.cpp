// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Numbers of a Damiao in people's units, with direction and offset; what may be written of them,
// and when.
#include "system/damiao_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

class DamiaoNumbers : public testing::Test {
 protected:
  void begin(const std::string& yaml) {
    scene_.emplace(loadText(yaml));
    ASSERT_TRUE(scene_->boot()) << scene_->told();
  }
  Scene& scene() { return *scene_; }
  bus::ObjectAnswer read(const std::string& object) {
    return scene().call(bus::ReadObjectCommand{"joint", object});
  }
  bus::Answer write(const std::string& object, const std::string& value) {
    return scene().call(bus::WriteObjectCommand{"joint", object, value});
  }
  void enable() { ASSERT_TRUE(scene().procedure(ProcedureKind::enable).success) << scene().told(); }

 private:
  std::optional<Scene> scene_;
};

// Sub-index 0 of 2002h says 7, and 14 follow [L1054-1068].
TEST_F(DamiaoNumbers, OfItsPlateAreReadOneByOneAndInSiUnits) {
  begin(damiaoJoint());
  struct Plate {
    const char *object, *words;
    double number;
  };
  for (const Plate& plate :
       {Plate{"mcu_software_version", "0x5011", 0x5011}, Plate{"board_hardware_version", "3", 3},
        Plate{"board_max_voltage", "30 V", 30}, Plate{"board_max_current", "10 A", 10},
        Plate{"rated_voltage", "24 V", 24}, Plate{"rated_current", "7 A", 7},
        Plate{"rated_torque", "3 N m", 3}, Plate{"rated_speed", "= 12.566371 rad/s", 120},
        Plate{"2002:05", "0", 0}, Plate{"2002:06", "0", 0}, Plate{"2002:07", "0", 0},
        Plate{"2002:08", "0.85", 0.85}, Plate{"2002:09", "0.000345", 0.000345},
        Plate{"2002:0A u32", "45000", 45000}, Plate{"2002:0B", "9.3", 0.000093},
        Plate{"2002:0C", "1.8", 0.000018}, Plate{"pole_pairs", "14", 14},
        Plate{"built_in_gear", "10", 10}}) {
    const bus::ObjectAnswer answer = read(plate.object);
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_NEAR(answer.number, plate.number, 1e-6 * plate.number) << answer.message;
    EXPECT_THAT(answer.message, HasSubstr(plate.words)) << plate.object;
  }
}

// 7 A at 3 N m; the drive says so of a motor that is held.
TEST_F(DamiaoNumbers, OfTorqueCurrentAndTimesAreSi) {
  begin(damiaoIn("profile_torque"));
  enable();
  scene().inject("joint", "blocked_rotor");
  scene().stream("joint", 1.5, 300ms);
  EXPECT_NEAR(scene().state("joint").effort, 1.5, 1e-6);
  EXPECT_NEAR(read("current_actual").number, 3.5, 1e-5);
  EXPECT_THAT(read("current_actual").message, HasSubstr("3.5 A"));
  EXPECT_THAT(read("position_window_time").message, HasSubstr("0.2 s"));
  EXPECT_THAT(read("velocity_window_time").message, HasSubstr("0.1 s"));
  EXPECT_THAT(read("position_window").message, HasSubstr("0.1 rad"));
  EXPECT_THAT(read("200A:03").message, HasSubstr(" 100"));
  EXPECT_THAT(read("2009:02").message, HasSubstr(" 15"));
}

TEST_F(DamiaoNumbers, OfAnAxisThatIsTurnedRoundAndShiftedAreThoseOfTheJoint) {
  begin(damiaoIn("profile_velocity", ", direction: -1, position_offset: 0.25"));
  // The motor stands at -1.1 + 0.25 of its own: 1.1 of the joint.
  EXPECT_NEAR(scene().state("joint").position, scene().position("joint"), 1e-6);
  enable();
  scene().stream("joint", 0.7, 400ms);
  EXPECT_NEAR(scene().velocity("joint"), 0.7, 1e-3);
  EXPECT_NEAR(floatIn(scene(), 0x606C), -0.7, 1e-3) << "in the drive";
  EXPECT_NEAR(scene().state("joint").velocity, 0.7, 1e-2);
  EXPECT_NEAR(read("velocity_demand").number, -0.7, 1e-3) << "the drive's own number";
  EXPECT_THAT(read("velocity_demand").message, HasSubstr("= 0.69999999 rad/s"));
  EXPECT_NEAR(scene().state("joint").position, scene().position("joint"), 0.02);
  EXPECT_EQ(scene().badFloats(), 0U);
}

// 6062h and 606Bh are what it wants, 6064h and 606Ch what there is.
TEST_F(DamiaoNumbers, OfDemandAreThoseOfItsOwnRamp) {
  begin(damiaoIn("position_velocity"));
  enable();
  ASSERT_EQ(scene().setpoint("joint", -0.9), "");
  scene().run(700ms);
  const double speed = scene().velocity("joint");
  ASSERT_LT(speed, -1.0);
  EXPECT_NEAR(read("velocity_demand").number, -2.0, 1e-3) << "60FFh";
  const double at = scene().position("joint");
  EXPECT_NEAR(read("position_demand").number, at, 0.05);
  scene().run(2s);
  EXPECT_NEAR(read("position_demand").number, -0.9, 1e-5);
  EXPECT_NEAR(read("velocity_demand").number, 0.0, 1e-5);
  EXPECT_NEAR(scene().position("joint"), -0.9, 1e-3);
}

// What is published beside feedback: asked for by whoever looks.
TEST_F(DamiaoNumbers, OfDemandAndCurrentAreAmongItsSignals) {
  begin(damiaoIn("position_velocity"));
  enable();
  ASSERT_EQ(scene().setpoint("joint", -0.9), "");
  scene().run(3s);
  for (int i = 0; i < 4; ++i) {
    scene().axis("joint").look();
    scene().run(600ms);
  }
  const std::vector<drive::ShownSignal> shown = scene().axis("joint").signals(scene().now());
  for (const auto& [name, index] :
       {std::pair("current_actual", 0x6078), std::pair("position_demand", 0x6062),
        std::pair("velocity_demand", 0x606B)}) {
    const std::string wanted = name;
    const auto signal = std::find_if(shown.begin(), shown.end(), [&](const auto& one) {
      return one.object != nullptr && one.object->name == wanted;
    });
    ASSERT_NE(signal, shown.end()) << name;
    EXPECT_TRUE(signal->known) << name;
    EXPECT_EQ(signal->raw, numberIn(scene(), static_cast<std::uint16_t>(index))) << name;
  }
}

// Gains and thresholds [L54-56, L1086-1130].
TEST_F(DamiaoNumbers, OfItsLoopsAreWrittenWhileDisabledAndTheOldOneIsShown) {
  begin(damiaoJoint());
  struct Gain {
    const char *object, *old_value, *value;
    fieldbus::ObjectId id;
    std::uint32_t bits;
  };
  const Gain gains[] = {{"2004:01", "0.8", "1.5", {0x2004, 1}, 0x3FC00000},
                        {"2004:02", "0.001", "0.5", {0x2004, 2}, 0x3F000000},
                        {"2005:01", "0.4", "0.75", {0x2005, 1}, 0x3F400000},
                        {"2005:02", "0.002", "0.25", {0x2005, 2}, 0x3E800000},
                        {"2005:03", "4", "2", {0x2005, 3}, 0x40000000},
                        {"2006:01", "54", "32", {0x2006, 1}, 0x42000000},
                        {"2006:02", "0", "0.125", {0x2006, 2}, 0x3E000000},
                        {"2008:01", "0.8", "1", {0x2008, 1}, 0x3F800000}};
  enable();
  for (const Gain& gain : gains) {
    const std::uint64_t before = numberIn(scene(), gain.id.index, gain.id.subindex);
    const bus::Answer refused = write(gain.object, gain.value);
    EXPECT_FALSE(refused.success) << gain.object;
    EXPECT_THAT(refused.message, HasSubstr("0x08000022")) << gain.object;
    EXPECT_EQ(numberIn(scene(), gain.id.index, gain.id.subindex), before);
  }
  ASSERT_TRUE(scene().procedure(ProcedureKind::disable).success);
  for (const Gain& gain : gains) {
    const bus::Answer written = write(gain.object, gain.value);
    EXPECT_TRUE(written.success) << written.message;
    EXPECT_THAT(written.message, HasSubstr(std::string("(it was ") + gain.old_value));
    EXPECT_EQ(numberIn(scene(), gain.id.index, gain.id.subindex), gain.bits) << gain.object;
  }
  struct Threshold {
    const char *object, *old_value, *value;
    fieldbus::ObjectId id;
    std::uint32_t bits;
  };
  for (const Threshold& threshold : {Threshold{"2009:01", "32", "28", {0x2009, 1}, 0x41E00000},
                                     Threshold{"2009:02", "15", "18", {0x2009, 2}, 0x41900000},
                                     Threshold{"200A:03", "100", "85", {0x200A, 3}, 0x42AA0000},
                                     Threshold{"200A:04", "100", "90", {0x200A, 4}, 0x42B40000}}) {
    const bus::Answer written = write(threshold.object, threshold.value);
    EXPECT_TRUE(written.success) << written.message;
    EXPECT_THAT(written.message, HasSubstr(std::string("(it was ") + threshold.old_value + ")"));
    EXPECT_EQ(numberIn(scene(), threshold.id.index, threshold.id.subindex), threshold.bits)
        << threshold.object;
  }
}

// 45000 beside 0.0045, 100000 beside 1000: shown, and written for who knows better only.
TEST_F(DamiaoNumbers, ThatTheManualPrintsInTwoWaysAreShownAndNotWritten) {
  for (const bool trusted : {false, true}) {
    begin(damiaoJoint(trusted ? ", trusted: [\"2002:0A\", \"2004:03\"]" : ""));
    scene().run(500ms);
    EXPECT_EQ(read("2002:0A u32").number, 45000.0);
    EXPECT_EQ(read("2004:03").number, 1000.0);
    const bus::Answer flux = write("2002:0A u32", "46000"), width = write("2004:03", "1200");
    EXPECT_EQ(flux.success, trusted) << flux.message;
    EXPECT_EQ(width.success, trusted) << width.message;
    if (!trusted) {
      EXPECT_THAT(flux.message, AllOf(HasSubstr("2002:0A"), HasSubstr("0.0045 and as 45000"),
                                      HasSubstr("trusted: [\"2002:0A\"]")));
      EXPECT_THAT(width.message, HasSubstr("1000 and as 100000"));
    }
    EXPECT_EQ(numberIn(scene(), 0x2002, 10), trusted ? 46000U : 45000U);
    EXPECT_EQ(floatIn(scene(), 0x2004, 3), trusted ? 1200.0 : 1000.0);
  }
  EXPECT_THAT(problemsOfRobot(damiaoJoint(", write: [{object: \"2004:03\", value: 900.0}]")),
              HasSubstr("axes/joint/write: `2004:03`: it is not known"));
  EXPECT_THAT(problemsOfRobot(damiaoJoint(", trusted: [\"2004:01\"]")),
              HasSubstr("calls nothing doubtful that is `2004:01`"));
}

// Bits of 607Eh that nobody describes [L1272]: as they are, while disabled, and the zero is gone.
TEST_F(DamiaoNumbers, OfThePolarityAreRawAndCostTheZero) {
  begin(damiaoJoint());
  enable();
  const bus::Answer refused = write("polarity", "0x80");
  EXPECT_FALSE(refused.success);
  EXPECT_EQ(numberIn(scene(), 0x607E), 0U);
  ASSERT_TRUE(scene().procedure(ProcedureKind::disable).success);
  const bus::Answer written = write("polarity", "0x80");
  EXPECT_TRUE(written.success) << written.message;
  EXPECT_EQ(numberIn(scene(), 0x607E), 0x80U);
  EXPECT_FALSE(scene().state("joint").homed);
  EXPECT_THAT(written.message, HasSubstr("`direction`"));
}

// Its factory value is 0 [L1272]; another one, left by somebody, may turn what the joint is told.
TEST_F(DamiaoNumbers, OfAPolarityThatIsLeftInTheDriveAreWarnedOf) {
  for (const unsigned left : {0U, 0x80U}) {
    begin(damiaoJoint());
    scene().drive("joint").dictionary().find({0x607E, 0})->number = left;
    enable();
    EXPECT_EQ(scene().told().find("polarity (607E:00) is 128 instead of 0") != std::string::npos,
              left != 0)
        << scene().told();
    EXPECT_EQ(scene().told().find("give the axis a `direction`") != std::string::npos, left != 0);
  }
}

// 8.3 of the manual's table: directions that it prints in two ways.
TEST(DamiaoPdos, OfObjectsThatTheManualPrintsInTwoWaysAreWarnedOf) {
  for (const char* object : {"current_actual", "following_error_window", "velocity_window"}) {
    const LoadedRobot loaded =
        loadText(damiaoJoint(", pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, "
                             "position_actual], tpdo2: [" +
                             std::string(object) + "]}"));
    EXPECT_THAT(loaded.robot.warnings,
                testing::Contains(AllOf(HasSubstr("axes/joint: `" + std::string(object)),
                                        HasSubstr("in a TPDO: the manual prints it"))));
    Scene scene(loaded);
    ASSERT_TRUE(scene.boot()) << scene.told();
    enableJoint(scene);
    expectGoes(scene, -0.4);
  }
  EXPECT_THAT(loadText(damiaoJoint()).robot.warnings, testing::IsEmpty());
}

}  // namespace
}  // namespace cia402
