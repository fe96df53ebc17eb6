// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The joint's limits in a drive that does not take them whenever they are offered.
#include <algorithm>
#include <limits>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using testing::Not;

constexpr std::uint32_t kNotNow = 0x08000022;
const std::pair<unsigned, unsigned> kLower{0x607D, 1}, kUpper{0x607D, 2};

NamedWrite limit(const char* object, const char* source) {
  NamedWrite write = test::from(object, source);
  write.when_homed = write.optional = true;
  return write;
}

/// Limits of +-3.1 rad, 0.0001 rad a count.
AxisConfig limited(bool homing = false, bool optional = true) {
  DriveProfile profile = test::testProfile();
  profile.objects.push_back(test::object("lower", 0x607D, DataType::int32, Quantity::position, 1));
  profile.objects.push_back(test::object("upper", 0x607D, DataType::int32, Quantity::position, 2));
  profile.startup = {limit("lower", "limits.lower"), limit("upper", "limits.upper")};
  for (NamedWrite& write : profile.startup) write.optional = optional;
  AxisConfig config = test::testConfig(std::move(profile));
  if (!homing) return config;
  config.homing = HomingOptions();
  config.homing->method = 37;
  config.homing->offset = 1.0;
  return config;
}

struct World : Bench {
  explicit World(bool homing = false) : World(limited(homing)) {}
  explicit World(AxisConfig config) : Bench(std::move(config)) { hold(0, 0); }
  void hold(std::int32_t lower, std::int32_t upper) {
    drive.dictionary[kLower] = {static_cast<std::uint32_t>(lower), 4};
    drive.dictionary[kUpper] = {static_cast<std::uint32_t>(upper), 4};
  }
  std::int32_t lower() { return static_cast<std::int32_t>(drive.dictionary[kLower].first); }
  std::int32_t upper() { return static_cast<std::int32_t>(drive.dictionary[kUpper].first); }
  void refuse() { drive.aborts[kLower] = drive.aborts[kUpper] = kNotNow; }
  std::size_t written() {
    return static_cast<std::size_t>(
        std::count_if(drive.writes.begin(), drive.writes.end(),
                      [](const auto& write) { return write.first == 0x607D; }));
  }
};

TEST(PositionLimits, AreWrittenOnceTheNodeIsReady) {
  World world;
  ASSERT_TRUE(world.boot());
  world.run(milliseconds(100));
  EXPECT_EQ(world.lower(), -31000);
  EXPECT_EQ(world.upper(), 31000);
}

// NiMotion steppers keep them at 607Bh and at 607Dh.
TEST(PositionLimits, AreWrittenToAsManyObjectsAsTheFamilyHas) {
  AxisConfig config = limited();
  auto profile = std::make_shared<DriveProfile>(*config.profile);
  profile->objects.push_back(
      test::object("range_low", 0x607B, DataType::int32, Quantity::position, 1));
  profile->objects.push_back(
      test::object("range_high", 0x607B, DataType::int32, Quantity::position, 2));
  profile->startup.push_back(limit("range_low", "limits.lower"));
  profile->startup.push_back(limit("range_high", "limits.upper"));
  config.profile = profile;
  World world(config);
  const std::pair<unsigned, unsigned> low{0x607B, 1}, high{0x607B, 2};
  world.drive.dictionary[low] = world.drive.dictionary[high] = {0, 4};
  ASSERT_TRUE(world.boot());
  world.run(milliseconds(60));
  EXPECT_EQ(world.lower(), -31000);
  EXPECT_EQ(world.upper(), 31000);
  EXPECT_EQ(static_cast<std::int32_t>(world.drive.dictionary[low].first), -31000);
  EXPECT_EQ(world.drive.dictionary[high].first, 31000U);
  EXPECT_TRUE(world.enable());
}

TEST(PositionLimits, ThatTheDriveHasAreNotWrittenAgain) {
  World world;
  world.hold(-31000, 31000);
  ASSERT_TRUE(world.boot());
  ASSERT_TRUE(world.enable());
  EXPECT_EQ(world.written(), 0u);
}

