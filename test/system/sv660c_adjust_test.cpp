// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What of an SV660C is set where the axis asks for it, and what is only told.
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kSv660cSpeedControlled[] = "[0x2002, 1, control_mode, uint16, rw, -, 0]",
               kSv660cFastRate[] = "[0x2001, 0x3E, command_rate, uint16, rw, -, 3]";

// H02.00 is taken while stopped and counts at once [L3334].
TEST(Sv660cAdjusting, SetsTheControlModeWhereThatIsAskedFor) {
  Scene scene(
      loadText(sv660cJoint(", adjust: [control_mode]", sv660cDelivered(kSv660cSpeedControlled))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(sv660cNumber(scene, 0x2002, 1), 0U) << "not by the boot";
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(sv660cNumber(scene, 0x2002, 1), 8U);
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.3, 1e-5);
}

// H01.61 counts once the power was off [L3149-3164].
TEST(Sv660cAdjusting, SetsTheCommandRateAndWaitsForThePower) {
  Scene scene(loadText(sv660cJoint(", adjust: [command_rate]", sv660cDelivered(kSv660cFastRate))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message,
              HasSubstr("command_rate (2001:3E) was set to 2, which counts once its power was off; "
                        "call save_parameters, for it is not kept otherwise, then switch it off "
                        "and on"));
  EXPECT_EQ(sv660cNumber(scene, 0x2001, 0x3E), 2U);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  const bus::Answer again = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(again.success) << "it was not off";
}

struct Sv660cGear {
  const char* name;
  const char* resolution;  // H00.31
  const char* counts;
  std::uint64_t numerator, denominator;  // of 6091h, by hand
};

class Sv660cFraction : public testing::TestWithParam<Sv660cGear> {};

// Reduced [L490]: 8388608 = 2^23, 100000 = 2^5 * 5^5; 8388608 / 262144 = 32; 1048576 = 2^20.
TEST_P(Sv660cFraction, IsComputedWrittenAndReadBack) {
  const Sv660cGear& gear = GetParam();
  std::string yaml = sv660cJoint(", adjust: [counts_rule], homing: {method: 35}",
                                 "initial_position: 0.4, with: {dictionary: [[0x2000, 0x20, "
                                 "encoder_resolution, uint32, rw, -, " +
                                     std::string(gear.resolution) + "]]}");
  yaml =
      sv660cWith(yaml, "counts_per_turn: 100000", "counts_per_turn: " + std::string(gear.counts));
  yaml = sv660cWith(yaml,
                    "write: [{object: gear_numerator, raw: 262144},\n"
                    "            {object: gear_denominator, raw: 3125}],\n",
                    "");
  Scene scene(loadText(yaml));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_EQ(sv660cNumber(scene, 0x6091, 1), 1U) << "not by the boot";
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(sv660cNumber(scene, 0x6091, 1), gear.numerator);
  EXPECT_EQ(sv660cNumber(scene, 0x6091, 2), gear.denominator);
  EXPECT_FALSE(scene.state("joint").homed) << "it counts otherwise";
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  const double from = scene.position("joint");
  ASSERT_EQ(scene.setpoint("joint", 0.5), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint") - from, 0.5, 1e-4) << "by the motor";
}

INSTANTIATE_TEST_SUITE_P(Of6091h, Sv660cFraction,
                         testing::Values(Sv660cGear{"Decimal", "8388608", "100000", 262144, 3125},
                                         Sv660cGear{"PowerOfTwo", "8388608", "262144", 32, 1},
                                         Sv660cGear{"OtherEncoder", "1048576", "36000", 32768,
                                                    1125}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Sv660cGears, ThatDifferAreRefusedWithWhatHelps) {
  Scene scene(loadText(sv660cJoint(
      {}, sv660cDelivered("[0x2000, 0x20, encoder_resolution, uint32, rw, -, 1048576]"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("set the drive by `adjust: [counts_rule]` of the axis"));
}

struct Sv660cTold {
  const char* name;
  const char* row;   // as the drive comes
  const char* told;  // empty: nothing
};

class Sv660cWarned : public testing::TestWithParam<Sv660cTold> {};

TEST_P(Sv660cWarned, IsToldAndStopsNothing) {
  Scene scene(loadText(sv660cJoint({}, sv660cDelivered(GetParam().row))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_THAT(scene.told(), HasSubstr(GetParam().told));
}

INSTANTIATE_TEST_SUITE_P(
    Of, Sv660cWarned,
    testing::Values(
        Sv660cTold{"SyncTolerance", "[0x200E, 0x0E, sync_tolerance, uint16, rw, -, 5, 0, 5]",
                   "sync_tolerance (200E:0E) is 5, which it must not be, the drive does not watch "
                   "SYNC (H0E.13)"},
        Sv660cTold{"PositionLimits", "[0x200A, 0x29, limits, uint16, ro, -, 0]",
                   "software_limit_enable (200A:29) is 0, not above 0, the drive's own position "
                   "limits are off (H0A.40)"},
        Sv660cTold{"CommandInhibit", "[0x2003, 7, di3_function, uint16, rw, -, 13]",
                   "di3_function (2003:07) is 13, which it must not be, its terminal DI3 inhibits"},
        Sv660cTold{"ServoEnable", "[0x2003, 0x0B, di5_function, uint16, rw, -, 1]",
                   "di5_function (2003:0B) is 1, which it must not be, its terminal DI5 is the"},
        Sv660cTold{"RatedTorque", "[0x2000, 0x0D, rated_torque, uint16, rw, -, 127]",
                   "the motor's rated torque is 1.27 N m by the drive (motor_rated_torque "
                   "(2000:0D) = 127), but rated_torque of axes/joint is 2.39"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Sv660cWarnings, OfWhatIsRightDoNotCome) {
  Scene scene(
      loadText(sv660cJoint({}, sv660cDelivered("[0x2003, 7, di3_function, uint16, rw, -, 0], "
                                               "[0x2003, 0x0B, di5_function, uint16, rw, -, 0]"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_THAT(scene.told(), AllOf(Not(HasSubstr("sync_tolerance")), Not(HasSubstr("rated torque")),
                                  Not(HasSubstr("terminal")), Not(HasSubstr("H0A.40"))));
}

// Identity [L13463-13513]; another product is told, and nothing is refused.
TEST(Sv660cIdentity, OfAnotherProductIsNoted) {
  Scene scene(loadText(sv660cJoint({}, "product: 0x000D010C")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_THAT(scene.told(), HasSubstr("its product code (1018:02) 0x000D010C is none that the "
                                      "profile knows"));
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  Scene printed(loadText(sv660cJoint()));
  ASSERT_TRUE(printed.boot()) << printed.told();
  EXPECT_THAT(printed.told(), Not(HasSubstr("product code")));
}

TEST(Sv660cSilence, IsToldWithWhatTheFactoryLeavesOut) {
  Scene scene(loadText(sv660cJoint()));
  scene.inject("joint", "silent");
  scene.robot().start();
  scene.run(15s);
  EXPECT_THAT(scene.told(),
              AllOf(HasSubstr("joint (node 1): does not answer"), HasSubstr("set H0E.10 to 2"),
                    HasSubstr("H0C.00 (node-ID) and H0C.08 (bit rate)")));
}

}  // namespace
}  // namespace cia402
