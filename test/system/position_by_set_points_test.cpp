// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive without a mode for a stream of positions, led along one by set-points of its profile
// position mode. What the joint does is read from the motor, what the drive is told from its
// objects and from the bus.
#include "system/field_profile.h"
#include "system/followed_path.h"
#include "system/id286_scene.h"
#include "system/late_joint.h"
#include "system/traced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

constexpr FamilyMode kBySets{kId286Cnfa, "10000", "position_by_set_points"};
constexpr double kSetsRamp = 4.0;  // limits/acceleration, rad/s^2
/// What a set-point is ahead of its stream: it lasts until the next one is taken, 12 ms later, and
/// for four cycles more.
constexpr double kSetsAhead = 0.024;

TEST(PositionBySetPoints, HoldsTheJointWhereItsSetPointIsAndHandsNothingOver) {
  FamilyScene scene(familyJoint(kBySets));
  ASSERT_TRUE(scene.move({0.4}, 2s).success);
  scene.run(3s);
  scene.forget();
  std::vector<std::uint64_t> words;
  scene.watch([&] { appendChange(words, scene.number(0x6040)); });
  scene.run(10s);
  scene.watch({});
  EXPECT_LT(scene.seen("joint").travel(), 1e-6) << "it hunts for its place";
  EXPECT_NEAR(scene.position("joint"), 0.4, oneCount(kBySets));
  EXPECT_THAT(words, testing::ElementsAre(0x0F));
}

/// Each place that the drive was told is taken with a speed, and ahead of the motor.
TEST(PositionBySetPoints, CarriesASpeedWithEachAndNeverLeadsBeyondTheLast) {
  FamilyScene scene(familyJoint(kBySets));
  const double count = oneCount(kBySets);
  double furthest = 0.0;
  std::uint64_t fastest = 0, slowest = 1u << 30;
  std::vector<std::uint64_t> speeds;
  scene.watch([&] {
    const double target = count * static_cast<std::int32_t>(scene.number(0x607A));
    furthest = std::max(furthest, target);
    fastest = std::max(fastest, scene.number(0x6081));
    slowest = std::min(slowest, scene.number(0x6081));
    appendChange(speeds, scene.number(0x6081));
  });
  ASSERT_TRUE(scene.move({1.0}, 2s).success);  // at up to 0.75 rad/s, braked by 1.5 rad/s^2
  scene.run(3s);
  scene.watch({});
  EXPECT_NEAR(scene.position("joint"), 1.0, count);
  EXPECT_LT(furthest, 1.0 + 1.5 * count);
  EXPECT_LT(scene.seen("joint").highest, 1.0 + 1.5 * count) << "the motor went beyond the last";
  EXPECT_GT(slowest, 0u) << "a speed of 0 is none for the drive";
  EXPECT_LE(static_cast<double>(fastest) * count, 0.8 * 1.001) << "limits/velocity";
  EXPECT_GT(speeds.size(), 20u) << "the speed follows that of the stream";
}

/// A set-point is taken each 30 ms then: the motor is no more than that and two cycles behind.
TEST(PositionBySetPoints, FollowsAtASyncPeriodAsLongAsItsInterval) {
  FamilyScene scene(replaced(familyJoint(kBySets), "sync_period: 0.004", "sync_period: 0.01"));
  ASSERT_TRUE(scene.move({1.0}, 2s).success);  // at up to 0.75 rad/s
  scene.run(1s);
  EXPECT_NEAR(scene.position("joint"), 0.5, 0.75 * 0.06) << "half of the way";
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 1.0, oneCount(kBySets));
}

