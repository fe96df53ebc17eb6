// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives with several habits of the field at a time.
#include <random>
#include <sstream>

#include "system/field_habits.h"

namespace cia402::field {
namespace {

using testing::HasSubstr;

/// Two of them cannot be habits of one drive.
bool compatible(const Habit& a, const Habit& b) {
  const auto about = [](const Habit& habit) {
    std::vector<std::string> keys;
    for (const std::string& line : linesOf(habit.behaviour)) {
      keys.push_back(line.substr(0, line.find(':')));
    }
    return keys;
  };
  const std::vector<std::string> keys_of_a = about(a), keys_of_b = about(b);
  const bool share = std::any_of(keys_of_a.begin(), keys_of_a.end(), [&](const std::string& key) {
    return std::find(keys_of_b.begin(), keys_of_b.end(), key) != keys_of_b.end();
  });
  const bool both_detour = std::string(a.mode_change).rfind("detours", 0) == 0 &&
                           std::string(b.mode_change).rfind("detours", 0) == 0;
  const bool both_shown = std::string(a.mode_change).rfind("shown", 0) == 0 &&
                          std::string(b.mode_change).rfind("shown", 0) == 0;
  const std::string pair = std::string(a.behaviour) + " " + b.behaviour;
  // What forgets its mode while disabled cannot need one to be enabled, nor be disabled to change
  // it.
  const bool impossible = pair.find("mode_command") != std::string::npos &&
                          (pair.find("mode_needed") != std::string::npos ||
                           std::string(a.mode_change).find("disabled") != std::string::npos ||
                           std::string(b.mode_change).find("disabled") != std::string::npos);
  // Nor does what takes seconds for its mode enable in time where it needs one, unless it shows it.
  // And mode 0 is commanded for a moment on the way to another, too short to be seen by that one.
  const bool slow = pair.find("mode_change_time") != std::string::npos &&
                    (pair.find("mode_needed") != std::string::npos ||
                     pair.find("mode_command: change") != std::string::npos);
  return !share && !both_detour && !both_shown && !impossible && !slow;
}

class FieldDrives : public testing::TestWithParam<unsigned> {};

TEST_P(FieldDrives, LiveWithFiveHabitsAtOnce) {
  std::mt19937 random(GetParam());
  std::vector<const Habit*> habits;
  std::string names;
  while (habits.size() < 5) {
    const Habit& habit = kHabits[random() % std::size(kHabits)];
    const bool fits = std::all_of(habits.begin(), habits.end(),
                                  [&](const Habit* other) { return compatible(habit, *other); });
    if (!fits) continue;
    habits.push_back(&habit);
    names += std::string(" ") + habit.name;
  }
  EXPECT_EQ(Life(robotOf(habits)).live(), "") << names;
}

/// It forgets its mode while disabled, and faults at a change to which it is to be led.
std::string forgetfulRobot() {
  std::vector<const Habit*> habits;
  for (const Habit& habit : kHabits) {
    const std::string name = habit.name;
    if (name == "ForgetsTheModeWhileDisabled" || name == "FaultsAtAChangeOfMode") {
      habits.push_back(&habit);
    }
  }
  return robotOf(habits);
}

TEST(ForgetfulDrive, IsLedToItsModeThroughTheOneThatItStands) {
  EXPECT_EQ(Life(forgetfulRobot()).live(), "");
}

TEST(ForgetfulDrive, KeepsItsModeWhereTheWayToItIsCutOff) {
  Scene scene(loadText(forgetfulRobot()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "pv").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csp").success);
  const auto enabled = scene.begin(ProcedureKind::enable, "left");
  const auto mode = [&] { return std::string(scene.axis("left").modeName()); };
  ASSERT_TRUE(scene.runUntil([&] { return mode() == "profile_position"; }, 2s));
  scene.inject("left", "overcurrent");
  ASSERT_TRUE(scene.runUntil([&] { return enabled->has_value(); }, 5s));
  EXPECT_FALSE((*enabled)->success);
  scene.inject("left", "clear");
  const bus::Answer recovered = scene.procedure(ProcedureKind::recover, "left");
  ASSERT_TRUE(recovered.success) << recovered.message;
  EXPECT_EQ(mode(), "cyclic_position");
}

INSTANTIATE_TEST_SUITE_P(Random, FieldDrives, testing::Range(1U, 51U));

}  // namespace
}  // namespace cia402::field
