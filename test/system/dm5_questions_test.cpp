// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Where the manual of the DM5 contradicts itself, the standard or other drives, or leaves it open:
// the simulated drive has each reading, and the driver lives with it. docs/drives/megmeet_dm5.md
// lists them.
#include "system/families_bus_scene.h"
#include "system/families_homing.h"
#include "system/families_motion.h"
#include "system/stations.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kAskedCsp{"megmeet_dm5", "8388608", "csp"},
    kAskedPv{"megmeet_dm5", "8388608", "pv"}, kAskedPt{"megmeet_dm5", "8388608", "pt"};

std::string askedReading(const std::string& with) { return ", simulation: {with: {" + with + "}}"; }

// --- What it has besides, or otherwise, than the manual's tables say
// ------------------------------

/// What the drive is like, and how many EMCYs a fault and its reset are.
struct Dm5Reading {
  const char *name, *with;
  std::size_t emergencies;
  const char* options = "";  ///< of the axis, that such a drive takes
};
void PrintTo(const Dm5Reading& tested, std::ostream* out) { *out << tested.name; }

class Dm5Reads : public testing::TestWithParam<Dm5Reading> {};

TEST_P(Dm5Reads, GoesAndTellsItsFaultsAllTheSame) {
  Scene scene(loadText(familyJoint(kAskedCsp, GetParam().options + askedReading(GetParam().with))));
  expectBootsAndGoes(scene);
  scene.inject("joint", "overcurrent");
  scene.run(300ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("fault 0xFF01 drive over-current"));
  EXPECT_EQ(scene.robot().emergencies().size(), GetParam().emergencies == 0 ? 0U : 1U);
  const bus::Answer cleared = scene.procedure(ProcedureKind::clear_faults);
  EXPECT_TRUE(cleared.success) << cleared.message << scene.told();
  scene.run(100ms);
  EXPECT_EQ(scene.robot().emergencies().size(), GetParam().emergencies);
  EXPECT_EQ(scene.axis("joint").faultText(), "");
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, -0.2);
}

INSTANTIATE_TEST_SUITE_P(
    Of, Dm5Reads,
    testing::Values(
        Dm5Reading{"NoEmcy", "dictionary: []", 0},  // [L1604-1606]
        Dm5Reading{"Emcy",
                   "dictionary: [[0x1014, 0, cob_id_emcy, uint32, rw, -, \"$NODEID+0x80\"]]", 2},
        Dm5Reading{"NoErrorRegister", "without: [0x1001]", 0},
        Dm5Reading{"ErrorCodeToRead", "dictionary: [[0x603F, 0, error_code, uint16, ro, t, 0]]", 0},
        Dm5Reading{"ErrorCodeToWrite", "dictionary: [[0x603F, 0, error_code, uint16, rw, t, 0]]",
                   0},
        Dm5Reading{"WhatOthersHave",  // [L3626-3683] has none of these
                   "dictionary: [[0x6502, 0, supported_drive_modes, uint32, ro, t, 0x3AD], "
                   "[0x605E, 0, fault_reaction_option, int16, rw, -, 0], "
                   "[0x6007, 0, abort_connection_option, int16, rw, -, 1], "
                   "[0x60C2, 1, interpolation_period, uint8, rw, -, 4], "
                   "[0x60C2, 2, interpolation_index, int8, rw, -, -3], "
                   "[0x60B0, 0, position_offset, int32, rw, r, 0], "
                   "[0x60B1, 0, velocity_offset, int32, rw, r, 0], "
                   "[0x60B2, 0, torque_offset, int16, rw, r, 0], "
                   "[0x608F, 1, encoder_increments, uint32, rw, -, 8388608], "
                   "[0x608F, 2, encoder_revolutions, uint32, rw, -, 1]]",
                   0},
        Dm5Reading{"SpeedsInCounts",  // which nothing of a motion depends on [L1978-1991]
                   "units_of: {velocity_demand: counts, velocity_window: counts, "
                   "velocity_threshold: counts}",
                   0},
        // Heartbeats and SYNC are assumed: nothing of CAN is printed.
        Dm5Reading{"NoHeartbeat", "without: [0x1016, 0x1017]", 0},
        Dm5Reading{"NotDrivenBySync",
                   "without: [0x1005, 0x1006], state_machine: {interpolates_over_sync_period: "
                   "false}",
                   0,
                   ", pdos: {rpdo1: {objects: [controlword, target_position], transmission: 255}, "
                   "tpdo1: {objects: [statusword, position_actual], transmission: 255, "
                   "event_timer: 0.004}}"}),
    [](const auto& tested) { return std::string(tested.param.name); });

