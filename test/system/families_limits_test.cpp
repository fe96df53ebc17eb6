// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Limits of position, velocity, acceleration and effort of each family: the numbers that the drive
// gets, worked out by hand, and what the motor does where it runs into them.
#include "system/families_motion.h"
#include "system/motion_watch.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr double kLimitVelocity = 0.8, kLimitAcceleration = 4.0;  // of familyJoint()

class FamilyLimits : public testing::TestWithParam<FamilyMode> {};

/// The widest motion that the mode can be asked for: there and back.
void exertFamily(FamilyScene& scene) {
  if (scene.kind() == ControlKind::position) {
    for (const double goal : {-0.8, 0.7}) {
      ASSERT_EQ(scene.setpoint("joint", goal), "");
      scene.run(4s);
      EXPECT_NEAR(scene.position("joint"), goal, 1e-3);
    }
    return;
  }
  const double value = scene.kind() == ControlKind::velocity ? 0.8 : 20.0;
  scene.stream("joint", value, 700ms);
  if (scene.kind() == ControlKind::velocity) scene.stream("joint", -value, 1s);
  scene.run(1s);
}

TEST_P(FamilyLimits, OfVelocityAndAccelerationAreKeptByTheMotor) {
  FamilyScene scene(familyJoint(GetParam()));
  Motion motion(scene, "joint");
  exertFamily(scene);
  const bool torque = isTorqueMode(GetParam());
  EXPECT_GT(motion.fastest, 0.9 * kLimitVelocity) << "the test asked for too little";
  // Efforts are bounded by the drive alone: 6080h is the limit and a twentieth more, 607Fh of the
  // SV660C a tenth.
  const double room = !torque ? 1.0 : GetParam().family == std::string(kSv660c) ? 1.1 : 1.05;
  EXPECT_LT(motion.fastest, kLimitVelocity * room * 1.02);
  // Set-points of a stream are whole counts, a cycle of 4 ms apart; it is looked at for 8 ms.
  const double step = oneCount(GetParam()) / (0.004 * 0.008);
  if (!torque) {
    EXPECT_LT(motion.hardest, kLimitAcceleration * 1.1 + step);
  }
  EXPECT_EQ(scene.state("joint").error_code, 0) << scene.told();
}

INSTANTIATE_TEST_SUITE_P(All, FamilyLimits, testing::ValuesIn(familyModes()), familyModeName);

/// What an object holds once the axis is enabled: limits/... in its own numbers.
struct HeldNumber {
  fieldbus::ObjectId id;
  double number;
};
struct FamilyNumbers {
  FamilyMode tested;
  std::vector<HeldNumber> held;
};
void PrintTo(const FamilyNumbers& numbers, std::ostream* out) { *out << numbers.tested.family; }

// 1 rad of the joint are 50 / 2 pi = 7.957747 turns of the motor: 2.5 rad are 19.894368 turns,
// 0.8 rad/s are 6.366198 turns/s or 381.9719 rpm, 4 rad/s^2 are 31.830989 turns/s^2.
class FamilyLimitNumbers : public testing::TestWithParam<FamilyNumbers> {};

TEST_P(FamilyLimitNumbers, StandInTheDrive) {
  const bool dm5 = GetParam().tested.family == std::string(kMegmeetDm5);
  FamilyScene scene(familyJoint(
      GetParam().tested,
      ", homing: {" + std::string(dm5 ? "method: 35, " : "method: 17, ") + "required: false}"));
  scene.run(500ms);
  for (const HeldNumber& held : GetParam().held) {
    const auto* entry = scene.drive("joint").dictionary().find(held.id);
    EXPECT_NEAR(static_cast<double>(sim::asSigned(*entry)), held.number,
                held.number < 10.0 && held.number >= 0.0 ? 0.0 : 1.0)
        << fieldbus::toString(held.id);
  }
}

