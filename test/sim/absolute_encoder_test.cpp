// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The encoder that a simulated drive tells more of than 6064h can hold; and the queue of its
// set-points.
#include <yaml-cpp/yaml.h>

#include "drive_fixture.h"
#include "sim/definition/drive_definition.h"
#include "sv660c_bench.h"

namespace cia402::sim {
namespace {

constexpr std::int64_t kEncoderTurn = 8388608;

AxisMechanics standingAt(double turns) {
  AxisMechanics mechanics;
  mechanics.initial_position = turns;
  mechanics.counts_per_turn = kEncoderTurn;
  return mechanics;
}

struct EncoderBench : DriveBench {
  EncoderBench(const char* name, double turns, const std::string& with)
      : DriveBench(loadDriveDefinition(
                       cia402::test::configFolder() + "/simulated_drives/" + name + ".yaml",
                       YAML::Load(with)),
                   standingAt(turns)) {
    run(ms(1500));
  }
  std::int64_t wide(std::uint16_t index, std::uint8_t low, std::uint8_t high) {
    return static_cast<std::int64_t>(std::uint64_t{read(index, high)} << 32U | read(index, low));
  }
};

// P01.23 of a DM5: 0 multi-turn, 1 single turn, 2 incremental [L3154].
TEST(SimulatedEncoder, KnowsAfterPowerWhatItsKindLetsIt) {
  const double expected[] = {300.25, 0.25, 0.0};
  for (int kind = 0; kind < 3; ++kind) {
    EncoderBench bench("megmeet_dm5", 300.25,
                       "{dictionary: [[0x2001, 24, absolute_encoder_mode, uint16, rw, -, " +
                           std::to_string(kind) + ", 0, 2]]}");
    EXPECT_EQ(bench.wide(0x200B, 37, 38), 2518679552) << "before: 300.25 turns";
    EXPECT_EQ(bench.position(), static_cast<std::int32_t>(2518679552 - 4294967296)) << "32 bits";
    ASSERT_TRUE(bench.drive->inject("power_cycle", bench.now));
    bench.run(ms(2500));
    const auto counts = static_cast<std::int64_t>(expected[kind] * kEncoderTurn);
    EXPECT_EQ(bench.wide(0x200B, 37, 38), counts) << kind;
    EXPECT_EQ(bench.position(), static_cast<std::int32_t>(static_cast<std::uint32_t>(counts)));
  }
}

TEST(SimulatedEncoder, TellsTurnsAndWhereInTheTurn) {
  EncoderBench bench("megmeet_dm5", 77.5, "{}");
  EXPECT_EQ(bench.read(0x200B, 34), 77U);
  EXPECT_EQ(bench.read(0x200B, 33), 4194304U);
  EXPECT_EQ(bench.wide(0x200B, 39, 40), 650117120);  // 77.5 * 8388608
  EncoderBench negative("megmeet_dm5", -1.5, "{}");
  EXPECT_EQ(negative.wide(0x200B, 39, 40), -12582912);
}

// P10.11 = 0: Er.031; 1, from the factory: masked [L3379, L3760].
TEST(SimulatedEncoder, ReportsTooManyTurnsUnlessThatIsMasked) {
  for (const unsigned masked : {0U, 1U}) {
    EncoderBench bench("megmeet_dm5", 65537.0,
                       "{dictionary: [[0x200A, 12, turns_overflow_masked, uint16, rw, -, " +
                           std::to_string(masked) + ", 0, 1]]}");
    EXPECT_EQ(bench.read(0x603F) & 0xFFFFU, masked == 0 ? 0xFF1FU : 0U);
    EXPECT_EQ(bench.read(0x200B, 46), 1U);
  }
}

// Er.076: without its battery the turns are gone with the power.
TEST(SimulatedEncoder, ForgetsItsTurnsWithoutBattery) {
  EncoderBench bench("megmeet_dm5", 12.25, "{}");
  ASSERT_TRUE(bench.drive->inject("battery_warning", bench.now));
  bench.run(ms(100));
  EXPECT_EQ(bench.position(), static_cast<std::int32_t>(12.25 * kEncoderTurn));
  ASSERT_TRUE(bench.drive->inject("power_cycle", bench.now));
  bench.run(ms(2500));
  EXPECT_EQ(bench.position(), kEncoderTurn / 4);
  EXPECT_EQ(bench.read(0x603F) & 0xFFFFU, 0xFF4CU);
  EXPECT_EQ(bench.state() & 0x4F, 0x08) << "fault";
}

// H05.52 and H05.54 before H05.50 and H05.51 [L5475-5521]; 25 % of a turn of the load each.
TEST(SimulatedEncoder, TellsWhereTheLoadStandsInItsTurn) {
  EncoderBench by_gear("sv660c", 12.5,
                       "{dictionary: [[0x2002, 2, absolute_system, uint16, rw, -, 2, 0, 2], "
                       "[0x2005, 0x33, gear_numerator, uint16, rw, -, 10, 1, 65535]]}");
  EXPECT_EQ(by_gear.wide(0x200B, 0x52, 0x54), 20971520);  // 2.5 of 10 turns of the motor
  EncoderBench by_counts("sv660c", 10.5,
                         "{dictionary: [[0x2002, 2, absolute_system, uint16, rw, -, 2, 0, 2], "
                         "[0x2005, 0x35, counts_low, uint32, rw, -, 16777216, 0, 2147483647]]}");
  EXPECT_EQ(by_counts.wide(0x200B, 0x52, 0x54), 4194304);  // 0.5 of 2 turns of the motor
}

// H0d.20 = 2 [L9589].
TEST(SimulatedEncoder, IsResetByTheObjectOfItsMaker) {
  EncoderBench bench("sv660c", 5.25,
                     "{dictionary: [[0x2002, 2, absolute_system, uint16, rw, -, 1, 0, 2]]}");
  EXPECT_EQ(bench.read(0x200B, 0x47), 5U);
  bench.write(0x200D, 0x15, 2, 2);
  bench.run(ms(100));
  EXPECT_EQ(bench.read(0x200B, 0x47), 0U);
  EXPECT_EQ(bench.wide(0x200B, 0x3B, 0x3D), kEncoderTurn / 4);
  EXPECT_EQ(bench.position(), kEncoderTurn / 4);
}

// One waits; more are not taken but with bit 5, which counts at once [L692-698].
TEST_F(Sv660cBench, TakesWithAFullQueueWhatCountsAtOnceAlone) {
  const auto target = [&](std::int32_t counts, std::uint8_t word) {
    bench.write(0x607A, 0, static_cast<std::uint32_t>(counts), 4);
    control(static_cast<std::uint8_t>(word & ~0x10U));
    control(word);
    control(static_cast<std::uint8_t>(word & ~0x10U));
  };
  const auto full = [&] { return (bench.status() & 0x1000) != 0; };
  for (const bool at_once : {false, true}) {
    mode(1);
    bench.write(0x6081, 0, 1 << 24, 4);
    bench.write(0x6083, 0, 1 << 28, 4);
    bench.write(0x6084, 0, 1 << 28, 4);
    enable();
    const std::int32_t from = bench.position();
    target(from + 16777216, 0x1F);
    bench.run(ms(200));
    EXPECT_FALSE(full());
    target(from + 8388608, 0x1F);
    EXPECT_TRUE(full());
    target(from + 4194304, at_once ? 0x3F : 0x1F);
    EXPECT_EQ(full(), !at_once);
    bench.run(ms(6000));
    EXPECT_NEAR(bench.position(), from + (at_once ? 4194304 : 8388608), 50);
    control(0x00);
    bench.run(ms(500));
  }
}

}  // namespace
}  // namespace cia402::sim