TEST(PositionLimits, StandOpenUntilTheAxisIsHomed) {
  World world(true);
  world.hold(20000, 30000);
  ASSERT_TRUE(world.boot());
  ASSERT_TRUE(world.enable());
  EXPECT_EQ(world.lower(), std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(world.upper(), std::numeric_limits<std::int32_t>::max());
  const ProcedureStatus& status = world.perform(ProcedureKind::home);
  ASSERT_TRUE(status.success);
  EXPECT_THAT(status.message, Not(HasSubstr("position limits")));
  EXPECT_EQ(world.lower(), -31000);
  EXPECT_EQ(world.upper(), 31000);
}

TEST(PositionLimits, ThatTheDriveRefusesWhileEnabledStayOpenAfterHoming) {
  World world(true);
  ASSERT_TRUE(world.boot());
  ASSERT_TRUE(world.enable());
  world.refuse();
  const ProcedureStatus& status = world.perform(ProcedureKind::home);
  ASSERT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message,
              HasSubstr("position limits stay as they are until it is enabled again"));
  EXPECT_EQ(world.upper(), std::numeric_limits<std::int32_t>::max());
  world.drive.aborts.clear();
  ASSERT_TRUE(world.perform(ProcedureKind::disable).success);
  ASSERT_TRUE(world.enable());
  EXPECT_EQ(world.upper(), 31000);
}

TEST(PositionLimits, ThatTheDriveRefusedAreNotOfferedAgainAfterEachCall) {
  World world(true);
  ASSERT_TRUE(world.boot());
  ASSERT_TRUE(world.enable());
  world.refuse();
  ASSERT_TRUE(world.perform(ProcedureKind::home).success);
  world.run(milliseconds(100));
  world.drive.aborts.clear();
  ASSERT_TRUE(world.perform(ProcedureKind::halt).success);
  world.run(milliseconds(100));
  EXPECT_EQ(world.upper(), std::numeric_limits<std::int32_t>::max());
}

TEST(PositionLimits, ThatTheDriveKeepsWhileEnabledRefuseAnotherZero) {
  World world;
  ASSERT_TRUE(world.boot());
  ASSERT_TRUE(world.enable());
  world.refuse();
  const double before = world.axis.state().position;
  const ProcedureStatus& status = world.perform(ProcedureKind::set_position, {}, 0.5);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): declaring the position is refused"));
  EXPECT_THAT(status.message, HasSubstr("disable the axis first"));
  EXPECT_THAT(status.message, HasSubstr("0x08000022"));
  EXPECT_EQ(world.axis.state().position, before);
  EXPECT_EQ(world.lower(), -31000);
  EXPECT_EQ(world.drive.state, FakeDrive::S::enabled);
  world.drive.aborts.clear();
  ASSERT_TRUE(world.perform(ProcedureKind::disable).success);
  EXPECT_TRUE(world.perform(ProcedureKind::set_position, {}, 0.5).success);
  EXPECT_EQ(world.upper(), 31000 + 12345 - 5000);  // it stands at 12345 counts
}

TEST(PositionLimits, NarrowerOnesThatStayKeepTheAxisDisabled) {
  World world;
  world.hold(20000, 30000);
  world.refuse();
  ASSERT_TRUE(world.boot());
  const ProcedureStatus& status = world.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("position limits of another zero"));
  EXPECT_THAT(status.message, HasSubstr("0x08000022"));
  EXPECT_NE(world.drive.state, FakeDrive::S::enabled);
}

TEST(PositionLimits, ThatMustNotBeRefusedKeepTheAxisDisabledWhereOneIs) {
  for (const auto& refused : {kLower, kUpper}) {
    World world(limited(false, false));
    world.drive.aborts[refused] = kNotNow;
    ASSERT_TRUE(world.boot());
    const ProcedureStatus& status = world.perform(ProcedureKind::enable);
    EXPECT_FALSE(status.success);
    EXPECT_THAT(status.message, HasSubstr("0x08000022"));
    EXPECT_EQ(world.written(), 1u) << "the other one";
    EXPECT_NE(world.drive.state, FakeDrive::S::enabled);
  }
}

