// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Nothing moves when a drive is enabled or changes its mode, wherever it stands and whatever
// set-points it holds: those that it has saved, and those that somebody has left there since it was
// booted. What the joint does is read from the motor.
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

/// An object that would move the motor, and its row of the dictionary with a number that does.
struct Stale {
  fieldbus::ObjectId id;
  const char* row;
  std::int64_t number;
  bool position;  ///< it shall be where the motor stands, others 0
};

std::vector<Stale> staleOf(const std::string& family) {
  if (family == kNimotionStepper) {
    return {{{0x607A, 0}, "[0x607A, 0, target_position, int32, rw, r, 50000]", 50000, true},
            {{0x60C1, 1}, "[0x60C1, 1, interpolation_data, int32, rw, r, 50000]", 50000, true},
            {{0x60FF, 0}, "[0x60FF, 0, target_velocity, int32, rw, r, 8000]", 8000, false},
            {{0x6042, 0}, "[0x6042, 0, vl_target, int16, rw, r, 120, -3000, 3000]", 120, false},
            {{0x60B0, 0}, "[0x60B0, 0, position_offset, int32, rw, -, 4000]", 4000, false},
            {{0x60B1, 0}, "[0x60B1, 0, velocity_offset, int32, rw, -, 8000]", 8000, false}};
  }
  if (family == kId286Cnfa) {
    return {{{0x607A, 0}, "[0x607A, 0, target_position, int32, rw, r, 90000]", 90000, true},
            {{0x60FF, 0}, "[0x60FF, 0, target_speed, int32, rw, r, 30000]", 30000, false},
            {{0x6071, 0}, "[0x6071, 0, target_torque, int16, rw, r, 100, 0, 120]", 100, false}};
  }
  if (family == kSv660c) {
    return {
        {{0x607A, 0}, "[0x607A, 0, target_position, int32, rw, r, 900000]", 900000, true},
        {{0x60C1, 1}, "[0x60C1, 1, interpolation_data_1, int32, rw, r, 900000]", 900000, true},
        {{0x60FF, 0}, "[0x60FF, 0, target_velocity, int32, rw, r, 300000]", 300000, false},
        {{0x6071, 0}, "[0x6071, 0, target_torque, int16, rw, r, 400, -4000, 4000]", 400, false}};
  }
  return {{{0x607A, 0}, "[0x607A, 0, target_position, int32, rw, r, 90000000]", 90000000, true},
          {{0x60FF, 0}, "[0x60FF, 0, target_velocity, int32, rw, r, 20000000]", 20000000, false},
          {{0x6071, 0}, "[0x6071, 0, target_torque, int16, rw, r, 900]", 900, false}};
}

std::string savedAt(const FamilyMode& tested, double place) {
  std::string rows;
  for (const Stale& stale : staleOf(tested.family)) {
    rows += (rows.empty() ? "" : ", ") + std::string(stale.row);
  }
  return ", simulation: {initial_position: " + std::to_string(place) + ", with: {dictionary: [" +
         rows + "]}}";
}

class FamilyEnabling : public testing::TestWithParam<FamilyMode> {
 protected:
  /// In the moment in which the power stage goes on.
  static void expectNeutral(Scene& scene) {
    const sim::ObjectDictionary& dictionary = scene.drive("joint").dictionary();
    const std::int64_t actual = sim::asSigned(*dictionary.find({0x6064, 0}));
    for (const Stale& stale : staleOf(GetParam().family)) {
      const std::int64_t holds = sim::asSigned(*dictionary.find(stale.id));
      EXPECT_NEAR(static_cast<double>(holds), stale.position ? static_cast<double>(actual) : 0.0,
                  stale.position ? 1.0 : 0.0)
          << stale.row;
    }
  }
};

TEST_P(FamilyEnabling, MovesNothingWhereverItStandsAndWhateverTheDriveHolds) {
  for (const double place : {-1.9, 1.3}) {
    Scene scene(loadText(familyJoint(GetParam(), savedAt(GetParam(), place))));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    EXPECT_NEAR(scene.position("joint"), place, 1e-6) << "nor does the boot";
    for (const Stale& stale : staleOf(GetParam().family)) {
      scene.drive("joint").dictionary().find(stale.id)->number =
          static_cast<std::uint64_t>(stale.number);
    }
    bool on = false;
    scene.watch([&] {
      if (!on && scene.truth("joint").power_stage_on) expectNeutral(scene);
      on = on || scene.truth("joint").power_stage_on;
    });
    scene.forget();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    scene.run(500ms);
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
    EXPECT_LT(scene.seen("joint").travel(), 1.1 * oneCount(GetParam()) + 1e-6) << scene.told();
    EXPECT_NEAR(scene.state("joint").position, place, 1.1 * oneCount(GetParam()));
    EXPECT_EQ(scene.state("joint").error_code, 0) << scene.told();
  }
}

INSTANTIATE_TEST_SUITE_P(All, FamilyEnabling, testing::ValuesIn(familyModes()), familyModeName);

class FamilyTimeOut : public testing::TestWithParam<FamilyMode> {};

