// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How long procedures may take: for each thing that a drive may take its time for, the limit grows
// as often as the procedure may have to wait for it.
#include "drive/procedures/limits.h"

#include <limits>
#include <type_traits>

#include "drive/axis/standstill.h"
#include "drive/axis_fixture.h"

namespace cia402::drive::test {
namespace {

using namespace std::chrono_literals;

/// How often a procedure may wait for each.
struct Waits {
  const char* name;
  ProcedureKind kind;
  int state_changes, mode_changes, transfers, boots, saves;
};

void PrintTo(const Waits& waits, std::ostream* out) { *out << waits.name; }

// Enabling: a goal that another one still holds, three transitions and one out of quick stop
// active; the mode is left, taken and shown; one object is written before it, two when the mode
// begins, of which one is a copy and so read first, 6060h is written and 6061h read, and each of
// two position limits takes three transfers.
constexpr Waits kProcedures[] = {
    {"enable", ProcedureKind::enable, 5, 3, 12, 0, 0},
    {"disable", ProcedureKind::disable, 2, 0, 0, 0, 0},
    // Three objects of homing, enabling, the mode of homing, its end (one read), the mode again;
    // the limits are opened and closed beside.
    {"home", ProcedureKind::home, 7, 5, 33, 0, 0},
    {"clear_faults", ProcedureKind::clear_faults, 10, 0, 0, 0, 0},  // two tries
    {"recover", ProcedureKind::recover, 17, 3, 12, 3, 0},
    {"quick_stop", ProcedureKind::quick_stop, 1, 0, 0, 0, 0},
    {"halt", ProcedureKind::halt, 0, 0, 0, 0, 0},
    {"set_mode", ProcedureKind::set_mode, 0, 2, 5, 0, 0},
    {"set_position", ProcedureKind::set_position, 0, 0, 12, 0, 0},
    {"save_parameters", ProcedureKind::save_parameters, 0, 0, 1, 0, 1},
    {"restore_parameters", ProcedureKind::restore_parameters, 0, 0, 1, 3, 1},
};

DriveProfile slowProfile() {
  DriveProfile profile = testProfile();
  profile.fault_reset.tries = 2;
  NamedWrite option;
  option.object = "quick_stop_option";
  option.raw = 2;
  profile.before_enable = {option};
  for (ModeSpec& mode : profile.modes) {
    if (mode.name == "cyclic_velocity") {
      mode.entry_writes = {option, from("profile_velocity", "velocity_actual")};
    }
  }
  return profile;
}

/// A device that answers at the first time or never.
fieldbus::DeviceTimes slowDevice() {
  fieldbus::DeviceTimes device;
  device.access.retries = 0;
  return device;
}

/// Stops in 4 s.
AxisConfig slowAxis(DriveProfile profile = slowProfile()) {
  AxisConfig config = testConfig(std::move(profile));
  config.limits.velocity = 2.0;
  config.limits.acceleration = 0.5;
  config.homing = HomingOptions();
  config.homing->method = 17;
  config.homing->timeout = 5s;
  return config;
}

Duration limitOf(ProcedureKind kind, const DriveProfile& profile,
                 const fieldbus::DeviceTimes& device = slowDevice()) {
  return timeLimit(kind, slowAxis(profile), device, 0.0);
}

Duration limitOf(ProcedureKind kind, const AxisConfig& axis, double velocity = 0.0) {
  return timeLimit(kind, axis, slowDevice(), velocity);
}

class LimitOf : public testing::TestWithParam<Waits> {
 protected:
  /// By how much the limit grows where `change` makes something 100 ms slower.
  template <typename Change>
  int growth(const Change& change) const {
    DriveProfile slower = slowProfile();
    fieldbus::DeviceTimes device = slowDevice();
    if constexpr (std::is_invocable_v<Change, DriveProfile&>) {
      change(slower);
    } else {
      change(device);
    }
    const Duration more =
        limitOf(GetParam().kind, slower, device) - limitOf(GetParam().kind, slowProfile());
    EXPECT_EQ(more % 100ms, Duration(0));
    return static_cast<int>(more / Duration(100ms));
  }
};

TEST_P(LimitOf, GrowsWithAllThatItWaitsFor) {
  const Waits& waits = GetParam();
  EXPECT_EQ(growth([](DriveProfile& drive) { drive.timing.state_change += 100ms; }),
            waits.state_changes);
  EXPECT_EQ(growth([](DriveProfile& drive) { drive.timing.mode_change += 100ms; }),
            waits.mode_changes);
  EXPECT_EQ(growth([](fieldbus::DeviceTimes& device) { device.access.timeout += 100ms; }),
            waits.transfers);
  EXPECT_EQ(growth([](fieldbus::DeviceTimes& device) { device.boot += 100ms; }), waits.boots);
  EXPECT_EQ(growth([](DriveProfile& drive) { drive.parameters.timeout += 100ms; }), waits.saves);
}

INSTANTIATE_TEST_SUITE_P(Procedures, LimitOf, testing::ValuesIn(kProcedures),
                         [](const auto& param) { return std::string(param.param.name); });

TEST(ProcedureLimits, ATransferThatIsRepeatedCountsAsOften) {
  fieldbus::DeviceTimes patient = slowDevice();
  patient.access.timeout = 100ms;
  const Duration once = limitOf(ProcedureKind::set_position, slowProfile(), patient);
  patient.access.retries = 2;
  EXPECT_EQ(limitOf(ProcedureKind::set_position, slowProfile(), patient) - once, 12 * 2 * 100ms);
}

TEST(ProcedureLimits, ABrakeIsWaitedForBeforeFollowing) {
  DriveProfile braked = slowProfile();
  const Duration without = limitOf(ProcedureKind::enable, braked);
  braked.timing.brake_release = 900ms;
  EXPECT_EQ(limitOf(ProcedureKind::enable, braked), without + 900ms);
  braked.timing.brake_release = 3s;
  EXPECT_EQ(limitOf(ProcedureKind::enable, braked), without + 3s);
}

// A drive that forgets its mode while disabled is brought into it once more, and by way of another
// mode at the most: what that takes, twice, instead of once the time until the mode shows.
TEST(ProcedureLimits, AModeThatIsCommandedAgainByADetourTakesItTwice) {
  DriveProfile forgetful = slowProfile();
  forgetful.mode_change.again = ModeChange::Again::same;
  const Duration without = limitOf(ProcedureKind::enable, forgetful);
  EXPECT_EQ(without, limitOf(ProcedureKind::enable, slowProfile()));
  forgetful.mode_change.detours = {{"profile_velocity", "cyclic_position", "profile_position"}};
  const Duration mode = 2 * forgetful.timing.mode_change + 5 * slowDevice().access.timeout;
  // An axis that is enabled in another mode may have to be disabled for it.
  const Duration disabled = forgetful.timing.state_change + mode;
  EXPECT_EQ(limitOf(ProcedureKind::enable, forgetful),
            without + disabled - forgetful.timing.mode_change + 2 * mode);
  forgetful.mode_change.again = ModeChange::Again::never;
  EXPECT_EQ(limitOf(ProcedureKind::enable, forgetful), without + disabled);
}

TEST(ProcedureLimits, AResetBehindNmtStopIsOneTryMore) {
  DriveProfile stopped = slowProfile();
  const Duration without = limitOf(ProcedureKind::clear_faults, stopped);
  stopped.fault_reset.pause = 100ms;
  const Duration once = limitOf(ProcedureKind::clear_faults, stopped);
  EXPECT_GT(once, without);
  stopped.fault_reset.tries = 3;
  const Duration tried = limitOf(ProcedureKind::clear_faults, stopped) - once;
  stopped.fault_reset.pause = Duration::zero();
  EXPECT_EQ(limitOf(ProcedureKind::clear_faults, stopped) - without, tried) << "of one try";
  EXPECT_GE(once, without + tried + 100ms);
}

TEST(ProcedureLimits, AHistoryThatIsClearedBeforeAResetTakesATransfer) {
  DriveProfile clears = slowProfile();
  const Duration without = limitOf(ProcedureKind::clear_faults, clears);
  clears.fault_reset.clears_history = true;
  EXPECT_EQ(limitOf(ProcedureKind::clear_faults, clears), without + slowDevice().access.timeout);
}

TEST(ProcedureLimits, GrowWithTheTimesOfSingleTransitions) {
  DriveProfile slow = slowProfile();
  for (const int transition : {2, 3, 4})
    slow.timing.transitions[transition] = slow.timing.state_change + 1s;
  EXPECT_EQ(limitOf(ProcedureKind::enable, slow),
            limitOf(ProcedureKind::enable, slowProfile()) + 3s);
  slow.timing.transitions = {{5, slow.timing.state_change + 4s}};
  EXPECT_EQ(limitOf(ProcedureKind::disable, slow),
            limitOf(ProcedureKind::disable, slowProfile()) + 4s);
}

TEST(ProcedureLimits, AModeForWhichTheAxisIsDisabledTakesAnEnablingMore) {
  DriveProfile other = slowProfile();
  other.mode_change.needs_disabling = true;
  const Duration enabling = limitOf(ProcedureKind::enable, slowProfile());
  const Duration more =
      limitOf(ProcedureKind::set_mode, other) - limitOf(ProcedureKind::set_mode, slowProfile());
  EXPECT_EQ(more, other.timing.state_change + enabling - 500ms) << "0.5 s are in each limit once";
}

TEST(ProcedureLimits, ADeclaredHomeTakesNoLongerThanADeclaredPosition) {
  AxisConfig config = slowAxis();
  config.homing.reset();
  const Duration declared = limitOf(ProcedureKind::set_position, config);
  EXPECT_EQ(limitOf(ProcedureKind::home, config), declared);
  DriveProfile declares = slowProfile();
  declares.homing.methods = {{std::nullopt, {"declared", false, {}}}};
  EXPECT_EQ(limitOf(ProcedureKind::home, slowAxis(declares)), declared);
}

TEST(ProcedureLimits, HomingHasTheTimeThatTheFileGivesIt) {
  AxisConfig config = slowAxis();
  const Duration before = limitOf(ProcedureKind::home, config);
  config.homing->timeout += 60s;
  EXPECT_EQ(limitOf(ProcedureKind::home, config), before + 60s);
}

// From 2 rad/s at 0.5 rad/s^2 it takes 4 s; twice that and half a second are waited.
TEST(ProcedureLimits, AStopHasTwiceTheTimeOfItsRamp) {
  const AxisConfig config = slowAxis();
  EXPECT_EQ(stopTime(config, 0.0), 8500ms);
  EXPECT_EQ(stopTime(config, -1.0), 8500ms);
  EXPECT_EQ(stopTime(config, std::numeric_limits<double>::quiet_NaN()), 8500ms) << "not known";
  EXPECT_EQ(stopTime(config, 3.0), 12500ms) << "faster than it may";
  EXPECT_EQ(stopTime(config, -3.0), 12500ms);
  EXPECT_EQ(limitOf(ProcedureKind::halt, config, 3.0), 13s);
  EXPECT_EQ(limitOf(ProcedureKind::disable, config, 3.0),
            limitOf(ProcedureKind::disable, config) + 4s);
  AxisConfig unlimited = config;
  unlimited.limits.velocity.reset();
  EXPECT_EQ(stopTime(unlimited, 0.0), 2s) << "a change of state, at least";
  EXPECT_EQ(stopTime(unlimited, std::numeric_limits<double>::quiet_NaN()), 2s);
  AxisConfig quick = config;
  quick.limits.acceleration = 100.0;
  EXPECT_EQ(stopTime(quick, 0.0), 2s);
}

// It must stand for four windows of the detector of standstill, before and after.
TEST(ProcedureLimits, DeclaringAPositionWaitsForStandstillTwice) {
  DriveProfile profile = slowProfile();
  fieldbus::DeviceTimes device = slowDevice();
  device.access.timeout = Duration::zero();
  EXPECT_EQ(limitOf(ProcedureKind::set_position, profile, device),
            500ms + 2 * 4 * Standstill::kWindow);
  EXPECT_EQ(limitOf(ProcedureKind::set_mode, profile, device) - 2 * profile.timing.mode_change,
            500ms + 4 * Standstill::kWindow);
}

}  // namespace
}  // namespace cia402::drive::test