// Its loss is told to be unseen, and so is that of the master to it.
TEST(Dm5Heartbeats, ThatTheDriveDoesNotHaveAreMissedInWords) {
  Scene scene(loadText(familyJoint(kAskedCsp, askedReading("without: [0x1016, 0x1017]"))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  EXPECT_THAT(scene.told(),
              AllOf(HasSubstr("cannot notice a dead master: writing 0x007F012C to 1016:01"),
                    HasSubstr("not supervised, its loss will go unnoticed: writing 0x0064 to "
                              "1017:00 producer heartbeat time")));
}

// --- Positions that wait in the drive: how many is assumed, and whether a new one replaces them
// ----------------------------------------------------------------------------------------------

TEST(Dm5Queues, OfAnyLengthAreComeToRestInTheirOrder) {
  for (const char* queue : {"queue: 1, replaces_queue: true", "queue: 4, replaces_queue: true",
                            "queue: 4, replaces_queue: false"}) {
    const FamilyMode queued{"megmeet_dm5", "8388608", "queued_position"};
    Stations scene(familyJoint(queued, askedReading("modes: {1: {behaviour: profile_position, " +
                                                    std::string(queue) + "}}")));
    scene.give({0.3, 0.1, 0.4, -0.2, 0.0});
    EXPECT_THAT(scene.visit(9s), testing::ElementsAre(0, 30, 10, 40, -20, 0)) << queue;
    EXPECT_NEAR(scene.position("joint"), 0.0, Stations::kOneStep);
    scene.give({1.0, 0.2});
    scene.run(700ms);
    scene.mustSucceed(ProcedureKind::halt);
    const double held = scene.position("joint");
    EXPECT_LT(held, 0.9) << queue;
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(2s);
    EXPECT_NEAR(scene.position("joint"), held, Stations::kOneStep) << "nothing goes on: " << queue;
  }
}

// A drive whose queue is full and is not replaced by bit 5 either: what waits there would be gone
// to once the halt ends, so that the axis is switched off. Enabling it anew empties its queue.
TEST(Dm5Queues, ThatAreNotReplacedMoveNothingAfterAHalt) {
  const FamilyMode queued{"megmeet_dm5", "8388608", "queued_position"};
  Stations scene(familyJoint(
      queued, askedReading("modes: {1: {behaviour: profile_position, queue: 1, replaces_queue: "
                           "false}}")));
  scene.give({1.0, 0.2});
  scene.run(700ms);
  scene.mustSucceed(ProcedureKind::halt);
  const double held = scene.position("joint");
  EXPECT_LT(held, 0.9);
  const bus::Answer early = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(early.success) << early.message;
  scene.run(4s);
  EXPECT_THAT(scene.told(), HasSubstr("did not take the place where it stands"));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_NEAR(scene.position("joint"), held, Stations::kOneStep);
  scene.mustSucceed(ProcedureKind::enable);
  scene.expectStands(2s);
  scene.give({held + 0.2});
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), held + 0.2, Stations::kOneStep) << scene.told();
}

// --- P02.00: 0 from the factory; which number CANopen has is a guess [L529, L3156]
// ----------------

