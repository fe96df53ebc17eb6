// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <utility>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;

TEST(SetModeProcedure, SwitchesAnEnabledAxisAtStandstillWithoutMotion) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  double largest = 0;
  bench.each_cycle = [&] { largest = std::max(largest, std::fabs(bench.drive.velocity)); };
  for (const char* mode : {"pp", "csv", "profile_velocity", "csp", "csv", "csp", "pp", "csp"}) {
    const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, mode);
    EXPECT_TRUE(status.success) << status.message;
    EXPECT_EQ(bench.axis.state().mode->name, canonicalModeName(mode));
    EXPECT_TRUE(bench.axis.state().ready_for_motion);
    bench.run(milliseconds(40));
  }
  EXPECT_EQ(largest, 0.0);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::enabled);
}

/// Modes of streamed set-points want bit 4, as interpolated position does.
DriveProfile profileWithBit4() {
  DriveProfile profile = testProfile();
  for (ModeSpec& mode : profile.modes) {
    if (mode.cyclic) mode.controlword_bits = 0x10;
  }
  return profile;
}
AxisConfig withBit4() { return testConfig(profileWithBit4()); }

/// Counts how often bit 4 rises while the drive is in another mode than `mode`.
void countEdges(Bench& bench, int mode, int& edges) {
  auto before = std::make_shared<bool>(false);
  bench.each_cycle = [&bench, &edges, mode, before] {
    const bool bit = (bench.drive.controlword & 0x10) != 0;
    if (bit && !std::exchange(*before, bit) && bench.drive.mode != mode) ++edges;
    *before = bit;
  };
}

// Bit 4 begins a homing in homing mode, and takes a set-point in profile position.
TEST(SetModeProcedure, BitsOfAModeAreSentOnceTheDriveShowsIt) {
  for (const char* before : {"pp", "profile_velocity"}) {
    Bench bench(withBit4());
    ASSERT_TRUE(bench.boot() && bench.enable());
    ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, before).success);
    bench.drive.mode_delay = 10;
    int edges = 0;
    countEdges(bench, 8, edges);
    const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "csp");
    EXPECT_TRUE(status.success) << status.message;
    bench.run(milliseconds(40));
    EXPECT_EQ(edges, 0);
    EXPECT_NE(bench.drive.controlword & 0x10, 0);
  }
}

TEST(SetModeProcedure, BitsOfTheModeThatFollowsAHomingBeginNoOther) {
  AxisConfig config = withBit4();
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.homing->search_velocity = 0.3;
  Bench bench(config);
  ASSERT_TRUE(bench.boot() && bench.enable());
  bench.drive.mode_delay = 10;
  int edges = 0;
  countEdges(bench, 8, edges);
  const ProcedureStatus& status = bench.perform(ProcedureKind::home);
  EXPECT_TRUE(status.success) << status.message;
  bench.run(milliseconds(40));
  EXPECT_EQ(edges, 1) << "its start";
  EXPECT_NE(bench.drive.controlword & 0x10, 0);
}

TEST(SetModeProcedure, BitsWaitForADriveThatTakesItsModeOnceItIsEnabled) {
  DriveProfile profile = profileWithBit4();
  profile.mode_change.shown_when_enabled = true;
  profile.mode_change.again = ModeChange::Again::same;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.mode = 6;
  bench.drive.forgets_mode = true;
  int edges = 0;
  bool was_enabled = false;
  countEdges(bench, 8, edges);
  const auto count = bench.each_cycle;
  bench.each_cycle = [&] {
    count();
    was_enabled |= bench.drive.state == FakeDrive::S::enabled && bench.drive.mode == 6;
  };
  (void)bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(was_enabled) << "in the mode before";
  EXPECT_EQ(edges, 0);
}

TEST(SetModeProcedure, DisablesADriveThatTakesNoModeWhileEnabled) {
  DriveProfile profile = testProfile();
  profile.mode_change.needs_disabling = true;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bool changed_while_enabled = false;
  int before = bench.drive.commanded_mode;
  bench.each_cycle = [&] {
    const bool enabled = bench.drive.state == FakeDrive::S::enabled;
    changed_while_enabled |= enabled && bench.drive.commanded_mode != before;
    if (!enabled) before = bench.drive.commanded_mode;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "csv");
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("disabled meanwhile as the drive demands"));
  EXPECT_FALSE(changed_while_enabled);
  EXPECT_EQ(bench.axis.state().mode->name, "cyclic_velocity");
  EXPECT_EQ(bench.drive.state, FakeDrive::S::enabled);
  EXPECT_THAT(bench.perform(ProcedureKind::set_mode, "csv").message, Not(HasSubstr("meanwhile")));
}