INSTANTIATE_TEST_SUITE_P(All, FamilyLimitNumbers,
                         testing::Values(FamilyNumbers{{kNimotionStepper, "4000", "pp"},
                                                       {{{0x605A, 0}, 2.0},
                                                        {{0x605B, 0}, 1.0},
                                                        {{0x605C, 0}, 1.0},
                                                        {{0x605D, 0}, 1.0},
                                                        {{0x605E, 0}, 0.0},
                                                        {{0x607B, 1}, -79577.5},
                                                        {{0x607B, 2}, 79577.5},
                                                        {{0x607D, 1}, -79577.5},
                                                        {{0x607D, 2}, 79577.5},
                                                        {{0x607F, 0}, 25464.8},
                                                        {{0x6080, 0}, 401.07},
                                                        {{0x6081, 0}, 25464.8},
                                                        {{0x6082, 0}, 0.0},
                                                        {{0x6083, 0}, 127323.95},
                                                        {{0x6084, 0}, 127323.95},
                                                        {{0x6085, 0}, 254647.9},
                                                        {{0x60C5, 0}, 127323.95},
                                                        {{0x60C6, 0}, 254647.9}}},
                                         FamilyNumbers{{kNimotionStepper, "4000", "vl"},
                                                       {{{0x6046, 1}, 0.0},
                                                        {{0x6046, 2}, 401.07},
                                                        {{0x6048, 1}, 1909.86},
                                                        {{0x6048, 2}, 1.0},
                                                        {{0x6049, 1}, 1909.86},
                                                        {{0x6049, 2}, 1.0},
                                                        {{0x604A, 1}, 3819.72},
                                                        {{0x604A, 2}, 1.0},
                                                        {{0x604C, 1}, 1.0},
                                                        {{0x604C, 2}, 1.0}}},
                                         FamilyNumbers{{kId286Cnfa, "10000", "pp"},
                                                       {{{0x607D, 1}, -198943.7},
                                                        {{0x607D, 2}, 198943.7},
                                                        {{0x6080, 0}, 401.07},
                                                        {{0x6081, 0}, 63661.98},
                                                        {{0x6083, 0}, 318309.9},
                                                        {{0x6084, 0}, 318309.9},
                                                        {{0x6085, 0}, 636619.8}}},
                                         FamilyNumbers{{kMegmeetDm5, "8388608", "pp"},
                                                       {{{0x607D, 1}, -166886054.0},
                                                        {{0x607D, 2}, 166886054.0},
                                                        {{0x607F, 0}, 53403537.0},
                                                        {{0x6080, 0}, 401.07},
                                                        {{0x6081, 0}, 53403537.0},
                                                        {{0x6083, 0}, 267017686.0},
                                                        {{0x6084, 0}, 267017686.0},
                                                        {{0x6085, 0}, 534035372.0},
                                                        // 60 N m of 50 * 1.27
                                                        {{0x6072, 0}, 944.88},
                                                        {{0x60E0, 0}, 944.88},
                                                        {{0x60E1, 0}, 944.88}}},
                                         FamilyNumbers{{kSv660c, "100000", "pp"},
                                                       {{{0x605A, 0}, 2.0},
                                                        {{0x605C, 0}, 1.0},
                                                        {{0x605D, 0}, 1.0},
                                                        {{0x605E, 0}, 2.0},
                                                        {{0x607D, 1}, -1989436.8},
                                                        {{0x607D, 2}, 1989436.8},
                                                        // 1.1 of the limit
                                                        {{0x607F, 0}, 700281.7},
                                                        {{0x6081, 0}, 636619.8},
                                                        {{0x6083, 0}, 3183098.9},
                                                        {{0x6084, 0}, 3183098.9},
                                                        {{0x6085, 0}, 6366197.7},
                                                        // 60 N m of 50 * 2.39
                                                        {{0x6072, 0}, 502.09},
                                                        {{0x200A, 0x29}, 2.0}}}),
                         [](const auto& tested) {
                           return std::string(tested.param.tested.family) + "_" +
                                  tested.param.tested.mode;
                         });

class FamilyPositionLimits : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilyPositionLimits, OfTheJointAreNotPassed) {
  FamilyScene scene(familyJoint(GetParam(), ", simulation: {initial_position: 1.4}"));
  scene.forget();
  if (scene.kind() == ControlKind::position) {
    const std::string refusal = scene.setpoint("joint", 2.7);
    scene.run(4s);
    EXPECT_NEAR(scene.position("joint"), refusal.empty() ? 2.5 : 1.4, 1e-3) << refusal;
  } else {
    const Time end = scene.now() + 3s;
    const double value = scene.kind() == ControlKind::velocity ? 0.8 : 5.0;
    while (scene.now() < end) {
      (void)scene.setpoint("joint", value);
      scene.run(20ms);
    }
    scene.run(1s);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    EXPECT_GT(scene.seen("joint").highest, 2.4) << "it went that far";
  }
  // An effort is taken back near the limit; what it has set in motion is braked by the ramp of 4
  // rad/s^2 then: 0.84 rad/s end within 0.088 rad.
  EXPECT_LT(scene.seen("joint").highest, 2.5 + (isTorqueMode(GetParam()) ? 0.1 : 0.01))
      << scene.told();
}

