// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The homing methods of families by their manuals: where home is says the motor, not what the
// driver believes.
#include "system/families_homing.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

class FamilyHomingMethod : public testing::TestWithParam<FamilyHoming> {};

TEST_P(FamilyHomingMethod, MakesTheJointReadItsOffsetAtTheTrueHome) {
  const FamilyHoming& c = GetParam();
  Scene scene(loadText(homingJoint(c)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.forget();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_TRUE(scene.state("joint").homed);
  const double count = kTurnOfMotor / std::stod(c.tested.counts_per_turn);
  EXPECT_NEAR(scene.state("joint").position - kReadAtHome,
              scene.position("joint") - c.home.home * kTurnOfMotor, count + 2e-6);
  EXPECT_LT(scene.seen("joint").fastest, kSearchSpeed * 1.02);
}

constexpr FamilyMode kStepperPp{"nimotion_stepper", "4000", "pp"},
    kId286Pp{"id286_cnfa", "10000", "pp"}, kDm5Pp{"megmeet_dm5", "8388608", "pp"},
    kByTheBookPp{"generic_cia402", "131072", "pp"}, kSv660cPp{"sv660c", "100000", "pp"};
constexpr char kAsDelivered[] = "";
constexpr char kDm5Switches[] =  // P03.00 to P03.02: reverse limit, forward limit, home
    ", write: [{object: di1_function, raw: 36}, {object: di2_function, raw: 35}, "
    "{object: di3_function, raw: 32}, {object: di4_function, raw: 0}]";

std::string familyMethodName(const testing::TestParamInfo<FamilyHoming>& tested) {
  const FamilyHoming& c = tested.param;
  return std::string(c.tested.family) + "_Method" + std::to_string(c.home.method) + "Case" +
         std::to_string(tested.index);
}

INSTANTIATE_TEST_SUITE_P(Nimotion, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kStepperPp, kNimotionSwitches,
                                                      homesByEdges())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Id286Edges, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kId286Pp, kAsDelivered, homesByEdges())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Id286Index, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kId286Pp, kAsDelivered, homesByIndex())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Id286OffTheSwitch, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kId286Pp, kAsDelivered, homesOffTheSwitch())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Dm5Edges, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kDm5Pp, kDm5Switches, homesByEdges())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Dm5Index, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kDm5Pp, kDm5Switches, homesByIndex())),
                         familyMethodName);

// The figures of CiA 402-2 themselves.
INSTANTIATE_TEST_SUITE_P(GenericEdges, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kByTheBookPp, kAsDelivered, homesByEdges())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(GenericIndex, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kByTheBookPp, kAsDelivered, homesByIndex())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(GenericOffTheSwitch, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kByTheBookPp, kAsDelivered,
                                                      homesOffTheSwitch())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(GenericAtOnce, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kByTheBookPp, kAsDelivered,
                                                      {{37, 1.8, 1.8}, {37, -0.7, -0.7}})),
                         familyMethodName);

INSTANTIATE_TEST_SUITE_P(Dm5OnTheSwitch, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kDm5Pp, kDm5Switches, homesOnTheSwitch())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Dm5Turning, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kDm5Pp, kDm5Switches, homesByTurning())),
                         familyMethodName);

// Each start that the manual lists [L1440-1743]: before the switch, on it, and with a limit switch
// met first. Its figures are not in the text; the edges are those of CiA 402-2 [L15784-15813].
INSTANTIATE_TEST_SUITE_P(Sv660cEdges, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kSv660cPp, kAsDelivered, homesByEdges())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Sv660cIndex, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kSv660cPp, kAsDelivered, homesByIndex())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Sv660cOffTheSwitch, FamilyHomingMethod,
                         testing::ValuesIn(withFamily(kSv660cPp, kAsDelivered,
                                                      homesOffTheSwitch())),
                         familyMethodName);

/// Methods that no manual lets turn at a limit switch, with the home switch behind the joint.
class FamilyHomingBehind : public testing::TestWithParam<FamilyHoming> {};