TEST(PositionBySetPoints, TurnsRoundWhenItIsCommandedBack) {
  FamilyScene scene(familyJoint(kBySets));
  ASSERT_EQ(scene.setpoint("joint", 1.2), "");
  scene.run(1s);
  const double from = scene.position("joint"), fast = scene.velocity("joint");
  ASSERT_GT(fast, 0.5);
  scene.forget();
  ASSERT_EQ(scene.setpoint("joint", 0.1), "");
  scene.run(5s);
  EXPECT_NEAR(scene.position("joint"), 0.1, oneCount(kBySets));
  EXPECT_GT(scene.seen("joint").lowest, 0.1 - 1.5 * oneCount(kBySets));
  // By the limits of acceleration and jerk (40 rad/s^3), once the set-point has come.
  EXPECT_LT(scene.seen("joint").highest - from,
            fast * (kSetsAhead + kSetsRamp / (2.0 * 40.0)) + fast * fast / (2.0 * kSetsRamp));
}

/// A path that brakes all at once, and as hard as the limit allows: nobody hears of that before.
/// Nothing turns back by more than 0.5 mrad, as after any stop.
TEST(PositionBySetPoints, StopsWithAStreamThatBrakesAllAtOnce) {
  for (const double speed : {0.05, 0.1, 0.2, 0.4, 0.8}) {
    SCOPED_TRACE(speed);
    FamilyScene scene(familyJoint(kBySets));
    const double ramp = speed / kSetsRamp, goal = speed;  // rad, in 1 s and a ramp
    bus::TrajectoryCommand trajectory;
    trajectory.group = scene.loaded().robot.groups[0].name;
    trajectory.joints = scene.loaded().robot.groups[0].joints;
    trajectory.points = {{{0.5 * speed * ramp}, {speed}, {}, fromSeconds(ramp)},
                         {{goal - 0.5 * speed * ramp}, {speed}, {}, fromSeconds(1.0)},
                         {{goal}, {0.0}, {}, fromSeconds(1.0 + ramp)}};
    ASSERT_TRUE(scene.call(std::move(trajectory)).success) << scene.told();
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), goal, oneCount(kBySets));
    EXPECT_LT(scene.seen("joint").highest - goal, 5e-4) << "it overshoots and comes back";
    EXPECT_LT(scene.seen("joint").fastest, 0.8 * 1.02);
  }
}

/// The drive is behind the stream: it speeds up still when that has been stopped, and has where it
/// ends to go to. That it goes slowly until then is no rest.
TEST(PositionBySetPoints, StandsForGoodWhenItsGroupIsSaidToStand) {
  for (int after = 10; after <= 200; after += 10) {
    SCOPED_TRACE(after);
    FamilyScene scene(
        replaced(replaced(familyJoint(kBySets), "sync_period: 0.004", "sync_period: 0.01"),
                 "acceleration: 4.0", "acceleration: 0.75"));
    ASSERT_TRUE(scene.move({0.03}, 700ms).success);
    scene.run(std::chrono::milliseconds(after));
    bool ended = false;
    bus::TrajectoryCommand stop;
    stop.group = scene.loaded().robot.groups[0].name;
    stop.ended = [&](const bus::TrajectoryOutcome& outcome) {
      ended = true;
      EXPECT_THAT(outcome.message, HasSubstr("stands"));
    };
    ASSERT_TRUE(scene.call(stop).success);
    ASSERT_TRUE(scene.runUntil([&] { return ended; }, 2s)) << scene.told();
    scene.forget();
    scene.run(1s);
    EXPECT_LT(scene.seen("joint").fastest, 0.01) << "stopped_velocity_tolerance";
  }
}

// Each word in a SYNC period of its own, as for any set-point of the drive.
TEST(PositionBySetPoints, AreHandedOverByTheWordsOfTheManual) {
  TracedScene scene(familyJoint(kBySets));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.clear();
  ASSERT_TRUE(scene.move({0.4}, 2s).success);
  scene.run(1s);
  std::string words, last;  // in each SYNC period the last one
  for (const std::string& line : scene.lines) {
    if (line.compare(0, 3, "080") == 0 && !last.empty()) words += last + " ";
    if (line.compare(0, 4, "201 ") == 0) last = line.substr(4, 2);
  }
  EXPECT_THAT(words, HasSubstr("0F 2F 3F 0F 2F 3F 0F 2F 3F 0F 2F 3F 0F")) << "each 12 ms";
  for (const char* wrong : {"0F 3F", "2F 0F", "3F 2F", "2F 2F", "3F 3F"}) {
    EXPECT_THAT(words, testing::Not(HasSubstr(wrong)));
  }
}

