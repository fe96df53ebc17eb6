// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Profile position beyond one absolute target: positions that wait in the drive, and distances.
#include "system/stations.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::ElementsAre;

constexpr char kSv660cFamily[] = "sv660c";

/// A joint of the family, in one mode alone. @param at where it stands first, rad
std::string distanceJoint(const FamilyMode& tested, double at = 0.0) {
  const std::string stands = "initial_position: " + std::to_string(at);
  const std::string mode = tested.mode;
  if (tested.family != std::string(kSv660cFamily)) {
    return familyJoint(tested, ", simulation: {" + stands + "}");
  }
  return replaced(sv660cJoint(", mode: " + mode, stands, "0.004", "[ip, " + mode + "]"),
                  "velocity: 1.5", "velocity: 0.8");
}

std::string distanceName(const testing::TestParamInfo<FamilyMode>& tested) {
  return familyModeName(tested);
}

class FamilyQueue : public testing::TestWithParam<const char*> {
 protected:
  static std::string yaml(const char* mode = "queued_position") {
    return distanceJoint({GetParam(), "8388608", mode});
  }
};

TEST_P(FamilyQueue, ComesToRestAtEachPositionInTheirOrder) {
  Stations scene(yaml());
  scene.give({0.3, 0.1, 0.4, -0.2, 0.0});  // one at work, one in the drive, the others wait here
  EXPECT_THAT(scene.visit(9s), ElementsAre(0, 30, 10, 40, -20, 0)) << scene.told();
  EXPECT_NEAR(scene.position("joint"), 0.0, Stations::kOneStep);
  EXPECT_TRUE(scene.state("joint").target_reached);
}

// Bit 4 rises while bit 12 is 0, and one set-point waits in the drive.
TEST_P(FamilyQueue, TakesOneMoreAndIsGivenNoneWhileBit12IsSet) {
  Stations scene(yaml());
  unsigned edges = 0;
  bool was = false, busy = false;
  scene.watch([&] {
    const bool bit = (scene.number(0x6040) & 0x10U) != 0;
    if (bit && !was) {
      ++edges;
      EXPECT_EQ(scene.number(0x6040) & 0x60U, 0U) << "absolute, and not at once";
      EXPECT_FALSE(busy) << edges;
    }
    busy = scene.bit(12);
    was = bit;
  });
  scene.give({1.0, 0.1, 0.5});
  scene.run(500ms);
  EXPECT_EQ(edges, 2U) << "the third waits in the driver";
  EXPECT_TRUE(scene.bit(12));
  ASSERT_TRUE(scene.runUntil([&] { return scene.position("joint") > 0.9999; }, 4s));
  scene.run(500ms);
  EXPECT_EQ(edges, 3U);
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), 0.5, Stations::kOneStep) << scene.told();
  EXPECT_FALSE(scene.bit(12));
}

// The drives' halt is not told to empty anything: the place to stand does, by bit 5.
TEST_P(FamilyQueue, IsReplacedByAHaltAlsoWhereItIsFull) {
  for (const int waiting : {1, 2, 4}) {
    Stations scene(yaml());
    scene.give({1.0});
    for (int i = 1; i < waiting; ++i) scene.give({-0.1 * i});
    scene.run(700ms);
    EXPECT_GT(scene.velocity("joint"), 0.3);
    scene.mustSucceed(ProcedureKind::halt);
    const double held = scene.position("joint");
    EXPECT_LT(held, 0.9);
    scene.expectStands(1s);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(2s);
    EXPECT_FALSE(scene.bit(12)) << waiting;
    scene.give({held + 0.2});
    scene.run(2s);
    EXPECT_NEAR(scene.position("joint"), held + 0.2, Stations::kOneStep) << scene.told();
  }
}