// A drive that is switched on with another number in it is deaf and mute.
TEST(Dm5ControlModes, OfTheFactoryMayLeaveTheBusMute) {
  for (const unsigned mode : {0U, 7U}) {
    Scene scene(loadText(familyJoint(
        kAskedCsp, askedReading("memory: {silent_unless: {\"2002:01\": 7}}, dictionary: [[0x2002, "
                                "1, control_mode, uint16, rw, -, " +
                                std::to_string(mode) + ", 0, 10]]"))));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.inject("joint", "power_cycle");
    scene.run(6s);
    EXPECT_EQ(scene.state("joint").health == fieldbus::Health::ready, mode == 7) << scene.told();
    const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
    EXPECT_EQ(enabled.success, mode == 7) << enabled.message;
    if (mode == 7) expectGoes(scene, 0.2);
  }
}

// --- Bit 10 of torque modes: a threshold of the maker's [L2130], or the standard's
// ----------------

TEST(Dm5TorqueReached, IsNotLookedAtWhateverItMeans) {
  for (const bool standard : {false, true}) {
    const std::string none =  // an object that it does not have
        "objects: {torque_reached_base: \"2007:7E\", torque_reached_on: \"2007:7D\", "
        "torque_reached_off: \"2007:7C\"}";
    FamilyScene scene(familyJoint(kAskedPt, standard ? askedReading(none) : std::string()));
    scene.inject("joint", "blocked_rotor");
    scene.stream("joint", 6.0, 400ms);  // 94 / 1000 of the rated torque
    EXPECT_EQ((scene.truth("joint").statusword & 0x0400) != 0, standard);
    EXPECT_EQ(scene.number(0x6077), 94U);
    EXPECT_NEAR(scene.state("joint").effort, 6.0, 0.1);
    EXPECT_EQ(scene.state("joint").error_code, 0) << scene.told();
  }
}

// --- 6099h: rpm [L2174-2175] or units/s [L2157]
// ---------------------------------------------------

constexpr char kHomingInCounts[] =
    "with: {units_of: {homing_search_speed: counts, homing_zero_speed: counts}}, ";
/// counts/s of a motor that turns by 1 rpm
constexpr double kCountsOfRpm = 8388608.0 / 60.0;

std::string lookingForALimit(double factor, const std::string& with) {
  return familyJoint(kAskedCsp,
                     ", write: [{object: di1_function, raw: 36}], homing: {method: 17, offset: "
                     "0.25, search_velocity: " +
                         std::to_string(0.4 * factor) +
                         ", zero_velocity: " + std::to_string(0.1 * factor) +
                         ", acceleration: 4.0, timeout: 5.0}, simulation: {" + with +
                         "initial_position: 0.1, lower_limit_switch: -0.4}");
}

TEST(Dm5HomingSpeeds, AreRpmOrCountsAsTheFileHasThem) {
  for (const bool counts : {false, true}) {
    Scene scene(loadText(
        lookingForALimit(counts ? kCountsOfRpm : 1.0, counts ? kHomingInCounts : std::string())));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.forget();
    const bus::Answer homed = scene.procedure(ProcedureKind::home);
    ASSERT_TRUE(homed.success) << homed.message << scene.told();
    EXPECT_NEAR(scene.seen("joint").fastest, 0.4, 0.01);
    EXPECT_NEAR(scene.state("joint").position - 0.25, scene.position("joint") + 0.4, 1e-5);
  }
}