// Transition 4 takes longer than timing/state_change of the profiles, 2 s: it is taken back.
TEST_P(FamilyTimeOut, OfEnablingIsToldAndLeavesItSwitchedOff) {
  Scene scene(
      loadText(familyJoint(GetParam(), ", simulation: {with: {quirks: {enabling_time: 4.0}}}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.forget();
  const Time asked = scene.now();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_LT(scene.now() - asked, 4s);
  EXPECT_THAT(enabled.message, AllOf(HasSubstr("joint (node 1)"), HasSubstr("statusword"),
                                     HasSubstr("switched on")));
  scene.run(5s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on) << "it comes too late";
  EXPECT_LT(scene.seen("joint").travel(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(All, FamilyTimeOut, testing::ValuesIn(families()), familyName);

/// A family with all its modes: what they are called, and their numbers.
struct Switching {
  FamilyMode tested;
  std::vector<std::pair<const char*, int>> modes;
};

void PrintTo(const Switching& tested, std::ostream* out) { *out << tested.tested.family; }

class FamilySwitches : public testing::TestWithParam<Switching> {
 protected:
  static std::string yaml(const std::string& more = {}) {
    std::string modes;
    for (const auto& [mode, number] : GetParam().modes) {
      modes += (modes.empty() ? "[" : ", ") + std::string(mode);
    }
    return familyJointWith(GetParam().tested, modes + "]", more);
  }
  /// Moves the joint in its mode, alternately up and down, and leaves it at rest, at a place that
  /// none of the targets of other modes knows.
  static void wander(FamilyScene& scene, int turn) {
    const ControlKind kind = scene.kind();
    const bool up = turn % 2 == 0 || (kind == ControlKind::torque &&
                                      GetParam().tested.family == std::string(kId286Cnfa));
    const double to = up ? 1.0 : -1.0;
    if (kind == ControlKind::position) {
      ASSERT_EQ(scene.setpoint("joint", scene.position("joint") + 0.1 * to), "");
    } else {
      scene.stream("joint", to * (kind == ControlKind::velocity ? 0.4 : 4.0), 200ms);
    }
    scene.run(800ms);
    // Efforts that end are braked by a mode that holds until `enable`.
    if (kind == ControlKind::torque) scene.mustSucceed(ProcedureKind::enable);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  }
};

TEST_P(FamilySwitches, GoFromEachModeToEachOtherAndMoveNothing) {
  FamilyScene scene(yaml());
  int turn = 0;
  const auto go = [&](std::size_t to) {
    const auto& [mode, number] = GetParam().modes[to];
    wander(scene, turn++);
    scene.forget();
    scene.mustSucceed(ProcedureKind::set_mode, mode);
    scene.run(150ms);
    EXPECT_LT(scene.seen("joint").travel(), 2e-4) << mode << "\n" << scene.told();
    EXPECT_EQ(sim::asSigned(*scene.drive("joint").dictionary().find({0x6061, 0})), number) << mode;
    EXPECT_EQ(scene.state("joint").mode->name, drive::canonicalModeName(mode));
    EXPECT_TRUE(scene.truth("joint").power_stage_on) << mode;
  };
  const std::size_t count = GetParam().modes.size();
  for (std::size_t from = 0; from < count; ++from) {
    const std::string name = drive::canonicalModeName(GetParam().modes[from].first);
    if (scene.state("joint").mode->name != name) go(from);
    for (std::size_t to = from + 1; to < count; ++to) {
      go(to);
      go(from);
    }
  }
}

TEST_P(FamilySwitches, AreRefusedInMotionWhichGoesOn) {
  for (const auto& [mode, number] : GetParam().modes) {
    FamilyScene scene(yaml());
    if (scene.state("joint").mode->name != drive::canonicalModeName(mode)) {
      scene.mustSucceed(ProcedureKind::set_mode, mode);
    }
    const char* other = GetParam().modes[mode == GetParam().modes[0].first ? 1 : 0].first;
    scene.sendOff();
    const bus::Answer refused = scene.procedure(ProcedureKind::set_mode, "joint", other);
    EXPECT_FALSE(refused.success) << mode;
    EXPECT_THAT(refused.message, HasSubstr("refused in motion")) << mode;
    EXPECT_GT(scene.velocity("joint"), 0.3) << mode;
    EXPECT_EQ(scene.state("joint").mode->name, drive::canonicalModeName(mode));
  }
}

// 6061h shows another mode for longer than timing/mode_change of the profiles, 1 s.
TEST_P(FamilySwitches, ThatTheDriveDoesNotShowInTimeAreToldAndMoveNothing) {
  Scene scene(loadText(yaml(", simulation: {with: {quirks: {mode_change_time: 3.0}}}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.forget();
  const bus::Answer late =
      scene.procedure(ProcedureKind::set_mode, "joint", GetParam().modes[1].first);
  EXPECT_FALSE(late.success);
  EXPECT_THAT(late.message, AllOf(HasSubstr("joint (node 1): mode"), HasSubstr("was not taken"),
                                  HasSubstr("6061:00 mode display shows -1")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_EQ(enabled.success, scene.truth("joint").power_stage_on) << enabled.message;
  scene.run(4s);
  EXPECT_LT(scene.seen("joint").travel(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    All, FamilySwitches,
    testing::Values(
        Switching{{kNimotionStepper, "4000", "csp"},
                  {{"pp", 1}, {"vl", 2}, {"pv", 3}, {"ip", 7}, {"csp", 8}, {"csv", 9}}},
        Switching{{kId286Cnfa, "10000", "pp"}, {{"pp", 1}, {"pv", 3}, {"csv", 3}, {"pt", 4}}},
        Switching{{kMegmeetDm5, "8388608", "csp"},
                  {{"pp", 1}, {"pv", 3}, {"pt", 4}, {"csp", 8}, {"csv", 9}, {"cst", 10}}},
        Switching{{kSv660c, "100000", "ip"},
                  {{"pp", 1}, {"pv", 3}, {"csv", 3}, {"pt", 4}, {"ip", 7}}}),
    [](const auto& tested) { return std::string(tested.param.tested.family); });

}  // namespace
}  // namespace cia402
