// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Where the manual of the Damiao is silent, or says two things, the driver works with a drive of
// each reading. What the joint does is read from the motor.
#include "system/damiao_scene.h"
#include "system/families_motion.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ControlKind;
using drive::ProcedureKind;

/// Another reading than that of config/simulated_drives/damiao_dm.yaml, and a mode that meets it.
struct Reading {
  const char* name;
  const char* mode;
  const char* drive;
  const char* bus = "";   ///< further keys of it
  const char* axis = "";  ///< and of the axis, as ", key: value"
};
void PrintTo(const Reading& reading, std::ostream* out) { *out << reading.name; }

class DamiaoReading : public testing::TestWithParam<Reading> {
 protected:
  static std::string yaml() {
    const std::string text = damiaoIn(GetParam().mode, GetParam().axis, GetParam().drive);
    return *GetParam().bus == '\0' ? text : withBus(GetParam().bus, text);
  }
  static void expectMoves(FamilyScene& scene) {
    if (scene.kind() == ControlKind::position) {
      ASSERT_EQ(scene.setpoint("joint", -0.4), "");
      scene.run(3s);
      EXPECT_NEAR(scene.position("joint"), -0.4, 1e-3) << scene.told();
    } else if (scene.kind() == ControlKind::velocity) {
      scene.stream("joint", -0.8, 600ms);
      EXPECT_NEAR(scene.velocity("joint"), -0.8, 0.01) << scene.told();
    } else {
      scene.stream("joint", -0.2, 200ms);
      EXPECT_LT(scene.velocity("joint"), -0.5) << scene.told();
    }
  }
};

TEST_P(DamiaoReading, IsOneThatTheDriverLivesWith) {
  FamilyScene scene(yaml());
  scene.expectStands(300ms);
  EXPECT_NEAR(scene.position("joint"), 1.1, 1e-4);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  expectMoves(scene);
  EXPECT_LT(scene.seen("joint").fastest, 2.0 * 1.02);
  if (scene.kind() == ControlKind::position) {
    ASSERT_EQ(scene.setpoint("joint", 1.0), "");
    scene.run(400ms);
  } else {
    scene.stream("joint", scene.kind() == ControlKind::velocity ? 0.8 : 0.2, 500ms);
  }
  const double speed = std::abs(scene.velocity("joint"));
  ASSERT_GT(speed, 0.3) << scene.told();
  const double from = scene.position("joint");
  const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 2e-3) << scene.told();
  EXPECT_LT(std::abs(scene.position("joint") - from), 0.03 * speed + speed * speed / 60.0 * 1.3);
  scene.mustSucceed(ProcedureKind::enable);
  scene.expectStands(200ms);
  scene.mustSucceed(ProcedureKind::disable);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(scene.badFloats(), 0U);
  EXPECT_EQ(scene.state("joint").error_code, 0) << scene.told();
}

constexpr char kStream[] = "cyclic_position", kSpeed[] = "velocity_torque",
               kThree[] = "position_velocity_torque", kTwo[] = "position_velocity",
               kOne[] = "profile_position", kTorque[] = "profile_torque";

