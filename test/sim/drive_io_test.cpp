// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Digital outputs and touch probes of simulated drives, byte by byte (CiA 402-2, 60B8h to 60BDh,
// 60D5h to 60D8h, 60FEh).
#include <yaml-cpp/yaml.h>

#include "generic_bench.h"
#include "sim/definition/drive_definition.h"

namespace cia402::sim {
namespace {

constexpr std::uint32_t kDisarmed = 0, kArmed = 1, kRising = 0x10, kFalling = 0x20,
                        kContinuous = 0x02, kIndex = 0x04;

struct ProbeBench : GenericBench {
  explicit ProbeBench(const AxisMechanics& mechanics = {}) : GenericBench(mechanics) {}
  void arm(std::uint32_t function) { write(0x60B8, 0, function, 2); }
  int seen() { return static_cast<int>(read(0x60B9) & 0xFFFF); }
  std::int32_t stored(int which) {
    return static_cast<std::int32_t>(read(static_cast<std::uint16_t>(0x60BA + which)));
  }
  void probe(unsigned number, bool active) { drive->setProbe(number, active, now); }
  double turns() { return drive->truth(now).position_turns; }
  /// Turns with two turns a second, in pv.
  void turn(std::int32_t counts_per_second = 2 * kTurn) {
    mode(3);
    enable();
    write(0x60FF, 0, static_cast<std::uint32_t>(counts_per_second), 4);
    run(ms(500));
  }
};

TEST(SimOutputs, AreThoseThatTheMaskLetsThrough) {
  GenericBench bench;
  bench.write(0x60FE, 1, 0x00050000, 4);
  EXPECT_EQ(bench.drive->truth(bench.now).outputs, 0U) << "60FEh:02 is 0";
  bench.write(0x60FE, 2, 0x00060000, 4);
  EXPECT_EQ(bench.drive->truth(bench.now).outputs, 0x00040000U);
  bench.drive->powerOff(bench.now);
  EXPECT_EQ(bench.drive->truth(bench.now).outputs, 0U);
}

TEST(SimOutputs, AreAllOfThoseOfADriveWithoutMask) {
  DriveBench bench("nimotion_stepper");
  bench.run(ms(2000));
  bench.write(0x2004, 1, 0x0003, 2);
  EXPECT_EQ(bench.drive->truth(bench.now).outputs, 3U);
}

TEST(SimTouchProbe, StoresWhereTheRotorIsAtTheEdge) {
  ProbeBench bench;
  bench.turn();
  bench.arm(kArmed | kRising);
  EXPECT_EQ(bench.seen(), 0x0001);
  bench.probe(1, true);
  const double at = bench.turns() * kTurn;
  bench.run(ms(50));
  EXPECT_EQ(bench.seen(), 0x0003);
  EXPECT_NEAR(bench.stored(0), at, 0.5);
  EXPECT_GT(bench.position(), bench.stored(0) + kTurn / 20) << "it has gone on";
  EXPECT_EQ(bench.stored(1), 0) << "no falling edge was wanted";
  EXPECT_EQ(bench.read(0x60D5) & 0xFFFF, 1U);
}

TEST(SimTouchProbe, StoresOnceUntilItIsArmedAnew) {
  ProbeBench bench;
  bench.turn();
  bench.arm(kArmed | kRising | kFalling);
  bench.probe(1, true);
  bench.probe(1, false);
  const std::int32_t rising = bench.stored(0), falling = bench.stored(1);
  EXPECT_EQ(bench.seen(), 0x0007);
  bench.run(ms(50));
  bench.probe(1, true);
  EXPECT_EQ(bench.stored(0), rising);
  EXPECT_EQ(bench.stored(1), falling);
  bench.arm(kDisarmed);
  EXPECT_EQ(bench.seen(), 0x0000);
  bench.probe(1, false);
  EXPECT_EQ(bench.seen(), 0x0000);
  EXPECT_EQ(bench.stored(1), falling) << "it is not armed";
  bench.arm(kArmed | kRising);
  bench.probe(1, true);
  EXPECT_EQ(bench.seen(), 0x0003);
  EXPECT_GT(bench.stored(0), rising);
}

TEST(SimTouchProbe, StoresEachEdgeWhereItIsContinuous) {
  ProbeBench bench;
  bench.turn();
  bench.arm(kArmed | kRising | kContinuous);
  bench.probe(1, true);
  const std::int32_t first = bench.stored(0);
  bench.run(ms(50));
  bench.probe(1, false);
  bench.probe(1, true);
  EXPECT_GT(bench.stored(0), first + kTurn / 20);
  EXPECT_EQ(bench.read(0x60D5) & 0xFFFF, 2U);
}

TEST(SimTouchProbe, OfNumberTwoHasItsOwnBitsAndObjects) {
  ProbeBench bench;
  bench.turn();
  bench.arm((kArmed | kFalling) << 8);
  bench.probe(1, true);
  bench.probe(2, true);
  bench.probe(1, false);
  EXPECT_EQ(bench.seen(), 0x0100);
  bench.probe(2, false);
  const double at = bench.turns() * kTurn;
  EXPECT_EQ(bench.seen(), 0x0500);
  EXPECT_NEAR(bench.stored(3), at, 0.5);
  EXPECT_EQ(bench.stored(1), 0);
  EXPECT_EQ(bench.read(0x60D8) & 0xFFFF, 1U);
}

TEST(SimTouchProbe, StoresTheIndexPulseExactly) {
  AxisMechanics mechanics;
  mechanics.index_offset = 0.25;
  ProbeBench bench(mechanics);
  bench.arm(kArmed | kIndex | kRising);
  bench.probe(1, true);
  EXPECT_EQ(bench.seen(), 0x0001) << "its input is not what it waits for";
  bench.turn(kTurn);
  EXPECT_EQ(bench.seen(), 0x0003);
  EXPECT_EQ(bench.stored(0), kTurn / 4);
}

TEST(SimTouchProbe, FollowsTheZeroOfItsDrive) {
  ProbeBench bench;
  bench.turn();
  bench.write(0x60FF, 0, 0, 4);
  bench.run(ms(500));
  bench.write(0x607C, 0, 1000, 4);
  bench.mode(6);
  bench.write(0x6098, 0, 37, 1);
  bench.control(0x001F);
  bench.run(ms(100));
  ASSERT_NEAR(bench.position(), 1000, 1);
  bench.arm(kArmed | kRising);
  bench.probe(1, true);
  EXPECT_NEAR(bench.stored(0), 1000, 1);
}

TEST(SimTouchProbe, ForgetsAsItsFileSays) {
  const std::string path = cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml";
  struct Row {
    const char* word;
    int disarmed, armed;
  };
  for (const Row& row : {Row{"disarmed", 0x0000, 0x0001}, Row{"armed", 0x0002, 0x0001},
                         Row{"never", 0x0002, 0x0003}}) {
    const YAML::Node with = YAML::Load("touch_probe: {forgets: " + std::string(row.word) + "}");
    DriveBench bench(loadDriveDefinition(path, with), {});
    bench.write(0x60B8, 0, kArmed | kRising, 2);
    bench.drive->setProbe(1, true, bench.now);
    EXPECT_EQ(bench.read(0x60B9) & 0xFFFF, 0x0003U) << row.word;
    bench.write(0x60B8, 0, kDisarmed, 2);
    EXPECT_EQ(static_cast<int>(bench.read(0x60B9) & 0xFFFF), row.disarmed) << row.word;
    bench.write(0x60B8, 0, kArmed | kRising, 2);
    EXPECT_EQ(static_cast<int>(bench.read(0x60B9) & 0xFFFF), row.armed) << row.word;
  }
}

}  // namespace
}  // namespace cia402::sim
