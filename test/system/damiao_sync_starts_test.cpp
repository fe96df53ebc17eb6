// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SYNC with a counter lets several motors take turns with what they send with every n-th SYNC.
#include <map>
#include <set>

#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr unsigned kEvery = 4;

/// @param more of the second TPDO, as ", key: value"
std::string slowFeedback(unsigned every, const std::string& more = {}) {
  return ", pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, position_actual], "
         "tpdo2: {objects: [velocity_actual, torque_actual], transmission: " +
         std::to_string(every) + more + "}}";
}

std::string threeMotors(const std::string& first, const std::string& others) {
  return busRobot(busAxis(kBusDamiao, "one", 1, first) + busAxis(kBusDamiao, "two", 2, others) +
                  busAxis(kBusDamiao, "three", 3, others));
}

/// Counters of SYNC, modulo `every`, with which the TPDOs 2 of the nodes came.
std::map<std::string, std::set<unsigned>> turnsOf(const TracedScene& scene, unsigned every) {
  std::map<std::string, std::set<unsigned>> turns;
  unsigned counter = 0;
  for (const std::string& line : scene.lines) {
    const std::string id = line.substr(0, 3);
    if (id == "080") counter = static_cast<unsigned>(std::stoul(line.substr(4), nullptr, 16));
    if (id == "281" || id == "282" || id == "283") turns[id].insert(counter % every);
  }
  return turns;
}

TEST(DamiaoSyncStarts, LetSeveralMotorsTakeTurns) {
  TracedScene scene(threeMotors(slowFeedback(kEvery), slowFeedback(kEvery)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.clear();
  scene.run(1500ms);  // beyond the end of the counter, 240
  const auto turns = turnsOf(scene, kEvery);
  ASSERT_EQ(turns.size(), 3U);
  std::set<unsigned> all;
  for (const auto& [id, turn] : turns) {
    EXPECT_EQ(turn.size(), 1U) << id << " comes with other SYNCs, too";
    all.insert(turn.begin(), turn.end());
  }
  EXPECT_EQ(all.size(), 3U) << "no two with the same SYNC";
  EXPECT_EQ(numberIn(scene, 0x1801, 6, "one"), 1U);
  EXPECT_EQ(numberIn(scene, 0x1801, 6, "two"), 2U);
  EXPECT_EQ(numberIn(scene, 0x1801, 6, "three"), 3U);
  EXPECT_EQ(numberIn(scene, 0x1800, 6, "three"), 0U) << "every SYNC has no turns";
  EXPECT_FALSE(std::isnan(scene.state("three").velocity));
}

TEST(DamiaoSyncStarts, AreWhatTheFileSays) {
  TracedScene scene(threeMotors(slowFeedback(kEvery, ", sync_start: 7"),
                                slowFeedback(kEvery, ", sync_start: 0")));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_EQ(numberIn(scene, 0x1801, 6, "one"), 7U);
  scene.clear();
  scene.run(500ms);
  const auto turns = turnsOf(scene, kEvery);
  EXPECT_EQ(turns.at("281"), (std::set<unsigned>{(7U + kEvery - 1U) % kEvery}));
}

// What the planner lets travel with every second and tenth SYNC takes turns, too.
TEST(DamiaoSyncStarts, AreInThePlanOfSeveralMotors) {
  TracedScene scene(threeMotors("", ""));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  std::map<std::uint64_t, std::set<std::uint64_t>> starts;
  std::map<std::uint64_t, unsigned> count;
  for (const char* name : {"one", "two", "three"}) {
    for (unsigned pdo = 0; pdo < 4; ++pdo) {
      const auto index = static_cast<std::uint16_t>(0x1800 + pdo);
      const std::uint64_t type = numberIn(scene, index, 2, name);
      if (numberIn(scene, index, 1, name) >> 31 != 0 || type < 2 || type > 240) continue;
      starts[type].insert(numberIn(scene, index, 6, name));
      ++count[type];
    }
  }
  ASSERT_FALSE(starts.empty());
  for (const auto& [type, values] : starts) {
    EXPECT_EQ(values.size(), std::min<std::uint64_t>(type, count[type])) << type;
    EXPECT_EQ(values.count(0), 0U) << type;
  }
}

TEST(DamiaoSyncStarts, AreNoneOnABusWithPlainSync) {
  BusOptions plain;
  plain.more = ", sync_counter: 0";
  TracedScene scene(busRobot(busAxis(kBusDamiao, "one", 1, slowFeedback(kEvery)) +
                                 busAxis(kBusDamiao, "two", 2, slowFeedback(kEvery)) +
                                 busAxis(kBusNimotion, "stepper", 3),
                             plain));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_EQ(numberIn(scene, 0x1019, 0, "one"), 0U);
  EXPECT_EQ(numberIn(scene, 0x1801, 6, "one"), 0U);
  scene.clear();
  scene.run(200ms);
  EXPECT_GT(scene.count("281"), 8U);
}

TEST(DamiaoSyncStarts, OfDrivesWithoutThemAreRefused) {
  EXPECT_THAT(problemsOfRobot(busJoint(kBusNimotion,
                                       ", pdos: {rpdo1: [controlword, target_position], tpdo1: "
                                       "{objects: [statusword, position_actual], sync_start: 3}}")),
              HasSubstr("axes/joint/pdos/tpdo1/sync_start: this drive has no SYNC start values"));
  EXPECT_THAT(problemsOfRobot(busJoint(kBusDamiao, slowFeedback(254, ", sync_start: 3"))),
              HasSubstr("is for TPDOs of transmission types 1 to 240"));
}

}  // namespace
}  // namespace cia402