TEST(SetModeProcedure, AStaleTargetOfTheNewModeIsReplacedBeforeTheModeIsActive) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  bench.follow(0.5);
  bench.run(milliseconds(1000));
  bench.each_cycle = nullptr;  // comes to rest
  bench.run(milliseconds(300));
  ASSERT_GT(bench.drive.position, 17000);
  std::vector<std::int32_t> targets;
  bench.each_cycle = [&] {
    if (bench.drive.mode == 8) targets.push_back(bench.drive.target_position);
  };
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csp").success);
  ASSERT_FALSE(targets.empty());
  for (const std::int32_t target : targets) EXPECT_EQ(target, std::int32_t(bench.drive.position));
}

TEST(SetModeProcedure, TheNeutralTargetIsOnTheWireBeforeTheModeIsCommanded) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  bench.follow(0.5);
  bench.run(milliseconds(8));
  bench.each_cycle = nullptr;
  bench.run(milliseconds(300));
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csp").success);
  bench.run(milliseconds(200));
  std::int32_t last_before = -1;
  bench.each_cycle = [&] {
    if (bench.drive.commanded_mode == 8) last_before = bench.drive.target_velocity;
  };
  ASSERT_TRUE(bench.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_EQ(last_before, 0);
}

TEST(SetModeProcedure, IsRefusedInMotion) {
  AxisConfig config = testConfig();
  config.mode = "cyclic_velocity";
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.follow(0.5);
  bench.run(milliseconds(200));
  EXPECT_THAT(bench.refusal(ProcedureKind::set_mode, "csp"),
              HasSubstr("shoulder (node 3): mode cyclic_position is refused in motion (velocity "
                        "0.500)"));
}

TEST(SetModeProcedure, RefusesUnknownUnmappedAndHomingModes) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  EXPECT_THAT(
      bench.refusal(ProcedureKind::set_mode, "cst"),
      HasSubstr("shoulder (node 3): the drive family test_drive has no mode \"cst\"; it has "
                "profile_position, profile_velocity, cyclic_position, cyclic_velocity"));
  EXPECT_THAT(bench.refusal(ProcedureKind::set_mode, "ip"),
              HasSubstr("60C1:01 interpolation_target is not mapped into an RPDO"));
  EXPECT_THAT(bench.refusal(ProcedureKind::set_mode, "hm"), HasSubstr("call home"));
}

TEST(SetModeProcedure, ADriveThatDoesNotFollowKeepsItsMode) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.each_cycle = [&] { bench.drive.commanded_mode = 8; };
  bench.drive.mode_delay = 100000;
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "csv");
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("mode cyclic_velocity was not taken"));
  EXPECT_THAT(status.message, HasSubstr("6060:00 was set to 9 (cyclic_velocity)"));
  bench.drive.mode_delay = 0;
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.drive.commanded_mode, 8);
}

TEST(SetModeProcedure, EntryWritesOfMappedObjectsStayInTheRpdo) {
  DriveProfile profile = testProfile();
  NamedWrite speed;
  speed.object = "target_velocity";
  speed.value = 0.7;
  profile.modes[4].entry_writes = {speed};  // a vendor's position mode with a speed limit
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.drive.target_velocity, 7000);
  EXPECT_THAT(bench.drive.writes, testing::Contains(std::make_pair(0x60FFu, std::uint64_t{7000})));
}

NamedWrite writing(const char* object, double value) {
  NamedWrite write;
  write.object = object;
  write.value = value;
  return write;
}

/// Two modes that need other numbers in the same object.
AxisConfig modesWithSpeeds() {
  DriveProfile profile = testProfile();
  profile.modes[4].entry_writes = {writing("profile_velocity", 0.5)};
  profile.modes[5].entry_writes = {writing("profile_velocity", 1.5),
                                   writing("quick_stop_option", 3)};
  return testConfig(profile);
}

class CutOffSetMode : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.enable());
    ASSERT_EQ(profileVelocity(), 5000u);
  }
  std::uint64_t profileVelocity() { return bench.drive.dictionary[{0x6081, 0}].first; }
  /// The axis takes nothing until it has what its mode needs.
  void expectToWaitForEnable() {
    EXPECT_EQ(profileVelocity(), 15000u);
    EXPECT_FALSE(bench.give(bench.axis.state().position));
    EXPECT_FALSE(bench.perform(ProcedureKind::recover).success);
    ASSERT_TRUE(bench.enable());
    EXPECT_EQ(profileVelocity(), 5000u);
    EXPECT_EQ(bench.axis.motionRefusal(), "");
    EXPECT_TRUE(bench.give(bench.axis.state().position));
  }

  Bench bench{modesWithSpeeds()};
};

