// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Positions that a NiMotion goes to one after the other, distances, and rounded corners: by its
// motor.
#include "system/motion_watch.h"
#include "system/stations.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kOneStep = Stations::kOneStep;

std::string nimotionBy(const char* mode, const std::string& more = {}) {
  return familyJoint(nimotionIn(mode), more);
}

TEST(NimotionQueue, ComesToRestAtEachPositionInTheirOrder) {
  Stations scene(nimotionBy("queued_position"));
  const auto told = scene.axis("joint").noticeCount();
  scene.give({0.3, 0.1, 0.4, -0.2, 0.0, 0.2, 0.1, 0.3});  // more than the drive's five
  EXPECT_THAT(scene.visit(12s), ElementsAre(0, 30, 10, 40, -20, 0, 20, 10, 30)) << scene.told();
  EXPECT_NEAR(scene.position("joint"), 0.3, kOneStep);
  EXPECT_TRUE(scene.state("joint").target_reached);
  EXPECT_EQ(scene.axis("joint").noticeCount(), told) << scene.told();
}

TEST(NimotionQueue, IsFullWithFiveAndTellsSoByBit12) {
  Stations scene(nimotionBy("queued_position"));
  scene.give({1.0, 0.1, 0.2, 0.3, 0.4});  // one at work, four wait
  scene.run(300ms);
  EXPECT_FALSE(scene.bit(12));
  scene.give({0.5});
  scene.run(300ms);
  EXPECT_TRUE(scene.bit(12));
  scene.give({0.6});  // which waits for room
  scene.run(900ms);
  EXPECT_TRUE(scene.bit(12));
  ASSERT_TRUE(scene.runUntil([&] { return scene.position("joint") < 0.9; }, 3s));
  scene.run(8s);
  EXPECT_NEAR(scene.position("joint"), 0.6, kOneStep) << scene.told();
}

TEST(NimotionQueue, RefusesInWordsWhatNobodyHasRoomFor) {
  Stations scene(nimotionBy("queued_position"));
  for (int i = 0; i < 16; ++i) ASSERT_EQ(scene.setpoint("joint", 0.1 * (i % 2 + 1)), "") << i;
  EXPECT_THAT(scene.setpoint("joint", 0.5),
              AllOf(HasSubstr("joint"), HasSubstr("16 wait for those before already")));
}

TEST(NimotionQueue, IsEmptiedByAHaltThatHolds) {
  for (const int waiting : {2, 7}) {
    Stations scene(nimotionBy("queued_position"));
    scene.give({1.0, 0.0});
    for (int i = 2; i < waiting; ++i) scene.give({0.1 * i});
    scene.run(700ms);
    EXPECT_GT(scene.velocity("joint"), 0.3);
    scene.mustSucceed(ProcedureKind::halt);
    const double held = scene.position("joint");
    EXPECT_LT(held, 0.9);
    scene.expectStands(1s);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(2s);
    scene.give({held + 0.2});
    scene.run(2s);
    EXPECT_NEAR(scene.position("joint"), held + 0.2, kOneStep) << scene.told();
  }
}

// A motor that is held, then let go: its goals are given up, those that wait in the drive, too.
TEST(NimotionQueue, IsEmptiedWhereTheMotorIsHeldAndDoesNotGoOnLater) {
  Stations scene(nimotionBy("queued_position"));
  scene.give({1.0, 0.0, 0.2, 0.4, 0.6, 0.8, 1.0});
  scene.run(300ms);
  scene.inject("joint", "blocked_rotor");
  scene.run(800ms);  // in which the drive's own set-points are still on their way to the first
  EXPECT_THAT(scene.told(), HasSubstr("what was commanded is given up")) << scene.told();
  const double held = scene.position("joint");
  EXPECT_LT(std::fabs(held - 0.1), 0.1) << "near where it was held";
  scene.inject("joint", "clear");
  scene.expectStands(3s, 2e-3);
  EXPECT_FALSE(scene.bit(12));
  scene.give({0.5});
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.5, kOneStep) << scene.told();
}