TEST(PositionLimits, ADriveWithoutThemIsEnabled) {
  World world;
  world.drive.dictionary.erase(kLower);
  world.drive.dictionary.erase(kUpper);
  ASSERT_TRUE(world.boot());
  EXPECT_TRUE(world.enable());
  EXPECT_EQ(world.written(), 0u);
}

TEST(PositionLimits, ADriveThatSwitchedThemOffAndTakesNoneIsEnabled) {
  World world;
  world.refuse();  // both are 0
  ASSERT_TRUE(world.boot());
  EXPECT_TRUE(world.enable());
}

TEST(PositionLimits, AreOpenOnTheSideBeyondWhichTheAxisStands) {
  World world;
  world.drive.position = 32000;
  ASSERT_TRUE(world.boot());
  ASSERT_TRUE(world.enable());
  EXPECT_EQ(world.lower(), -31000);
  EXPECT_EQ(world.upper(), std::numeric_limits<std::int32_t>::max());
  for (double target = 3.2; target > 3.0; target -= 0.001) {
    ASSERT_TRUE(world.axis.setTarget(target));
    world.cycle();
  }
  world.run(milliseconds(50));
  EXPECT_EQ(world.upper(), 31000);
}

TEST(PositionLimits, AreWrittenAgainToADriveThatHasForgottenThem) {
  World world;
  ASSERT_TRUE(world.boot());
  world.run(milliseconds(100));
  world.reboot();
  world.hold(0, 0);
  ASSERT_TRUE(world.perform(ProcedureKind::recover).success);
  world.run(milliseconds(100));
  EXPECT_EQ(world.lower(), -31000);
  EXPECT_EQ(world.upper(), 31000);
}

TEST(PositionLimits, ThatTheJointDoesNotHaveAreNotWritten) {
  AxisConfig config = limited();
  config.limits.upper.reset();
  Bench bench(config);
  bench.drive.dictionary[kLower] = bench.drive.dictionary[kUpper] = {20000, 4};
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(100));
  EXPECT_EQ(static_cast<std::int32_t>(bench.drive.dictionary[kLower].first), -31000);
  EXPECT_EQ(bench.drive.dictionary[kUpper].first, 20000u);
}

TEST(PositionLimits, ThatCannotBeReadAreWrittenAllTheSame) {
  World world;
  world.drive.read_aborts[kLower] = world.drive.read_aborts[kUpper] = 0x06010001;  // write-only
  ASSERT_TRUE(world.boot());
  world.run(milliseconds(100));
  EXPECT_EQ(world.lower(), -31000);
  EXPECT_EQ(world.upper(), 31000);
}

TEST(PositionLimits, ThatNobodyKnowsAndTheDriveDoesNotTakeLetTheAxisBeEnabled) {
  World world;
  world.drive.read_aborts[kLower] = world.drive.read_aborts[kUpper] = 0x06010001;
  world.refuse();
  ASSERT_TRUE(world.boot());
  EXPECT_TRUE(world.enable());
}

TEST(PositionLimits, ThatTheDriveKeepsOpenForANewZeroAreToldSo) {
  World world;
  ASSERT_TRUE(world.boot());
  world.run(milliseconds(100));
  world.each_cycle = [&] {
    if (world.upper() == std::numeric_limits<std::int32_t>::max()) world.refuse();
  };
  const ProcedureStatus& status = world.perform(ProcedureKind::set_position, {}, 0.5);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("the drive's own position limits stay as they are until it "
                                        "is enabled again: "));
  EXPECT_THAT(status.message, HasSubstr("0x08000022"));
}

}  // namespace
}  // namespace cia402::drive
