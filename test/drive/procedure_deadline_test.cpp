// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Whatever the drive does, a procedure ends, and leaves an axis that does not
// move.
#include <cmath>

#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;
using test::testProfile;
using S = FakeDrive::S;
using namespace std::chrono_literals;

struct Case {
  const char* name;
  ProcedureKind kind;
  bool begins_enabled, begins_moving, begins_faulted;
  std::vector<S> shows;  // in turn, by a drive that bounces
};

void PrintTo(const Case& tested, std::ostream* out) { *out << tested.name; }

AxisConfig deadlineConfig(ProcedureKind kind) {
  DriveProfile profile = testProfile();
  profile.mode_change.needs_disabling = kind == ProcedureKind::set_mode;
  NamedWrite option;
  option.object = "quick_stop_option";
  option.raw = 2;
  profile.before_enable = {option};
  profile.parameters.timeout = 1s;
  AxisConfig config = testConfig(profile);
  config.mode = "cyclic_velocity";
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.homing->search_velocity = 0.1;
  config.homing->required = false;
  config.homing->timeout = 5s;
  return config;
}

class Deadline : public testing::TestWithParam<Case> {
 protected:
  Deadline() : bench(deadlineConfig(GetParam().kind)) {}

  void SetUp() override {
    bench.drive.quick_stop_deceleration = 100000;
    ASSERT_TRUE(bench.boot());
    if (GetParam().begins_enabled) {
      ASSERT_TRUE(bench.enable());
    }
    if (GetParam().begins_moving) {
      bench.follow(1.0);
      bench.run(200ms);
      ASSERT_GT(bench.drive.velocity, 9000);
      bench.each_cycle = nullptr;
    }
    if (GetParam().begins_faulted) {
      bench.fail(0x8611);
      bench.run(40ms);
    }
  }

  /// @return the time that it took
  Duration runToItsEnd() {
    const Time began = bench.now;
    const auto started = bench.axis.start({GetParam().kind, "cyclic_position", 0.5}, bench.now);
    EXPECT_TRUE(started.ok()) << (started.ok() ? "" : started.error().message);
    EXPECT_GT(bench.axis.procedure().deadline, began);
    EXPECT_LE(bench.axis.procedure().deadline, began + 80s);
    EXPECT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }, 120s))
        << "still runs: " << bench.axis.procedure().step << ", waiting for "
        << bench.axis.procedure().waiting_for;
    EXPECT_LE(bench.now, bench.axis.procedure().deadline + Bench::kCycle);
    return bench.now - began;
  }

  void expectSafe() {
    bench.run(3s);
    const std::string said = bench.axis.procedure().message;
    EXPECT_EQ(bench.drive.velocity, 0.0) << said;
    const double at = bench.drive.position;
    bench.run(1s);
    EXPECT_EQ(bench.drive.position, at) << said;
    const bool enabled = bench.axis.procedure().success && !stops(GetParam().kind);
    if (!enabled && GetParam().kind != ProcedureKind::halt) {
      EXPECT_NE(bench.drive.controlword & 0x000F, 0x000F) << said;
    }
  }

  Bench bench;
};

TEST_P(Deadline, EndsAProcedureWithADriveThatBounces) {
  bench.drive.shows = GetParam().shows;
  runToItsEnd();
  expectSafe();
}

TEST_P(Deadline, EndsAProcedureWithADriveThatIsMute) {
  bench.drive.mute = true;
  runToItsEnd();
  expectSafe();
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Deadline,
    testing::Values(
        Case{"enable", ProcedureKind::enable, false, false, false, {S::disabled, S::ready}},
        Case{"disable", ProcedureKind::disable, true, true, false, {S::enabled, S::on}},
        Case{"home", ProcedureKind::home, false, false, false, {S::disabled, S::ready}},
        Case{"clear_faults",
             ProcedureKind::clear_faults,
             true,
             false,
             true,
             {S::fault, S::reaction}},
        Case{"recover", ProcedureKind::recover, true, false, true, {S::disabled, S::ready}},
        Case{"quick_stop", ProcedureKind::quick_stop, true, true, false, {S::enabled, S::on}},
        Case{"halt", ProcedureKind::halt, true, true, false, {S::enabled, S::quick}},
        Case{"set_mode", ProcedureKind::set_mode, false, false, false, {S::disabled, S::ready}},
        Case{
            "set_position", ProcedureKind::set_position, false, false, false, {S::disabled, S::on}},
        Case{"save", ProcedureKind::save_parameters, false, false, false, {S::disabled, S::ready}},
        Case{"restore",
             ProcedureKind::restore_parameters,
             false,
             false,
             false,
             {S::disabled, S::ready}}),
    [](const testing::TestParamInfo<Case>& tested) { return std::string(tested.param.name); });