INSTANTIATE_TEST_SUITE_P(
    Other, DamiaoReading,
    testing::Values(
        Reading{"DefaultsOfTheModeTables", kTwo,
                "dictionary: [[0x6083, 0, profile_acceleration, uint32, rw, rt, f20.0], "
                "[0x6084, 0, profile_deceleration, uint32, rw, rt, f20.0], "
                "[0x2005, 1, speed_kp, uint32, rw, -, f0.04], "
                "[0x2005, 2, speed_ki, uint32, rw, -, f0.04]]"},
        Reading{"WindowsThatAreWritten", kSpeed,
                "dictionary: [[0x606D, 0, velocity_window, uint32, rw, t, f0.5], "
                "[0x606E, 0, velocity_window_time, uint32, rw, t, f0.1], "
                "[0x606F, 0, velocity_threshold, uint32, rw, t, f0.01]]"},
        Reading{"MappingCountReadOnly", kThree, "communication: {map_count_read_only: true}"},
        Reading{"ShortAccessesTaken", kThree, "communication: {generic_length_abort: false}"},
        Reading{"PlainSyncTaken", kStream, "communication: {accepts_plain_sync: true}"},
        Reading{"PlainSyncOnTheBus", kStream, "communication: {accepts_plain_sync: true}",
                "sync_counter: 0"},
        Reading{"PlainSyncAfter1019hAlone", kStream, "communication: {}", "sync_counter: 0"},
        Reading{"Type255OnAChange", kStream, "communication: {type255_event_timer_only: false}"},
        Reading{"QuickStopOption0Brakes", kSpeed,
                "state_machine: {quick_stop: {default: 0, values: {0: {ramp: quick_stop}, "
                "1: {ramp: slow_down}, 2: {ramp: quick_stop}, 3: {ramp: slow_down, hold: true}, "
                "4: {ramp: quick_stop, hold: true}}}}"},
        Reading{"DirectEnable", kThree, "state_machine: {direct_enable: true}"},
        Reading{"EnabledInThreeStepsOnly", kThree, "state_machine: {enable_in_one_step: false}"},
        Reading{"DisablingBrakes", kSpeed,
                "state_machine: {shutdown: {default: 0, values: {0: {ramp: slow_down}}}, "
                "disable_operation: {default: 0, values: {0: {ramp: slow_down}}}}"},
        Reading{"FaultsCoast", kSpeed,
                "state_machine: {fault_reaction: {default: 0, values: {0: {ramp: coast}}}}"},
        Reading{"NothingLockedWhileEnabled", kThree, "state_machine: {locked_while_enabled: []}"},
        Reading{"ModesWhileEnabled", kSpeed, "state_machine: {mode_change_while_enabled: true}"},
        Reading{"SpeedOfMode2By6081h", kTwo,
                "modes: {2: {behaviour: profile_position, handshake: false, bit_12: zero_speed, "
                "bit_13: none, velocity: profile_velocity}}"},
        Reading{"SpeedOfMode3By6081h", kThree,
                "modes: {3: {behaviour: profile_position, handshake: false, bit_12: zero_speed, "
                "bit_13: none, velocity: profile_velocity, torque: target_torque}}"},
        Reading{"TorqueOfMode3By6072hAlone", kThree,
                "modes: {3: {behaviour: profile_position, handshake: false, bit_12: zero_speed, "
                "bit_13: none, velocity: target_velocity}}"},
        Reading{"SpeedOfMode6By6080hAlone", kTorque,
                "modes: {6: {behaviour: profile_torque, velocity: none}}"},
        Reading{"NoTargetReachedInMode1", kOne,
                "modes: {1: {behaviour: profile_position, handshake: false, bit_12: none, bit_13: "
                "none, velocity: none, target_reached: false}}"},
        Reading{"FollowingErrorsAreNoFaults", kStream,
                "state_machine: {following_error_is_fault: false}"},
        Reading{"NoFloatsAreTraps", kStream,
                "float_traps: {non_finite: false, negative_zero: false}"},
        Reading{"WarningsGoOn", kSpeed, "state_machine: {warning_stops: false}"},
        // rad of the rotor, ten to one [L1064]: the axis says so, and has the gear.
        Reading{"RadiansOfTheRotor", kThree, "encoder: absolute", "",
                ", output_shaft: false, gear_ratio: 10.0"},
        Reading{"RadiansOfTheRotorInAStream", kStream, "encoder: absolute", "",
                ", output_shaft: false, gear_ratio: 10.0"},
        Reading{"RadiansOfTheRotorAsASpeed", kSpeed, "encoder: absolute", "",
                ", output_shaft: false, gear_ratio: 10.0"},
        Reading{"ResumesWhileItMoves", kSpeed,
                "state_machine: {resume_quick_stop_while_moving: true}"},
        Reading{
            "CountsThatAreTrue", kStream,
            "dictionary: [[0x2002, 0, count, uint8, ro, -, 14], [0x1029, 0, count, uint8, ro, "
            "-, 2], [0x200A, 0, count, uint8, ro, -, 4], [0x2003, 0, count, uint8, ro, -, 3]]"}),
    [](const auto& tested) { return std::string(tested.param.name); });

// The drive's own numbers: ten radians of the rotor to one of the joint.
TEST(DamiaoRotor, CountsTenToOneWhereTheAxisSaysSo) {
  for (const bool rotor : {false, true}) {
    FamilyScene scene(
        damiaoIn(kOne, rotor ? ", output_shaft: false, gear_ratio: 10.0" : std::string()));
    EXPECT_NEAR(floatIn(scene, 0x6064), rotor ? 11.0 : 1.1, 1e-4);
    ASSERT_EQ(scene.setpoint("joint", 0.5), "");
    scene.run(2s);
    EXPECT_NEAR(floatIn(scene, 0x607A), rotor ? 5.0 : 0.5, 1e-4);
    EXPECT_NEAR(floatIn(scene, 0x6083), rotor ? 150.0 : 15.0, 1e-3);
    EXPECT_NEAR(scene.position("joint"), 0.5, 1e-3);
  }
}

/// What a drive does whose master has fallen silent, where it does not follow 1029h:01 alone.
class DamiaoMasterLost : public testing::TestWithParam<const char*> {};

TEST_P(DamiaoMasterLost, EndsAtRest) {
  FamilyScene scene(damiaoIn("profile_velocity", "",
                             std::string("state_machine: {master_lost: ") + GetParam() + "}"));
  scene.stream("joint", 0.8, 500ms);
  loseFrames(scene, 0x77F);
  for (std::uint32_t pdo : {0x204U, 0x304U, 0x404U, 0x504U}) loseFrames(scene, pdo);
  scene.run(2s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << scene.told();
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

INSTANTIATE_TEST_SUITE_P(All, DamiaoMasterLost,
                         testing::Values("none", "fault", "disable_voltage", "quick_stop"),
                         [](const auto& tested) { return std::string(tested.param); });

// Options 3 and 4 whose end is transition 12 after all: it is off then, and the driver says so.
TEST(DamiaoQuickStop, ThatIsToHoldButEndsByItselfIsTold) {
  FamilyScene scene(damiaoIn(
      "position_velocity", ", quick_stop: hold",
      "state_machine: {quick_stop: {default: 0, values: {0: {ramp: coast}, 1: {ramp: slow_down}, "
      "2: {ramp: quick_stop}, 3: {ramp: slow_down}, 4: {ramp: quick_stop}}}}"));
  ASSERT_EQ(scene.setpoint("joint", -0.9), "");
  scene.run(500ms);
  const bus::Answer stopped = scene.procedure(ProcedureKind::quick_stop);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(scene.state("joint").state, drive::State::switch_on_disabled);
  EXPECT_EQ(stopped.message.find("holds its position"), std::string::npos) << stopped.message;
  scene.mustSucceed(ProcedureKind::enable);
  scene.expectStands(300ms);
}

}  // namespace
}  // namespace cia402
