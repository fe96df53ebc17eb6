// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives as they are met in the field: the generic one with what traces and reports show of others,
// each alone. Each lives through boot, enabling, motion, another mode, homing, a fault and
// recovery; the motor is the judge.
#include "system/field_habits.h"

namespace cia402::field {
namespace {

using testing::HasSubstr;

class FieldDrive : public testing::TestWithParam<std::size_t> {};

TEST_P(FieldDrive, Lives) {
  const Habit& habit = kHabits[GetParam()];
  EXPECT_EQ(Life(robotOf({&habit})).live(), "") << habit.source;
}

std::string nameOfHabit(const testing::TestParamInfo<std::size_t>& tested) {
  return kHabits[tested.param].name;
}

INSTANTIATE_TEST_SUITE_P(Habits, FieldDrive, testing::Range<std::size_t>(0, std::size(kHabits)),
                         nameOfHabit);

// Else the simulated drive would not do what it is said to do, or the key would not be needed.
class FieldDriveOfItsProfile : public FieldDrive {};

TEST_P(FieldDriveOfItsProfile, CannotBeServedWithoutItsKeys) {
  const Habit& habit = kHabits[GetParam()];
  EXPECT_NE(Life(robotOf({&habit}, false)).live(), "") << habit.source;
}

std::vector<std::size_t> knownByProfile() {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < std::size(kHabits); ++i) {
    if (kHabits[i].known_by_profile) known.push_back(i);
  }
  return known;
}

INSTANTIATE_TEST_SUITE_P(Habits, FieldDriveOfItsProfile, testing::ValuesIn(knownByProfile()),
                         nameOfHabit);

// `lacks` of the axis says the same as the profile would; the options that nothing takes go.
TEST(FieldDriveThatHomesInOneWayOnly, IsServedByTheKeysOfItsAxis) {
  std::string robot = genericPair(
      ", lacks: [homing_method], homing: {method: 17, acceleration: 4.0, offset: -1.0}, "
      "simulation: {drive: generic_cia402, lower_limit_switch: -1.0, with: {quirks: "
      "{homing_is_fixed: true}, dictionary: [[0x6098, 0, homing_method, int8, rw, rt, 17]]}}");
  Scene scene(loadText(robot));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "left");
  ASSERT_TRUE(homed.success) << homed.message;
  EXPECT_NEAR(scene.state("left").position, scene.position("left"), 0.002);
}

// maxon EPOS4 (Roboprotos/maxon_epos4_ros1#1) takes a bad COB-ID and refuses the mapping for it.
// The driver writes none, but may find one: 0x6E0 is of no PDO (CiA 301, restricted COB-IDs).
TEST(MisleadingAbort, OfAMappingNamesTheCobIdThatTheDriveHolds) {
  Scene scene(
      loadText(genericPair(", simulation: {drive: generic_cia402, with: {communication: "
                           "{misleading_cob_id_abort: true}, "
                           "dictionary: [[0x1800, 1, cob_id, uint32, rw, \"-\", 0x800006E0]]}}")));
  EXPECT_FALSE(scene.boot());
  const std::string told = scene.told();
  EXPECT_THAT(told, HasSubstr("left (node 1): boot failed"));
  EXPECT_THAT(told, HasSubstr("1A00:01"));
  EXPECT_THAT(told, HasSubstr("0x06040041"));
  EXPECT_THAT(told, HasSubstr("1800:01 still holds the COB-ID 0x000006E0"));
}

// No drive is known that shows this; bit 3 says that it is a fault (CiA 402-2), the rest nothing.
constexpr Habit kFaultsWithBitsOfOperation{"", "", "quirks/fault_bits: 0x0001", "", ""};

TEST(FaultWithBitsOfOperation, IsAFaultLikeAnyOther) {
  EXPECT_EQ(Life(robotOf({&kFaultsWithBitsOfOperation})).live(), "");
}

TEST(FaultWithBitsOfOperation, IsNotTakenForPoweredOff) {
  Scene scene(loadText(robotOf({&kFaultsWithBitsOfOperation})));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
  scene.inject("left", "overcurrent");
  scene.run(500ms);
  EXPECT_EQ(scene.state("left").state, drive::State::fault);
  std::vector<std::uint16_t> controlwords;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x201) controlwords.push_back(frame.data[0]);
  });
  const bus::Answer disabled = scene.procedure(ProcedureKind::disable, "left");
  EXPECT_FALSE(disabled.success) << disabled.message;
  EXPECT_THAT(disabled.message, HasSubstr("fault"));
  ASSERT_FALSE(controlwords.empty());
  EXPECT_EQ(controlwords.front(), 0x02) << "quick stop, never disable voltage unasked";
}

}  // namespace
}  // namespace cia402::field