TEST_P(FamilyHomingBehind, EndsInWordsAtTheLimitSwitchAheadAndFindsNoHome) {
  const FamilyHoming& c = GetParam();
  Scene scene(loadText(homingJoint(c)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.forget();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(homed.success);
  EXPECT_THAT(homed.message, testing::AllOf(HasSubstr("joint (node 1)"), HasSubstr("homing")));
  scene.run(1s);
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-6);
  const double limit = c.home.home * kTurnOfMotor, ramp = 0.64 * kTurnOfMotor;
  if (c.home.home > c.home.start) {
    EXPECT_GE(scene.seen("joint").highest, limit) << "it was there";
    EXPECT_LT(scene.seen("joint").highest, limit + 1.1 * ramp);
    EXPECT_GT(scene.seen("joint").lowest, c.home.start * kTurnOfMotor - 1e-3) << "it does not turn";
  } else {
    EXPECT_LE(scene.seen("joint").lowest, limit) << "it was there";
    EXPECT_GT(scene.seen("joint").lowest, limit - 1.1 * ramp);
    EXPECT_LT(scene.seen("joint").highest, c.home.start * kTurnOfMotor + 1e-3) << "does not turn";
  }
}

/// Methods, starts and the limit switch ahead.
std::vector<FamilyHome> homesBehind() {
  return {{3, 3.6, 5.0},  {5, 0.0, -2.0},  {6, 0.0, -2.0}, {19, 3.6, 5.0},
          {20, 3.6, 5.0}, {21, 0.0, -2.0}, {22, 0.0, -2.0}};
}
INSTANTIATE_TEST_SUITE_P(Dm5, FamilyHomingBehind,
                         testing::ValuesIn(withFamily(kDm5Pp, kDm5Switches, homesBehind())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Id286, FamilyHomingBehind,
                         testing::ValuesIn(withFamily(kId286Pp, kAsDelivered, homesBehind())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Sv660c, FamilyHomingBehind,
                         testing::ValuesIn(withFamily(kSv660cPp, kAsDelivered, homesBehind())),
                         familyMethodName);
INSTANTIATE_TEST_SUITE_P(Generic, FamilyHomingBehind,
                         testing::ValuesIn(withFamily(kByTheBookPp, kAsDelivered, homesBehind())),
                         familyMethodName);

/// Switches as those of FamilyHome.
class NimotionPrinting : public testing::TestWithParam<PrintedHoming> {};

TEST_P(NimotionPrinting, SaysWhichWaysAndHowFastTheMotorTurns) {
  for (const auto& [start, printed] : GetParam().ways) {
    SCOPED_TRACE(start);
    expectHomingWays(homingJoint({kStepperPp, kNimotionSwitches, {GetParam().method, start, 0.0}}),
                     printed);
  }
}

// [L1208-1346]
const PrintedHoming kNimotionPrinted[] = {
    {17, {{0.0, "-F +S"}, {-2.4, "+S"}}},
    {18, {{3.6, "+F -S"}, {5.4, "-S"}}},
    {19, {{0.0, "+F -S"}, {1.8, "-S"}}},
    {20, {{0.0, "+S"}, {1.8, "-F +S"}}},
    {21, {{3.6, "-F +S"}, {1.8, "+S"}}},
    {22, {{3.6, "-S"}, {1.8, "+F -S"}}},
    {23, {{0.0, "+F -S"}, {1.8, "-S"}, {3.6, "+F -F -S"}}},
    {24, {{0.0, "+F -S +S"}, {1.8, "-S +S"}, {3.6, "+F -F -S +S"}}},
    {25, {{0.0, "+F +S -S"}, {1.8, "+S -S"}, {3.6, "+F -F +S -S"}}},
    {26, {{0.0, "+F +S"}, {1.8, "+S"}, {3.6, "+F -F +S"}}},
    {27, {{0.0, "-F +F +S"}, {1.8, "+S"}, {3.6, "-F +S"}}},
    {28, {{0.0, "-F +F +S -S"}, {1.8, "+S -S"}, {3.6, "-F +S -S"}}},
    {29, {{0.0, "-F +F -S +S"}, {1.8, "-S +S"}, {3.6, "-F -S +S"}}},
    {30, {{0.0, "-F +F -S"}, {1.8, "-S"}, {3.6, "-F -S"}}},
};
INSTANTIATE_TEST_SUITE_P(By, NimotionPrinting, testing::ValuesIn(kNimotionPrinted),
                         printedHomingName);

}  // namespace
}  // namespace cia402