class FamilyLimitsInTheDrive : public testing::TestWithParam<FamilyMode> {};

/// 607Dh, and 607Bh where the drive has that: both sides, in counts.
void limitDrive(Scene& scene, double counts) {
  const auto upper = static_cast<std::uint32_t>(counts);
  for (const std::uint16_t index : {std::uint16_t{0x607B}, std::uint16_t{0x607D}}) {
    sim::Entry* entry = scene.drive("joint").dictionary().find({index, 2});
    if (entry == nullptr) continue;
    entry->number = upper;
    scene.drive("joint").dictionary().find({index, 1})->number = ~upper + 1U;
  }
}

/// With 607Dh minded at once, where a parameter of the maker says when it is.
std::string jointThatMindsItsLimits(const FamilyMode& tested) {
  const std::string family = tested.family;
  if (family == kMegmeetDm5) {
    return familyJoint(tested, ", write: [{object: software_limit_mode, raw: 1}]");
  }
  if (family == kSv660c) {  // H0A.40: 1 on, 2 once homed
    return replaced(familyJoint(tested), "raw: 3125}",
                    "raw: 3125}, {object: software_limit_enable, raw: 1}");
  }
  return familyJoint(tested);
}

// 607Dh at 1 rad, narrower than the joint's: the drive stops there, which is told.
TEST_P(FamilyLimitsInTheDrive, EndTheMotionInWordsAndAreLeftTheOtherWay) {
  FamilyScene scene(jointThatMindsItsLimits(GetParam()));
  const double limit = 1.0 / oneCount(GetParam());
  limitDrive(scene, limit);
  if (scene.kind() == ControlKind::position) {
    EXPECT_EQ(scene.setpoint("joint", 2.0), "");
    scene.run(4s);
  } else {
    const Time end = scene.now() + 3s;
    while (scene.now() < end) {
      (void)scene.setpoint("joint", 0.6);
      scene.run(20ms);
    }
  }
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  const bool vl = GetParam().mode == std::string("vl");  // which is braked by a ramp of its own
  EXPECT_NEAR(scene.position("joint"), 1.0, vl ? 0.03 : 0.01) << scene.told();
  EXPECT_TRUE(scene.state("joint").internal_limit || scene.state("joint").halted ||
              scene.told().find("internal limit active") != std::string::npos)
      << scene.told();
  scene.forget();
  limitDrive(scene, 2.0 * limit);
  scene.run(1s);
  EXPECT_LT(scene.seen("joint").travel(), 2e-3) << "it does not go on by itself";
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << scene.told();
  scene.mustSucceed(ProcedureKind::enable);
  if (scene.kind() == ControlKind::position) {
    EXPECT_EQ(scene.setpoint("joint", 0.5), "");
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.5, 1e-3) << "an absolute target leads off it";
  } else {
    scene.stream("joint", -0.4, 1s);
    EXPECT_LT(scene.position("joint"), 0.9);
  }
  EXPECT_FALSE(scene.state("joint").warning);
  EXPECT_EQ(scene.axis("joint").faultText(), "");
}

INSTANTIATE_TEST_SUITE_P(All, FamilyLimitsInTheDrive,
                         testing::ValuesIn(familyModesThat([](const FamilyMode& tested) {
                           return !isTorqueMode(tested);  // simulated drives limit no torque by it
                         })),
                         familyModeName);
INSTANTIATE_TEST_SUITE_P(All, FamilyPositionLimits, testing::ValuesIn(familyModes()),
                         familyModeName);

class FamilyEfforts : public testing::TestWithParam<FamilyMode> {};