/// Of any frames that get lost on their way to the drive.
TEST(PositionBySetPoints, ThatGetLostAreMadeGood) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Scene scene(loadText(familyJoint(kBySets)), seed);
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    for (const std::uint32_t rpdo : {0x201u, 0x301u, 0x401u, 0x501u}) {
      sim::FaultRule rule;
      rule.id = rpdo;
      rule.count = 1;
      scene.world().bus().faults().add(rule);
    }
    sim::FaultRates rates;
    rates.loss = 0.01;
    scene.world().bus().faults().setRates(rates);
    ASSERT_TRUE(scene.move({0.5}, 2s).success);
    scene.run(3s);
    scene.world().bus().faults().setRates({});
    scene.run(500ms);
    EXPECT_NEAR(scene.position("joint"), 0.5, oneCount(kBySets)) << scene.told();
    EXPECT_LT(scene.seen("joint").highest, 0.5 + 1.5 * oneCount(kBySets));
  }
}

/// An axis with both ways to follow a trajectory is brought from one to the other by a call.
TEST(PositionBySetPoints, AreChosenByACallBesideVelocities) {
  FamilyScene scene(familyJointWith(kBySets, "[position_by_set_points, position_by_velocity]"));
  const double count = oneCount(kBySets);
  double goal = 0.3;
  for (const char* mode : {"position_by_velocity", "position_by_set_points"}) {
    scene.mustSucceed(ProcedureKind::set_mode, mode);
    scene.expectStands(300ms);
    ASSERT_TRUE(scene.move({goal}, 1500ms).success) << scene.told();
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), goal, count) << mode;
    EXPECT_EQ(scene.number(0x6061), std::string(mode) == kBySets.mode ? 1u : 3u);
    goal = -0.2;
  }
}

class LatePositionBySetPoints : public LateJoint {
 protected:
  LatePositionBySetPoints() : LateJoint(kBySets) {}
  /// How far it may go on: to the place that the drive has, or to the one that it takes with the
  /// next SYNC.
  static double furthest(double fast) {
    return fast * (kSetsAhead + 0.02) + fast * fast / (2.0 * kSetsRamp);
  }
};

TEST_F(LatePositionBySetPoints, ComesToRestAtTheLastOneThatTheDriveHas) {
  for (const Duration delay : {Duration(12ms), Duration(40ms), Duration(200ms), Duration(600ms)}) {
    for (const Duration phase : {Duration(0ms), Duration(4ms), Duration(9ms), Duration(14ms)}) {
      SCOPED_TRACE(std::to_string(toSeconds(delay)) + " " + std::to_string(toSeconds(phase)));
      ASSERT_NO_FATAL_FAILURE(begin());
      scene->run(phase);
      scene->forgetTold();
      const double before = place(), fast = speed();
      scene->stall(delay);
      const double after = place();
      EXPECT_LT(backwards(2s), 5e-3);
      EXPECT_NEAR(speed(), 0.0, 1e-4);
      EXPECT_LT(place() - before, 1.02 * furthest(fast));
      if (delay >= 600ms) {
        EXPECT_LT(place() - after, fast * 0.02) << "it set off once more";
      }
      expectGivenUp();
    }
  }
}

TEST_F(LatePositionBySetPoints, StandsStillThroughADelayAtRest) {
  ASSERT_NO_FATAL_FAILURE(begin());
  expectStandsThroughADelay();
}