TEST_F(CutOffSetMode, ByAHaltLeavesNothingOfTheOtherMode) {
  const auto id = bench.axis.start({ProcedureKind::set_mode, "csv", 0.0}, bench.now);
  ASSERT_TRUE(id.ok());
  ASSERT_TRUE(bench.runUntil([&] { return profileVelocity() == 15000; }));
  ASSERT_TRUE(bench.perform(ProcedureKind::halt).success);
  ASSERT_EQ(bench.axis.state().mode->name, "cyclic_position");
  EXPECT_THAT(bench.axis.obstacle(), HasSubstr("shoulder is halted: enable"));
  expectToWaitForEnable();
}

TEST_F(CutOffSetMode, ByARefusalLeavesNothingOfTheOtherMode) {
  bench.drive.aborts[{0x605A, 0}] = 0x08000022;
  ASSERT_FALSE(bench.perform(ProcedureKind::set_mode, "csv").success);
  EXPECT_EQ(bench.axis.obstacle(),
            "shoulder may lack what mode cyclic_position needs, for a change of the mode was cut "
            "off: enable");
  EXPECT_THAT(bench.axis.motionRefusal(),
              HasSubstr("the drive may lack what mode cyclic_position needs, for a change of the "
                        "mode was cut off; call enable"));
  expectToWaitForEnable();
}

TEST(VelocityMode, TakesVelocitiesWithinTheLimit) {
  AxisConfig config = testConfig();
  config.mode = "csv";
  config.mode = canonicalModeName(config.mode);
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  EXPECT_FALSE(bench.axis.setTarget(2.1));
  EXPECT_FALSE(bench.axis.setTarget(-2.1));
  bench.follow(-1.5);
  bench.run(milliseconds(12));
  EXPECT_EQ(bench.drive.target_velocity, -15000);
}

TEST(VelocityMode, DoesNotDriveFurtherOutOfThePositionLimits) {
  AxisConfig config = testConfig();
  config.mode = "cyclic_velocity";
  Bench bench(config);
  bench.drive.position = 31500;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  EXPECT_FALSE(bench.axis.setTarget(0.1));
  EXPECT_TRUE(bench.axis.setTarget(-0.1));
}

AxisConfig profilePosition() {
  AxisConfig config = testConfig();
  config.mode = "profile_position";
  return config;
}

TEST(ProfilePositionMode, HandsOverEachTargetOnceAndNeverThePreviousOne) {
  Bench bench(profilePosition());
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.axis.setTarget(1.3));
  bench.run(milliseconds(400));
  EXPECT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{13000}));
  EXPECT_TRUE(bench.axis.state().target_reached);
  ASSERT_TRUE(bench.give(1.2));
  bench.cycle();
  EXPECT_FALSE(bench.axis.state().target_reached) << "the bit still speaks of the old target";
  bench.run(milliseconds(400));
  EXPECT_EQ(bench.drive.accepted, (std::vector<std::int32_t>{13000, 12000}));
  EXPECT_EQ(bench.drive.controlword & 0x0030, 0x0020);
}

TEST(ProfilePositionMode, TheLatestOfManyTargetsWins) {
  Bench bench(profilePosition());
  bench.drive.acknowledge_delay = 10;
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  int target = 13000;
  bench.each_cycle = [&] {
    if (target == 14000) return;
    target += 10;
    EXPECT_TRUE(bench.axis.setTarget(1e-4 * target));
  };
  bench.run(milliseconds(1500));
  ASSERT_FALSE(bench.drive.accepted.empty());
  EXPECT_LT(bench.drive.accepted.size(), 20u);
  EXPECT_EQ(bench.drive.accepted.back(), 14000);
  EXPECT_EQ(bench.drive.position, 14000);
}

TEST(ProfilePositionMode, AMissingAcknowledgeIsToldAndDoesNotStickTheBit) {
  Bench bench(profilePosition());
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.drive.acknowledges = false;
  ASSERT_TRUE(bench.axis.setTarget(1.3));
  bench.run(std::chrono::seconds(3));
  EXPECT_EQ(bench.drive.controlword & 0x0010, 0);
  EXPECT_THAT(bench.axis.notice(),
              HasSubstr("shoulder (node 3): the drive did not take the set-point 1.300: waited 2 s "
                        "for statusword bit 12 (set-point acknowledge) to rise"));
  bench.drive.acknowledges = true;
  ASSERT_TRUE(bench.axis.setTarget(1.3));
  bench.run(milliseconds(400));
  EXPECT_EQ(bench.drive.accepted.size(), 1u) << "the same target can be given again";
}

}  // namespace
}  // namespace cia402::drive
