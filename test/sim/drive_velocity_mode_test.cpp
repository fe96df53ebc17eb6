// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Velocity mode (vl) of the generic simulated drive: 6042h in 1/min, ramps 6048h, 6049h and 604Ah
// as a change of speed over seconds, controlword bits 4 to 6 (CiA 402-2, velocity mode).
#include "generic_bench.h"

namespace cia402::sim {
namespace {

struct VelocityBench : GenericBench {
  explicit VelocityBench(const YAML::Node& with = {}) : GenericBench({}, with) { mode(2); }
  void speed(int per_minute) { write(0x6042, 0, static_cast<std::uint16_t>(per_minute), 2); }
  /// 6048h or 6049h or 604Ah.
  void ramp(std::uint16_t index, std::uint32_t per_minute, std::uint32_t seconds) {
    write(index, 1, per_minute, 4);
    write(index, 2, seconds, 2);
  }
  int demandPerMinute() { return static_cast<std::int16_t>(read(0x6043)); }
  double turnsPerSecond() { return drive->truth(now).velocity_turns; }
};

TEST(DriveVelocityMode, RampsToItsTargetByAChangeOfSpeedOverSeconds) {
  VelocityBench b;
  b.ramp(0x6048, 3000, 5);  // 600 1/min a second
  b.enable();
  b.speed(300);
  b.control(0x007F);
  b.run(ms(250));
  EXPECT_NEAR(b.demandPerMinute(), 150, 2);
  b.run(ms(400));
  EXPECT_EQ(b.demandPerMinute(), 300);
  EXPECT_NEAR(b.turnsPerSecond(), 5.0, 0.01);
  b.speed(-120);
  b.run(ms(2000));
  EXPECT_NEAR(b.turnsPerSecond(), -2.0, 0.01);
}

TEST(DriveVelocityMode, DoesNotTurnBeforeItsRampIsEnabledUnlockedAndLed) {
  for (const unsigned bits : {0x00U, 0x10U, 0x20U, 0x30U, 0x40U, 0x50U}) {
    VelocityBench b;
    b.speed(600);
    b.enable();
    b.control(static_cast<std::uint16_t>(0x000FU | bits));
    b.run(ms(500));
    EXPECT_EQ(b.turnsPerSecond(), 0.0) << bits;
  }
}

TEST(DriveVelocityMode, LosingBitsFourAndFiveDoesNotStopIt) {
  VelocityBench b;
  b.speed(600);
  b.enable();
  b.control(0x007F);
  b.run(ms(1500));
  ASSERT_NEAR(b.turnsPerSecond(), 10.0, 0.01);
  b.control(0x000F);
  b.run(ms(1000));
  EXPECT_NEAR(b.turnsPerSecond(), 10.0, 0.01);
  b.control(0x003F);  // its ramp leads to 0
  b.run(ms(1500));
  EXPECT_EQ(b.demandPerMinute(), 0);
  EXPECT_NEAR(b.turnsPerSecond(), 0.0, 1e-3);
}

TEST(DriveVelocityMode, KeepsToTheSmallestAndLargestAmount) {
  VelocityBench b;
  b.write(0x6046, 1, 60, 4);
  b.write(0x6046, 2, 300, 4);
  b.enable();
  b.speed(-30);
  b.control(0x007F);
  b.run(ms(500));
  EXPECT_EQ(b.demandPerMinute(), -60);
  b.speed(3000);
  b.run(ms(2000));
  EXPECT_EQ(b.demandPerMinute(), 300);
}

TEST(DriveVelocityMode, StopsByTheRampsOfItsOwn) {
  for (const bool quick : {false, true}) {
    VelocityBench b;
    b.ramp(0x6048, 6000, 1);
    b.ramp(0x6049, 600, 1);
    b.ramp(0x604A, 6000, 1);
    b.speed(600);
    b.enable();
    b.control(0x007F);
    b.run(ms(500));
    ASSERT_NEAR(b.turnsPerSecond(), 10.0, 0.01);
    b.control(quick ? 0x0072 : 0x017F);
    b.run(ms(50));
    EXPECT_NEAR(b.turnsPerSecond(), quick ? 5.0 : 9.5, 0.7);
    b.run(ms(100));
    EXPECT_EQ(b.drive->truth(b.now).power_stage_on, !quick);
  }
}

TEST(DriveVelocityMode, ALockedRampHoldsStopsWhereItIsToldTo) {
  const YAML::Node holds = YAML::Load("{state_machine: {locked_ramp_holds_stops: true}}");
  for (const unsigned word : {0x0002U, 0x0012U, 0x0022U, 0x0072U}) {
    VelocityBench b(holds);
    b.ramp(0x604A, 6000, 1);
    b.speed(600);
    b.enable();
    b.control(0x007F);
    b.run(ms(1500));
    b.control(static_cast<std::uint16_t>(word));
    b.run(ms(500));
    const bool locked = (word & 0x20U) == 0;
    EXPECT_NEAR(b.turnsPerSecond(), locked ? 10.0 : 0.0, 0.01) << word;
    EXPECT_EQ(b.drive->truth(b.now).power_stage_on, locked) << word;
  }
}

}  // namespace
}  // namespace cia402::sim
