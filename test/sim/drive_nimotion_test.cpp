// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the simulated NiMotion does on the wire: relative set-points, its queue, limits, alarms.
#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <cmath>

#include "drive_fixture.h"
#include "sim/definition/drive_definition.h"

namespace cia402::sim {
namespace {

constexpr std::int32_t kCounts = 4000;  // of a turn

struct NimotionBench : DriveBench {
  explicit NimotionBench(const std::string& with = "{}", const AxisMechanics& mechanics = {})
      : DriveBench(loadDriveDefinition(
                       cia402::test::configFolder() + "/simulated_drives/nimotion_stepper.yaml",
                       YAML::Load(with)),
                   mechanics) {
    run(ms(600));  // its boot
    write(0x605B, 0, 1, 2);
  }
  void positions() {
    write(0x6060, 0, 1, 1);
    enable();
  }
  void target(std::int32_t counts, std::uint16_t word) {
    write(0x607A, 0, static_cast<std::uint32_t>(counts), 4);
    control(static_cast<std::uint16_t>(word & ~0x0010U));
    control(word);
    EXPECT_NE(status() & 0x1000, 0) << "taken";
    control(static_cast<std::uint16_t>(word & ~0x0010U));
  }
  bool full() { return (status() & 0x1000) != 0; }
};

// 60F2h: the target before, where the set-points are, where the motor is [857, 2758-2763].
TEST(SimulatedNimotion, CountsRelativeTargetsFromWhat60F2hSays) {
  std::int32_t ends[3] = {};
  for (std::uint32_t base = 0; base < 3; ++base) {
    NimotionBench bench;
    bench.write(0x60F2, 0, base, 2);
    bench.positions();
    bench.target(2 * kCounts, 0x003F);
    bench.run(ms(500));  // on its way
    const std::int32_t demand = static_cast<std::int32_t>(bench.read(0x6062));
    const std::int32_t actual = bench.position();
    ASSERT_GT(demand, actual) << "the motor is behind";
    bench.target(kCounts, 0x007F);
    bench.run(ms(4000));
    ends[base] = bench.position();
    const std::int32_t from[] = {2 * kCounts, demand, actual};
    EXPECT_NEAR(ends[base], from[base] + kCounts, base == 0 ? 1 : 60) << base;
  }
  EXPECT_GT(ends[0], ends[1]);
  EXPECT_GT(ends[1], ends[2]);
}

// 200Bh:01: 0 not ready, 1 ready, 12 an error, others running [2586].
TEST(SimulatedNimotion, TellsItsStateInAnObjectOfItsOwn) {
  NimotionBench bench;
  const auto state = [&bench] { return bench.read(0x200B, 1) & 0xFFFF; };
  EXPECT_EQ(state(), 1U);
  bench.control(0x0006);
  bench.control(0x0007);
  EXPECT_EQ(state(), 1U) << "switched on, but without power at the motor";
  bench.control(0x000F);
  bench.run(ms(5));
  EXPECT_THAT(state(), testing::AllOf(testing::Ne(0U), testing::Ne(1U), testing::Ne(12U)));
  ASSERT_TRUE(bench.drive->inject("over_voltage", bench.now));
  bench.run(ms(500));
  EXPECT_EQ(state(), 12U);
  ASSERT_TRUE(bench.drive->inject("clear", bench.now));
  bench.control(0x0080);
  bench.run(ms(50));
  EXPECT_EQ(state(), 1U);
  NimotionBench slow("{state_machine: {initialisation: 1.0}}");
  EXPECT_EQ(slow.read(0x200B, 1) & 0xFFFF, 0U);
  slow.run(ms(1000));
  EXPECT_EQ(slow.read(0x200B, 1) & 0xFFFF, 1U);
}

TEST(SimulatedNimotion, QueuesFiveAndTakesNoSixth) {
  NimotionBench bench;
  bench.positions();
  bench.target(4 * kCounts, 0x001F);
  for (int i = 1; i <= 5; ++i) {
    EXPECT_FALSE(bench.full()) << i;
    bench.target(i * 100, 0x001F);
  }
  EXPECT_TRUE(bench.full());
  bench.write(0x607A, 0, 7777, 4);
  bench.control(0x001F);
  bench.control(0x000F);
  bench.run(ms(12000));
  EXPECT_NEAR(bench.position(), 500, 1);
}

TEST(SimulatedNimotion, LosesItsQueueByAStopAndGoesOnToWhereItWas) {
  NimotionBench bench;
  bench.positions();
  bench.target(3 * kCounts, 0x001F);
  for (int i = 1; i <= 5; ++i) bench.target(i * 100, 0x001F);
  bench.run(ms(300));
  bench.control(0x010F);
  EXPECT_FALSE(bench.full());
  bench.run(ms(1000));
  bench.control(0x000F);
  bench.run(ms(8000));
  EXPECT_NEAR(bench.position(), 3 * kCounts, 1);
}

// As from the factory: 607Bh +-60000000, 607Dh +-60000 [2711-2718, 2230].
TEST(SimulatedNimotion, TakesTheLargerLimitByMagnitudeOrAsANumber) {
  struct Row {
    const char* use;
    std::int32_t to, stands;
  };
  for (const Row& row : {Row{"farther", -61000, -61000}, Row{"greater", -61000, -60000},
                         Row{"greater", 61000, 61000}, Row{"none", 61000, 60000}}) {
    NimotionBench bench("{state_machine: {position_range: " + std::string(row.use) + "}}");
    bench.write(0x6081, 0, 120000, 4);
    bench.write(0x607F, 0, 120000, 4);
    bench.write(0x6083, 0, 400000, 4);
    bench.positions();
    bench.target(row.to, 0x003F);
    bench.run(ms(4000));
    EXPECT_NEAR(bench.position(), row.stands, 1) << row.use;
  }
}

// 605Bh and 605Ch, 0 from the factory: 0x06 and 0x07 let it coast, with 1 they brake by 6084h
// [2680-2681, 548-564]. 400000 counts/s^2 are 100 turns/s^2, by which 8 turns/s are gone after 0.08
// s. Friction is 0.03 of 300 turns/s^2 and 0.5 /s of the speed: 13 turns/s^2 at most.
TEST(SimulatedNimotion, CoastsAt06And07AsFromTheFactory) {
  for (const std::uint16_t word : {std::uint16_t{0x0006}, std::uint16_t{0x0007}}) {
    for (const std::uint32_t option : {0U, 1U}) {
      NimotionBench bench;
      bench.write(0x605B, 0, option, 2);
      bench.write(0x605C, 0, option, 2);
      bench.write(0x6083, 0, 400000, 4);
      bench.write(0x6084, 0, 400000, 4);
      bench.write(0x6060, 0, 3, 1);
      bench.enable();
      bench.write(0x60FF, 0, 8 * kCounts, 4);
      bench.run(ms(500));
      ASSERT_NEAR(bench.drive->truth(bench.now).velocity_turns, 8.0, 0.05);
      bench.control(word);
      bench.run(ms(5));
      EXPECT_EQ(bench.drive->truth(bench.now).power_stage_on, option != 0) << word;
      bench.run(ms(115));
      const double left = bench.drive->truth(bench.now).velocity_turns;
      EXPECT_FALSE(bench.drive->truth(bench.now).power_stage_on);
      if (option == 0) {
        EXPECT_GT(left, 8.0 - 13.0 * 0.12) << word;
      } else {
        EXPECT_NEAR(left, 0.0, 1e-6) << word;
      }
    }
  }
}

// 605Eh = -1: reactions 0 to 2 say themselves how it stops [2121-2127].
TEST(SimulatedNimotion, StopsAsTheAlarmSaysWhere605EhIsNegative) {
  double slower = 0.0;
  for (const std::uint32_t reaction : {0U, 1U, 2U}) {
    NimotionBench bench(
        "{dictionary: [[0x605E, 0, fault_reaction_option_code, int16, rw, -, -1, -1, 4]]}");
    bench.write(0x200E, 2, reaction << 24 | 0x00013110U, 4);
    bench.write(0x6084, 0, 20000, 4);
    bench.write(0x6085, 0, 200000, 4);
    bench.write(0x6060, 0, 3, 1);
    bench.write(0x60FF, 0, 20000, 4);
    bench.enable();
    bench.run(ms(1500));
    EXPECT_TRUE(bench.drive->inject("over_voltage", bench.now));
    bench.run(ms(200));
    const DriveTruth truth = bench.drive->truth(bench.now);
    EXPECT_EQ(truth.power_stage_on, reaction == 1) << reaction;
    const double speed = std::fabs(truth.velocity_turns);
    if (reaction == 1) {
      EXPECT_NEAR(speed, 5.0 - 5.0 * 0.2, 0.3) << "20000 counts/s^2 are 5 turns/s^2";
    }
    if (reaction == 2) {
      EXPECT_LT(speed, 0.01);
    }
    if (reaction == 0) slower = speed;
  }
  EXPECT_GT(slower, 0.01) << "it coasts";
}

// Logic of terminals: 2 rising, 3 falling, 4 both edges [1834-1839]; function 33 makes the position
// 0.
TEST(SimulatedNimotion, TakesTheEdgesOfTerminals) {
  for (const std::uint32_t logic : {0U, 1U, 2U, 3U, 4U}) {
    AxisMechanics mechanics;
    mechanics.initial_position = 2.0;
    NimotionBench bench("{}", mechanics);
    bench.write(0x2017, 3, 0, 2);  // VDI1 has it from the factory
    bench.write(0x2003, 3, 33, 2);
    bench.write(0x2003, 4, logic, 2);
    EXPECT_EQ(bench.position(), 2 * kCounts);
    bench.drive->setInput(1, true, bench.now);
    bench.run(ms(5));
    EXPECT_EQ(bench.position(), logic == 2 || logic == 4 ? 0 : 2 * kCounts) << logic;
    bench.drive->setInput(1, false, bench.now);
    bench.run(ms(5));
    EXPECT_EQ(bench.position(), logic >= 2 ? 0 : 2 * kCounts) << logic;
  }
}

// DX0 and DX1 are outputs from the factory [2653-2656].
TEST(SimulatedNimotion, HasDi3AndDi4OnlyWhere2021hSaysSo) {
  for (const std::uint8_t input : {std::uint8_t{3}, std::uint8_t{4}}) {
    for (const bool is_input : {false, true}) {
      AxisMechanics mechanics;
      mechanics.initial_position = 2.0;
      NimotionBench bench("{}", mechanics);
      bench.write(0x2017, 3, 0, 2);
      bench.write(0x2021, static_cast<std::uint8_t>(input - 2), is_input ? 0 : 1, 2);
      bench.write(0x2003, static_cast<std::uint8_t>(2 * input + 1), 33, 2);
      bench.write(0x2003, static_cast<std::uint8_t>(2 * input + 2), 2, 2);
      bench.drive->setInput(input, true, bench.now);
      bench.run(ms(5));
      EXPECT_EQ(bench.position(), is_input ? 0 : 2 * kCounts) << int{input};
    }
  }
}

// 2004h:02, its function, and 2004h:03, its logic: 1 alarm, 2 position reached, 3 the motor has
// power, 4 it turns [1907-1940]. Function 0 is its bit of 2004h:01.
TEST(SimulatedNimotion, TellsAlarmsPositionsAndMotionByItsOutputs) {
  NimotionBench bench;
  const auto high = [&](std::uint32_t function, std::uint32_t logic) {
    bench.write(0x2004, 2, function, 2);
    bench.write(0x2004, 3, logic, 2);
    return (bench.drive->truth(bench.now).outputs & 1U) != 0;
  };
  EXPECT_FALSE(high(1, 1));
  EXPECT_TRUE(high(1, 0)) << "low while there is an alarm";
  EXPECT_FALSE(high(3, 1));
  EXPECT_FALSE(high(4, 1));
  bench.write(0x607A, 0, kCounts, 4);
  bench.positions();
  EXPECT_TRUE(high(3, 1));
  bench.control(0x001F);
  bench.run(ms(200));
  EXPECT_TRUE(high(4, 1)) << "it turns";
  EXPECT_FALSE(high(2, 1));
  bench.run(ms(2000));
  EXPECT_FALSE(high(4, 1));
  EXPECT_TRUE(high(2, 1)) << "its position is reached";
  ASSERT_TRUE(bench.drive->inject("over_current", bench.now));
  bench.run(ms(100));
  EXPECT_TRUE(high(1, 1));
  EXPECT_FALSE(high(3, 1));
  bench.write(0x2004, 1, 1, 2);
  EXPECT_TRUE(high(0, 1));
  bench.write(0x2021, 1, 0, 2);
  EXPECT_FALSE(high(0, 1)) << "DX0 is an input";
}

// 0x07, then 0x1F [1363]: the edge of bit 4 counts that comes with the word that enables.
TEST(SimulatedNimotion, BeginsAHomingByTheWordThatEnables) {
  AxisMechanics mechanics;
  mechanics.negative_limit_switch = -1.0;
  NimotionBench bench("{}", mechanics);
  bench.write(0x2003, 1, 15, 2);
  bench.write(0x6098, 0, 17, 1);
  bench.write(0x6060, 0, 6, 1);
  bench.control(0x0006);
  bench.control(0x0007);
  bench.control(0x001F);
  bench.run(ms(200));
  EXPECT_NEAR(bench.drive->truth(bench.now).velocity_turns, -3.0, 0.05) << "12000 counts/s";
}

// "Setting it in the running state has no effect" [720].
TEST(SimulatedNimotion, TakesAModeWhileEnabledAndMindsItNot) {
  NimotionBench bench;
  bench.positions();
  EXPECT_EQ(bench.refusal(0x6060, 0, 3, 1), 0U);
  bench.run(ms(50));
  EXPECT_EQ(bench.read(0x6061) & 0xFF, 1U);
  bench.target(kCounts, 0x001F);
  bench.run(ms(3000));
  EXPECT_NEAR(bench.position(), kCounts, 1);
}

// 2008h:05 to 07: 40 %, 6/min, 2000 ms from the factory [2054-2056, 2076].
TEST(SimulatedNimotion, StallsAfterTheTimeOf2008h) {
  for (const std::uint32_t time : {2000U, 500U}) {
    NimotionBench bench;
    bench.write(0x2008, 7, time, 2);
    bench.write(0x6060, 0, 3, 1);
    bench.write(0x60FF, 0, kCounts, 4);
    bench.enable();
    bench.run(ms(500));
    EXPECT_TRUE(bench.emergencies().empty());
    EXPECT_TRUE(bench.drive->inject("blocked_rotor", bench.now));
    bench.run(ms(static_cast<double>(time) - 60.0));
    EXPECT_TRUE(bench.emergencies().empty()) << time;
    bench.run(ms(120));
    ASSERT_EQ(bench.emergencies().size(), 1U) << time;
    EXPECT_EQ(bench.emergencies()[0].first, 0x7121);
    EXPECT_NE(bench.status() & 0x0080, 0) << "a warning";
  }
}

// 2008h:04, 25 ms from the factory [2030]: after that time 63 % of a step are shown.
TEST(SimulatedNimotion, ShowsItsSpeedLater) {
  for (const std::uint32_t time : {25U, 100U}) {
    NimotionBench bench;
    bench.write(0x2008, 4, time, 2);
    bench.write(0x6083, 0, 400000, 4);
    bench.write(0x60C5, 0, 4000000, 4);
    bench.write(0x607F, 0, 100000, 4);
    bench.write(0x6060, 0, 3, 1);
    bench.write(0x60FF, 0, 5 * kCounts, 4);
    bench.enable();
    bench.run(ms(50.0 + time));  // 5 turns/s after 50 ms
    const double speed = bench.drive->truth(bench.now).velocity_turns;
    EXPECT_NEAR(speed, 5.0, 0.1);
    EXPECT_LT(bench.velocity(), 0.9 * 60.0 * speed) << time;
    bench.run(ms(6.0 * time));
    EXPECT_NEAR(bench.velocity(), 300, 3) << time;
  }
}

}  // namespace
}  // namespace cia402::sim