TEST(ProcedureDeadline, TellsWhatItWaitedForAndHowOftenTheDriveChanged) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.shows = {S::disabled, S::ready, S::on};
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): enable was given up after "));
  EXPECT_THAT(status.message, HasSubstr("while switching on, waiting for the drive to leave "));
  EXPECT_THAT(status.message, HasSubstr("quick stop is commanded"));
  EXPECT_THAT(status.message, HasSubstr("statusword 0x02"));
  // It shows another state in every cycle of 4 ms.
  const auto at = status.message.find("changed its state ");
  ASSERT_NE(at, std::string::npos) << status.message;
  const double changes = std::stod(status.message.substr(at + 18));
  EXPECT_NEAR(changes, toSeconds(bench.now - status.started) / 0.004, 50.0);
}

TEST(ProcedureDeadline, ASwitchOfTheModeThatIsGivenUpEndsInAQuickStop) {
  DriveProfile profile = testProfile();
  profile.mode_change.needs_disabling = true;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.run(100ms);
  bench.each_cycle = [&] {  // it lets itself be switched on, and falls back
    if (bench.drive.state == S::on && bench.axis.procedure().running)
      bench.drive.state = S::disabled;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::set_mode, "cyclic_velocity");
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("set_mode was given up after "));
  bench.run(100ms);
  EXPECT_EQ(bench.drive.state, S::disabled);
}

TEST(ProcedureDeadline, IsNoShorterThanWhatSlowDrivesMayTake) {
  DriveProfile profile = testProfile();
  profile.timing.state_change = 10s;
  profile.timing.mode_change = 20s;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  bench.drive.mode_delay = 4500;  // 18 s
  Time changed = bench.now;
  bench.drive.stuck = {S::disabled, S::ready, S::on};
  bench.each_cycle = [&,
                      last = bench.drive.state]() mutable {  // 9 s in each state
    if (bench.drive.state != last) {
      changed = bench.now;
      bench.drive.stuck = {S::disabled, S::ready, S::on};
    }
    last = bench.drive.state;
    if (bench.drive.mode == 8 && bench.now - changed > 9s) bench.drive.stuck.clear();
    if (bench.drive.mode != 8) changed = bench.now;
  };
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_GT(bench.now - status.started, 40s);
}

/// The drive stays in `state` for so long each time it comes there.
void linger(Bench& bench, S state, Duration span) {
  bench.drive.stuck = {state};
  bench.each_cycle = [&bench, state, span, last = S::disabled, since = bench.now]() mutable {
    if (bench.drive.state != last) {
      since = bench.now;
      bench.drive.stuck = {state};
    }
    last = bench.drive.state;
    if (last == state && bench.now - since > span) bench.drive.stuck.clear();
  };
}

TEST(ProcedureDeadline, ATransitionHasTheTimeThatTheProfileGivesIt) {
  DriveProfile profile = testProfile();
  profile.timing.transitions[4] = 6s;  // switched on -> operation enabled; the others 2 s
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  linger(bench, S::on, 5s);
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_TRUE(status.success) << status.message;
  EXPECT_GT(bench.now - status.started, 5s);
}

TEST(ProcedureDeadline, AnotherTransitionKeepsTheCommonTime) {
  DriveProfile profile = testProfile();
  profile.timing.transitions[4] = 6s;
  Bench bench(testConfig(profile));
  ASSERT_TRUE(bench.boot());
  linger(bench, S::ready, 5s);
  const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("the drive has been in ready to switch on for 2"));
}

}  // namespace
}  // namespace cia402::drive