TEST(NimotionQueue, IsForgottenByAnAxisThatIsSwitchedOff) {
  for (const auto kind : {ProcedureKind::quick_stop, ProcedureKind::disable}) {
    Stations scene(nimotionBy("queued_position"));
    scene.give({0.6, 0.0, 0.3, 0.5, 0.2, 0.1, 0.4});
    scene.run(500ms);
    scene.mustSucceed(kind);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(2s);
    scene.give({0.2});
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.2, kOneStep) << scene.told();
  }
}

class NimotionDistance : public testing::TestWithParam<const char*> {};

TEST_P(NimotionDistance, IsGoneFromTheTargetBeforeOrFromWhereTheAxisStands) {
  expectDistancesAreGone(nimotionBy(GetParam()));
}

TEST_P(NimotionDistance, AddsUpWhereTheyAreGivenWithoutAPause) {
  expectDistancesAddUp(nimotionBy(GetParam()));
}

TEST_P(NimotionDistance, CountsFromWhereItStandsAfterAStop) {
  expectDistancesCountFromAStop(nimotionBy(GetParam()));
}

TEST_P(NimotionDistance, LeadsNoFurtherThanTheLimitsOfTheJoint) {
  expectDistancesEndAtTheLimit(nimotionBy(GetParam(), ", simulation: {initial_position: 2.2}"));
}

INSTANTIATE_TEST_SUITE_P(Nimotion, NimotionDistance,
                         testing::Values("relative_position", "queued_relative_position",
                                         "relative_to_demand", "relative_to_position"),
                         [](const auto& tested) { return std::string(tested.param); });

// Bits 5 and 6 of the controlword [924-936], and 60F2h [2758-2763].
TEST(NimotionPositions, AreHandedOverByTheWordsOfTheManual) {
  struct Row {
    const char* mode;
    unsigned word, option;
  };
  for (const Row& row :
       {Row{"pp", 0x3F, 0}, Row{"queued_position", 0x1F, 0}, Row{"relative_position", 0x7F, 0},
        Row{"queued_relative_position", 0x5F, 0}, Row{"relative_to_demand", 0x7F, 1},
        Row{"relative_to_position", 0x7F, 2}}) {
    Stations scene(nimotionBy(row.mode));
    std::vector<unsigned> words;
    scene.watch([&] {
      const auto word = static_cast<unsigned>(scene.number(0x6040));
      if ((word & 0x10u) != 0 && (words.empty() || words.back() != word)) words.push_back(word);
    });
    scene.give({0.2});
    scene.run(2s);
    ASSERT_FALSE(words.empty()) << row.mode;
    EXPECT_EQ(words.back(), row.word) << row.mode;
    EXPECT_EQ(scene.number(0x60F2), row.option) << row.mode;
    EXPECT_NEAR(scene.position("joint"), 0.2, kOneStep) << row.mode;
  }
}

/// The greatest change of acceleration of the joint over 20 ms, rad/s^3.
double jerkOn(const std::string& more, double goal) {
  Stations scene(
      replaced(nimotionBy("pp", more), "acceleration: 4.0", "acceleration: 4.0, jerk: 40"));
  std::vector<double> speeds;
  scene.watch([&] { speeds.push_back(scene.velocity("joint")); });
  scene.give({goal});
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), goal, kOneStep) << scene.told();
  EXPECT_LT(scene.seen("joint").fastest, 0.8 * 1.02);
  return greatestJerk(speeds);
}

// 40 rad/s^3 of familyJoint(); a trapezoid has all of its 4 rad/s^2 within one control loop.
TEST(NimotionJerk, IsThatOfTheJointWhereTheProfileIsToHaveOne) {
  EXPECT_LT(jerkOn(", write: [{object: motion_profile_type, raw: 3}]", 1.2), 40.0 * 1.1);
  EXPECT_GT(jerkOn("", 1.2), 100.0);
}

}  // namespace
}  // namespace cia402