TEST_F(LatePositionBySetPoints, ComesToRestByItselfWhenTheDriverDies) {
  ASSERT_NO_FATAL_FAILURE(begin());
  const double before = place(), fast = speed();
  scene->stall(1s);
  EXPECT_NEAR(speed(), 0.0, 1e-4) << "nobody tells the drive anything";
  EXPECT_GT(place() - before, 0.05) << "it went on to its last set-point";
  EXPECT_LT(place() - before, 1.02 * furthest(fast));
  const double rests = place();
  scene->stall(1s);
  EXPECT_NEAR(place(), rests, 1e-6);
}

class SetPointsOfId286 : public testing::TestWithParam<int> {};

/// Whichever edge brings a set-point, and whether bit 12 falls or not.
TEST_P(SetPointsOfId286, LeadTheMotorAlongATrajectory) {
  const std::string bit = std::to_string(GetParam() / 2),
                    twelve = GetParam() % 2 ? "acknowledge" : "started";
  FamilyScene scene(
      familyJoint(kBySets,
                  ", simulation: {with: {modes: {1: {behaviour: profile_position, bit_8: stopped, "
                  "bit_13: none, before_start: [15], set_point_bit: " +
                      bit + ", bit_12: " + twelve + "}}}}"));
  EXPECT_LT(worstOffSinePath(scene, "joint"), 6e-3) << scene.told();
}

INSTANTIATE_TEST_SUITE_P(By, SetPointsOfId286, testing::Values(8, 9, 10, 11),
                         [](const auto& tested) {
                           return "Bit" + std::to_string(tested.param / 2) +
                                  (tested.param % 2 ? "ThatIsAcknowledged" : "WithABit12ThatStays");
                         });

/// A generic drive whose profile has such a mode. @param deceleration of the stream, as a key
std::string ledGeneric(const std::string& deceleration) {
  std::string profile =
      replaced(genericProfileText(), "6084:00\", type: uint32, quantity: acceleration",
               "6084:00\", type: uint32, quantity: acceleration, pdo: rpdo");
  profile.insert(profile.find("  profile_velocity:\n    value: 3"),
                 "  led_by_set_points:\n"
                 "    value: 1\n"
                 "    control: position\n"
                 "    cyclic: true\n"
                 "    set_point_stream: {speed: profile_velocity" +
                     deceleration +
                     "}\n"
                     "    target: target_position\n"
                     "    handshake: {words: [0x0020, 0x0030], each_for: 1}\n"
                     "    status_bits: {target_reached: 10, set_point_acknowledge: 12}\n"
                     "    entry_writes:\n"
                     "      - {object: profile_acceleration, from: limits.acceleration}\n");
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "axes:\n  joint: {node_id: 1, drive: " +
         writeProfile(profile) +
         ", counts_per_turn: 131072, gear_ratio: 100.0,\n"
         "    rated_torque: 0.64, mode: led_by_set_points, modes: [led_by_set_points],\n"
         "    simulation: {drive: generic_cia402},\n"
         "    limits: {lower: -2.5, upper: 2.5, velocity: 0.8, acceleration: 4.0, jerk: 40.0}}\n";
}

/// Any drive with a profile position mode has it by its profile: here the generic one, whose
/// acknowledge rises and falls with each. Without a deceleration it stays behind by all of its
/// reaction, of seven cycles until the next set-point and two for that to be taken.
TEST(SetPointsOfAnyDrive, LeadItAlongATrajectoryWhereItsProfileHasThem) {
  for (const bool braked : {true, false}) {
    FamilyScene scene(ledGeneric(braked ? ", deceleration: profile_deceleration" : ""));
    const double worst = worstOffSinePath(scene, "joint");
    RecordProperty(braked ? "worst_rad" : "worst_without_rad", std::to_string(worst));
    EXPECT_LT(worst, braked ? 8e-3 : 8e-3 + 0.785 * 9 * 0.004) << scene.told();
    scene.forget();
    scene.run(2s);
    EXPECT_LT(scene.seen("joint").travel(), 1e-6);
  }
}

}  // namespace
}  // namespace cia402