TEST_P(FamilyQueue, IsForgottenByAnAxisThatIsSwitchedOff) {
  for (const auto kind : {ProcedureKind::quick_stop, ProcedureKind::disable}) {
    Stations scene(yaml());
    scene.give({0.6, 0.0, 0.3, 0.5});
    scene.run(500ms);
    scene.mustSucceed(kind);
    scene.mustSucceed(ProcedureKind::enable);
    scene.expectStands(2s);
    scene.give({0.2});
    scene.run(3s);
    EXPECT_NEAR(scene.position("joint"), 0.2, Stations::kOneStep) << scene.told();
  }
}

// Chained: each distance begins where the one before ends.
TEST_P(FamilyQueue, OfDistancesComesToRestAtTheEndOfEach) {
  Stations scene(yaml("queued_relative_position"));
  scene.give({0.3, -0.2, 0.4});
  EXPECT_THAT(scene.visit(6s), ElementsAre(0, 30, 10, 50)) << scene.told();
  EXPECT_NEAR(scene.position("joint"), 0.5, 3 * Stations::kOneStep);
}

INSTANTIATE_TEST_SUITE_P(All, FamilyQueue, testing::Values("megmeet_dm5", kSv660cFamily),
                         [](const auto& tested) { return std::string(tested.param); });

class FamilyDistance : public testing::TestWithParam<FamilyMode> {};

TEST_P(FamilyDistance, IsGoneFromTheTargetBefore) {
  expectDistancesAreGone(distanceJoint(GetParam()));
}

TEST_P(FamilyDistance, AddsUpWhereTheyAreGivenWithoutAPause) {
  expectDistancesAddUp(distanceJoint(GetParam()));
}

TEST_P(FamilyDistance, CountsFromWhereItStandsAfterAStop) {
  expectDistancesCountFromAStop(distanceJoint(GetParam()));
}

TEST_P(FamilyDistance, LeadsNoFurtherThanTheLimitsOfTheJoint) {
  expectDistancesEndAtTheLimit(distanceJoint(GetParam(), 2.2));
}

INSTANTIATE_TEST_SUITE_P(All, FamilyDistance,
                         testing::Values(FamilyMode{"megmeet_dm5", "8388608", "relative_position"},
                                         FamilyMode{"megmeet_dm5", "8388608",
                                                    "queued_relative_position"},
                                         FamilyMode{"sv660c", "100000", "relative_position"},
                                         FamilyMode{"sv660c", "100000", "queued_relative_position"},
                                         FamilyMode{"id286_cnfa", "10000", "relative_position"}),
                         distanceName);

// Bits 4 to 6 of the controlword: new set-point, at once, relative.
TEST(FamilyPositions, AreHandedOverByTheBitsOfTheManual) {
  struct Row {
    FamilyMode tested;
    std::vector<unsigned> words;
  };
  for (const Row& row : {Row{{"megmeet_dm5", "8388608", "pp"}, {0x3F}},
                         Row{{"megmeet_dm5", "8388608", "queued_position"}, {0x1F}},
                         Row{{"megmeet_dm5", "8388608", "relative_position"}, {0x7F}},
                         Row{{"megmeet_dm5", "8388608", "queued_relative_position"}, {0x5F}},
                         Row{{"sv660c", "100000", "pp"}, {0x3F}},
                         Row{{"sv660c", "100000", "queued_position"}, {0x1F}},
                         Row{{"sv660c", "100000", "relative_position"}, {0x7F}},
                         Row{{"sv660c", "100000", "queued_relative_position"}, {0x5F}},
                         Row{{"id286_cnfa", "10000", "relative_position"}, {0x6F, 0x7F}}}) {
    Stations scene(distanceJoint(row.tested));
    scene.give({0.1});  // behind a target that says "stay here"
    scene.run(2s);
    std::vector<unsigned> words;
    scene.watch([&] {
      const auto word = static_cast<unsigned>(scene.number(0x6040));
      const bool hands_over = (word & 0x10U) != 0 || (word & 0x60U) == 0x60U;
      if (hands_over && (words.empty() || words.back() != word)) words.push_back(word);
    });
    scene.give({0.2});
    scene.run(2s);
    EXPECT_EQ(words, row.words) << row.tested.family << " " << row.tested.mode;
  }
}

}  // namespace
}  // namespace cia402
