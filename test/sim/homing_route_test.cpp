// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Homing by the routes of a file, and what a maker has besides: hard stops, limit switches that are
// errors, minded less or braked harder, terminals and a time limit. In motor turns: limits at -2
// and 3, home switch from 0.5 to 0.8, index at k + 0.25, hard stops at -4 and 5; 1 turn/s fast, 0.1
// slow, 10 turns/s^2.
#include <yaml-cpp/yaml.h>

#include "homing_machine.h"
#include "sim/definition/drive_definition.h"

namespace cia402::sim {
namespace {

constexpr int kReached = 0x1400, kError = 0x2400;  // with standstill
constexpr std::uint16_t kStopTorque = 1, kStopTime = 2, kTimeLimit = 3, kTerminal1 = 4,
                        kTerminal2 = 5;  // sub-indices of 2F00h

YAML::Node with(const std::string& homing) {
  return YAML::Load(
      "{dictionary: [[0x2F00, 1, stop_torque, uint16, rw, \"-\", 500],\n"
      "  [0x2F00, 2, stop_time, uint16, rw, \"-\", 100], [0x2F00, 3, limit, uint16, rw, \"-\", "
      "0],\n"
      "  [0x2F00, 4, terminal_1, uint16, rw, \"-\", 0],\n"
      "  [0x2F00, 5, terminal_2, uint16, rw, \"-\", 0]],\n"
      " objects: {homing_stop_torque: \"2F00:01\", homing_stop_time: \"2F00:02\",\n"
      "  homing_time_limit: \"2F00:03\", input_1_function: \"2F00:04\",\n"
      "  input_2_function: \"2F00:05\"},\n"
      " faults: {terminal_setup: {code: 0xFF20}, homing_time: {code: 0xFF25}},\n"
      " homing: {methods: [-1], " +
      homing + "}}");
}

std::string route(const std::string& keys) { return "routes: {-1: {" + keys + "}}"; }

AxisMechanics machine(double start) {
  AxisMechanics mechanics = homingMachine(start);
  mechanics.negative_stop = -4.0;
  mechanics.positive_stop = 5.0;
  return mechanics;
}

struct Route : DriveBench {
  Route(const std::string& homing, double start)
      : DriveBench(loadDriveDefinition(
                       cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml",
                       with(homing)),
                   machine(start)) {
    write(0x6060, 0, 6, 1);
    write(0x6098, 0, 0xFF, 1);  // -1
    enable();
  }
  void set(std::uint16_t sub, int value) {
    write(0x2F00, static_cast<std::uint8_t>(sub), static_cast<std::uint32_t>(value), 2);
  }
  double turns() { return drive->truth(now).position_turns; }
  /// Starts, and follows for so long or until it stands. @return bits 10, 12 and 13
  int home(double seconds = 20.0) {
    control(0x001F);
    farthest = turns();
    for (int i = 0; i < 1000 * seconds; ++i) {
      run(ms(1));
      farthest = std::max(farthest, turns());
      if ((status() & 0x0400) != 0) break;
    }
    return static_cast<int>(read(0x6041)) & 0x3400;
  }
  /// 6064h, of which 0 is home.
  double fromHome() { return static_cast<std::int32_t>(read(0x6064)) / 131072.0; }
  double farthest = 0.0;
};

TEST(HomingRoute, GoesItsLegsOneAfterTheOther) {
  Route b(route("legs: \"+fast home on, -slow home off, -slow index\""), 0.0);
  EXPECT_EQ(b.home(), kReached);
  EXPECT_NEAR(b.turns() - b.fromHome(), 0.25, 2e-3) << "the index below the lower edge";
}

TEST(HomingRoute, BeginsOtherwiseOnTheSwitchOfItsFirstLeg) {
  const std::string keys = "legs: \"+fast home on\", begun_on: \"+slow home off\"";
  Route before(route(keys), 0.0), on(route(keys), 0.6);
  EXPECT_EQ(before.home(), kReached);
  EXPECT_NEAR(before.turns() - before.fromHome(), 0.5, 2e-3);
  EXPECT_EQ(on.home(), kReached);
  EXPECT_NEAR(on.turns() - on.fromHome(), 0.8, 2e-3);
}

TEST(HomingRoute, TurnsAtALimitWhereItSaysSo) {
  Route turns(route("legs: \"+fast home on\", from_limit: \"-fast home on\""), 2.0);
  EXPECT_EQ(turns.home(), kReached);
  EXPECT_NEAR(turns.turns() - turns.fromHome(), 0.8, 2e-3);
  Route fails(route("legs: \"+fast home on\""), 2.0);
  EXPECT_EQ(fails.home(), kError);
  EXPECT_NEAR(fails.turns(), 3.0, 0.1);
}

TEST(HomingRoute, TurnsAtALimitFromALegThatLooksForTheIndexPulse) {
  Route b(route("legs: \"-slow index\", from_limit: \"+slow index, -slow index\""), -1.9);
  EXPECT_EQ(b.home(), kReached);
  EXPECT_NEAR(b.turns() - b.fromHome(), -1.75, 1e-4) << "the last one before the limit";
}

TEST(HomingRoute, IsAtHomeWhereItBeginsOnTheIndexPulseAndHomeIsHere) {
  const std::string keys = "legs: \"-slow index\", begun_on: here";
  Route on(route(keys), 0.25), behind(route(keys), 0.251);
  EXPECT_EQ(on.home(), kReached);
  EXPECT_NEAR(on.turns(), 0.25, 1e-5) << "it has not moved";
  EXPECT_NEAR(on.fromHome(), 0.0, 1e-4);
  EXPECT_EQ(behind.home(), kReached);
  EXPECT_NEAR(behind.turns() - behind.fromHome(), 0.25, 1e-4);
}

TEST(HomingRoute, FailsAtLimitsThatAreAnErrorWhereverItIsGoing) {
  const std::string away = "legs: \"+fast home on\"";
  Route passes(route(away), -2.5), fails(route(away + ", fails_at: [negative]"), -2.5);
  EXPECT_EQ(passes.home(), kReached);
  EXPECT_EQ(fails.home(), kError);
  EXPECT_NEAR(fails.turns(), -2.5, 0.1);
  Route other(route(away + ", fails_at: [positive]"), -2.5);
  EXPECT_EQ(other.home(), kReached);
}

TEST(HomingRoute, MindsNoLimitWhereItSaysSo) {
  Route b(route("legs: \"+fast home on\", passes_limits: true"), 2.0);
  EXPECT_EQ(b.home(2.0), 0) << "it searches on";
  EXPECT_GT(b.turns(), 3.5);
}

TEST(HomingRoute, EndsAtAHardStopWhichThePushingMotorDoesNotMove) {
  for (const int direction : {+1, -1}) {
    const std::string legs = direction > 0 ? "\"+fast stop\"" : "\"-fast stop\"";
    Route b(route("legs: " + legs + ", passes_limits: true"), 0.0);
    EXPECT_EQ(b.home(), kReached);
    const double stop = direction > 0 ? 5.0 : -4.0;
    EXPECT_NEAR(b.turns(), stop, 1e-3);
    EXPECT_NEAR(b.fromHome(), 0.0, 1e-3);
  }
}

TEST(HomingRoute, PushesAtAHardStopForAsLongAsItIsTold) {
  const std::string keys = "legs: \"+fast stop\", passes_limits: true";
  double seconds[2];
  for (const int i : {0, 1}) {
    Route b(route(keys), 4.9);
    b.set(kStopTime, i == 0 ? 100 : 600);
    const Time begun = b.now;
    EXPECT_EQ(b.home(), kReached);
    seconds[i] = toSeconds(b.now - begun);
  }
  EXPECT_NEAR(seconds[1] - seconds[0], 0.5, 0.01);
  Route never(route(keys), 4.9);
  never.set(kStopTorque, 4000);  // more than the motor has
  EXPECT_EQ(never.home(3.0), 0);
}

// v^2 / 2a: 50 mm-turns by 609Ah, a tenth by 6085h, which is ten times as steep here.
TEST(HomingRoute, BrakesAtLimitsByTheQuickStopRampWhereItSaysSo) {
  const std::string keys = route("legs: \"+fast home on\"");
  double beyond[2];
  for (const int i : {0, 1}) {
    Route b(keys + (i == 0 ? "" : ", stops_quickly_at_limits: true"), 2.0);
    EXPECT_EQ(b.home(), kError);
    beyond[i] = b.farthest - 3.0;
  }
  EXPECT_NEAR(beyond[0], 0.05, 0.01);
  EXPECT_NEAR(beyond[1], 0.005, 0.005);
}

TEST(HomingRoute, WantsEachOfItsSwitchesAtOneTerminal) {
  const std::string keys =
      route("legs: \"+fast home on\"") + ", terminals: {home_switch: 31, negative_limit: 15}";
  const std::pair<int, int> kWrong[] = {{0, 0}, {15, 0}, {31, 31}};
  for (const auto& [first, second] : kWrong) {
    Route b(keys, 0.0);
    b.set(kTerminal1, first);
    b.set(kTerminal2, second);
    b.control(0x001F);
    b.run(ms(500));
    EXPECT_EQ(b.read(0x603F), 0xFF20U) << first << " " << second;
    EXPECT_NEAR(b.turns(), 0.0, 1e-6);
  }
  Route right(keys, 0.0);
  right.set(kTerminal2, 31);
  EXPECT_EQ(right.home(), kReached) << "the limit switch is not one of its own";
}

TEST(HomingRoute, IsAFaultWhereItTakesTooLong) {
  Route late(route("legs: \"+slow home on\""), 0.0), in_time(route("legs: \"+slow home on\""), 0.0);
  late.set(kTimeLimit, 1000);  // ms; it takes 5 s
  late.control(0x001F);
  late.run(ms(990));
  EXPECT_EQ(late.read(0x603F), 0U);
  late.run(ms(30));
  EXPECT_EQ(late.read(0x603F), 0xFF25U);
  in_time.set(kTimeLimit, 6000);
  EXPECT_EQ(in_time.home(), kReached);
}

TEST(HomingRoute, IsRefusedInWordsWhereItsLegsAreNone) {
  const std::string path = cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml";
  for (const char* legs :
       {"\"+fast\"", "\"fast home on\"", "\"+fast home\"", "\"+fast home on now\""}) {
    const auto loaded = loadDriveDefinition(path, with(route("legs: " + std::string(legs))));
    ASSERT_FALSE(loaded.ok()) << legs;
    EXPECT_NE(loaded.error().message.find("must be legs like"), std::string::npos)
        << loaded.error().message;
  }
  EXPECT_FALSE(loadDriveDefinition(path, with(route("fails_at: [negative]"))).ok());
}

}  // namespace
}  // namespace cia402::sim