// limits/effort of 60 N m are 944.9 / 1000 of 50 * 1.27 N m, 502.1 / 1000 of 50 * 2.39 N m.
TEST_P(FamilyEfforts, AgainstABlockedRotorAreTheLimitAndTold) {
  const double limit = GetParam().family == std::string(kSv660c) ? 502.0 : 945.0;
  FamilyScene scene(familyJoint(GetParam()));
  Motion motion(scene, "joint");
  scene.inject("joint", "blocked_rotor");
  const bool torque = scene.kind() == ControlKind::torque;
  for (int i = 0; i < 60; ++i) {
    (void)scene.setpoint("joint", torque ? 90.0 : 0.7);  // more than the limit is cut to it
    scene.run(20ms);
  }
  EXPECT_GT(motion.strongest, limit * 0.99) << scene.told();
  EXPECT_LE(motion.strongest, limit);
  EXPECT_NEAR(scene.state("joint").effort, 60.0, 0.1);
}

INSTANTIATE_TEST_SUITE_P(All, FamilyEfforts,
                         testing::ValuesIn(familyModesThat([](const FamilyMode& tested) {
                           const std::string family = tested.family, mode = tested.mode;
                           return (family == kMegmeetDm5 || family == kSv660c) &&
                                  (isTorqueMode(tested) || mode == "pv" || mode == "csv");
                         })),
                         familyModeName);

/// A limit that the boot writes, by its name with its object.
struct CutLimit {
  FamilyMode tested;
  const char* name;
  fieldbus::ObjectId id;
};
void PrintTo(const CutLimit& cut, std::ostream* out) {
  *out << cut.tested.family << " " << cut.name;
}

class FamilyCutLimit : public testing::TestWithParam<CutLimit> {};

TEST_P(FamilyCutLimit, IsToldWithBothNumbersAndRefusesNothing) {
  Scene scene(loadText(familyJoint(GetParam().tested)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  sim::Entry* entry = scene.drive("joint").dictionary().find(GetParam().id);
  const std::uint64_t written = entry->number;
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  EXPECT_THAT(scene.told(), testing::Not(HasSubstr("written at the boot")));
  EXPECT_TRUE(scene.procedure(ProcedureKind::disable).success);
  entry->number = written / 2;
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    EXPECT_TRUE(scene.procedure(ProcedureKind::disable).success);
  }
  const std::string told = scene.told(), words = "instead of the " + std::to_string(written) +
                                                 " that was written at the boot";
  EXPECT_THAT(told, HasSubstr(std::string(GetParam().name) + " is " + std::to_string(written / 2) +
                              " " + words));
  EXPECT_EQ(told.find(words), told.rfind(words)) << "once";
}

constexpr FamilyMode kCutDm5{kMegmeetDm5, "8388608", "pp"}, kCutSv660c{kSv660c, "100000", "pp"};

INSTANTIATE_TEST_SUITE_P(
    Of, FamilyCutLimit,
    testing::Values(CutLimit{kCutDm5, "max_profile_velocity (607F:00)", {0x607F, 0}},
                    CutLimit{kCutDm5, "max_motor_speed (6080:00)", {0x6080, 0}},
                    CutLimit{kCutDm5, "max_torque (6072:00)", {0x6072, 0}},
                    CutLimit{kCutDm5, "positive_torque_limit (60E0:00)", {0x60E0, 0}},
                    CutLimit{kCutDm5, "negative_torque_limit (60E1:00)", {0x60E1, 0}},
                    CutLimit{kCutDm5, "profile_velocity (6081:00)", {0x6081, 0}},
                    CutLimit{kCutDm5, "profile_acceleration (6083:00)", {0x6083, 0}},
                    CutLimit{kCutDm5, "profile_deceleration (6084:00)", {0x6084, 0}},
                    CutLimit{kCutDm5, "quick_stop_deceleration (6085:00)", {0x6085, 0}},
                    CutLimit{kCutSv660c, "max_profile_velocity (607F:00)", {0x607F, 0}},
                    CutLimit{kCutSv660c, "profile_velocity (6081:00)", {0x6081, 0}},
                    CutLimit{kCutSv660c, "quick_stop_deceleration (6085:00)", {0x6085, 0}},
                    CutLimit{kCutSv660c, "max_acceleration (60C5:00)", {0x60C5, 0}},
                    CutLimit{kCutSv660c, "max_deceleration (60C6:00)", {0x60C6, 0}},
                    CutLimit{kCutSv660c, "max_torque (6072:00)", {0x6072, 0}},
                    CutLimit{kCutSv660c, "following_error_window (6065:00)", {0x6065, 0}}),
    [](const auto& tested) {
      return std::string(tested.param.tested.family) + "_" +
             fieldbus::toString(tested.param.id).substr(0, 4);
    });

}  // namespace
}  // namespace cia402