// The wrong guess creeps until the drive ends the search.
TEST(Dm5HomingSpeeds, OfTheOtherReadingEndWithTheTimeOfTheSearch) {
  Scene scene(loadText(lookingForALimit(1.0, kHomingInCounts)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.forget();
  EXPECT_FALSE(scene.procedure(ProcedureKind::home).success);
  scene.run(200ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-3);
  EXPECT_THAT(scene.axis("joint").faultText(), AllOf(HasSubstr("0xFF25"), HasSubstr("Er.037")));
}

// --- Methods 7, 10, 11, 14: printed without the leg that leaves the switch [L2329-2441]
// -----------

constexpr char kAskedTerminals[] =
    ", write: [{object: di1_function, raw: 36}, {object: di2_function, raw: 35}, {object: "
    "di3_function, raw: 32}, {object: di4_function, raw: 0}]";
/// As the figures of CiA 402-2 have them.
constexpr char kStandardRoutes[] =
    "index_offset: 0.3, with: {homing: {routes: {"
    "7: {legs: \"+fast home on, -slow home off, -slow index\", begun_on: \"-slow home off, -slow "
    "index\", from_limit: \"-fast home on, -slow home off, -slow index\"}, "
    "10: {legs: \"+fast home on, +slow home off, +slow index\", begun_on: \"+slow home off, +slow "
    "index\", from_limit: \"-fast home on, +slow home off, +slow index\"}, "
    "11: {legs: \"-fast home on, +slow home off, +slow index\", begun_on: \"+slow home off, +slow "
    "index\", from_limit: \"+fast home on, +slow home off, +slow index\"}, "
    "14: {legs: \"-fast home on, -slow home off, -slow index\", begun_on: \"-slow home off, -slow "
    "index\", from_limit: \"+fast home on, -slow home off, -slow index\"}}}}";

class Dm5StandardRoute : public testing::TestWithParam<FamilyHoming> {};

TEST_P(Dm5StandardRoute, LeavesTheSwitchBeforeItLooksForTheIndexPulse) {
  Scene scene(loadText(replaced(homingJoint(GetParam()), "index_offset: 0.3", kStandardRoutes)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const bus::Answer homed = scene.procedure(ProcedureKind::home);
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_NEAR(scene.state("joint").position - kReadAtHome,
              scene.position("joint") - GetParam().home.home * kTurnOfMotor, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(By, Dm5StandardRoute,
                         testing::ValuesIn(withFamily(kAskedCsp, kAskedTerminals,
                                                      homesOffTheSwitch())),
                         [](const auto& tested) {
                           return "Method" + std::to_string(tested.param.home.method) + "Case" +
                                  std::to_string(tested.index);
                         });

// --- P23.20 and P23.21: 30 % for 1 ms, which an acceleration is, too [L2683-2685]
// -----------------

/// 300 / 1000 of 50 * 1.27 N m; 64 rad/s^2 of the joint are 509 turns/s^2 of its motor, for which a
/// load takes 566 / 1000.
std::string lookingForAStop(const std::string& time, const std::string& with) {
  return familyJoint(kAskedCsp,
                     ", homing: {method: -2, offset: 0.25, search_velocity: 0.4, zero_velocity: "
                     "0.1, acceleration: 64.0, timeout: 20.0}, write: [{object: "
                     "hard_stop_torque, raw: 300}, {object: hard_stop_time, raw: " +
                         time + "}], simulation: {with: {motor: {rated_acceleration: 900.0}" +
                         with + "}, initial_position: 0.2, lower_stop: -0.3}");
}

TEST(Dm5StopsByTorque, MayBeAnAccelerationUnlessTheTimeIsLonger) {
  struct AskedStop {
    const char *time, *with;
    double home;
  };
  for (const AskedStop& stop : {AskedStop{"1", "", 0.2}, AskedStop{"50", "", -0.3},
                                AskedStop{"1", ", homing: {stops_by_torque: false}", -0.3}}) {
    Scene scene(loadText(lookingForAStop(stop.time, stop.with)));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    const bus::Answer homed = scene.procedure(ProcedureKind::home);
    ASSERT_TRUE(homed.success) << homed.message << scene.told();
    EXPECT_NEAR(scene.position("joint"), stop.home, 0.01) << stop.time << " ms " << stop.with;
  }
}

// --- 6060h while enabled: not printed
// -------------------------------------------------------------

TEST(Dm5ModeChanges, ThatTheDriveRefusesInOperationMoveNothing) {
  Scene scene(loadText(familyJointWith(
      kAskedPv, "[pv, csp]", askedReading("state_machine: {mode_change_while_enabled: false}"))));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  scene.forget();
  const bus::Answer refused = scene.procedure(ProcedureKind::set_mode, "joint", "csp");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("joint (node 1)"));
  scene.run(500ms);
  expectNothingMoved(scene, "joint");
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  const bus::Answer taken = scene.procedure(ProcedureKind::set_mode, "joint", "csp");
  EXPECT_TRUE(taken.success) << taken.message;
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, 0.2);
}

}  // namespace
}  // namespace cia402
