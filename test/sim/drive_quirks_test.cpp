// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What drives in the field do otherwise than CiA 402, switch by switch.
#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include "generic_bench.h"
#include "sim/definition/drive_definition.h"

namespace cia402::sim {
namespace {

using Codes = std::vector<std::pair<int, int>>;

/// The generic drive with these `quirks`.
struct QuirkBench : DriveBench {
  explicit QuirkBench(const std::string& quirks)
      : DriveBench(loadDriveDefinition(
                       cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml",
                       YAML::Load("{quirks: {" + quirks + "}}")),
                   {}) {}
  void fault() {
    ASSERT_TRUE(drive->inject("overcurrent", now));
    ASSERT_TRUE(drive->inject("clear", now));
    run(ms(20));
    ASSERT_EQ(state(), 0x08);
  }
  void reset() {
    control(0x0000);
    run(ms(5));
    control(0x0080);
  }
};

TEST(DriveQuirks, NoStateIsShownThoughThereIsPower) {
  QuirkBench bench("shows_no_state: true");
  bench.enable();
  EXPECT_TRUE(bench.drive->truth(bench.now).power_stage_on);
  EXPECT_EQ(bench.read(0x6041) & 0x006F, 0x0040U);
  bench.control(0x0000);
  bench.run(ms(5));
  EXPECT_FALSE(bench.drive->truth(bench.now).power_stage_on);
  EXPECT_EQ(bench.read(0x6041) & 0x006F, 0x0040U);
}

// Method 37 declares the present position to be home: it needs no motion to be found.
TEST(DriveQuirks, HomingBeginsWithAnObjectAndEndsWithBit15) {
  DriveBench bench(loadDriveDefinition(
                       cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml",
                       YAML::Load("{objects: {homing_start: \"60FB:04\"}, dictionary: [[0x60FB, 4, "
                                  "homing_start, uint8, rw, \"-\", 0]]}")),
                   {});
  bench.write(0x6098, 0, 37, 1);
  bench.write(0x6060, 0, 6, 1);
  bench.write(0x60FB, 4, 1, 1);
  bench.run(ms(5));
  EXPECT_EQ(bench.read(0x6041) & 0x8000, 0U) << "not while disabled";
  bench.enable();
  bench.control(0x001F);
  bench.run(ms(50));
  EXPECT_EQ(bench.read(0x6041) & 0xB400, 0U) << "bit 4 begins nothing";
  bench.write(0x60FB, 4, 1, 1);
  bench.run(ms(50));
  EXPECT_EQ(bench.read(0x6041) & 0xB400, 0x8000U);
}

TEST(DriveQuirks, AFaultIsResetOnlyAfterAnNmtStopOfSomeLength) {
  QuirkBench bench("fault_reset_needs_stop: 0.1");
  bench.fault();
  bench.reset();
  EXPECT_EQ(bench.state(), 0x08);
  bench.nmt(0x02);
  bench.run(ms(50));
  bench.nmt(0x01);
  bench.reset();
  EXPECT_EQ(bench.state(), 0x08) << "that was too short";
  bench.nmt(0x02);
  bench.run(ms(100));
  bench.nmt(0x01);
  EXPECT_EQ(bench.state(), 0x08);
  bench.reset();
  EXPECT_EQ(bench.state(), 0x40);
  bench.fault();
  bench.reset();
  EXPECT_EQ(bench.state(), 0x08) << "each fault wants its own";
}

TEST(DriveQuirks, AnEdgeOfTheResetBitAfterAShortLowIsNotSeen) {
  QuirkBench bench("reset_edge_time: 0.01");
  bench.fault();
  bench.control(0x0080);
  EXPECT_EQ(bench.state(), 0x40);
  bench.fault();
  bench.control(0x0000);
  bench.control(0x0080);
  EXPECT_EQ(bench.state(), 0x08);
  bench.control(0x0000);
  bench.run(ms(10));
  bench.control(0x0080);
  EXPECT_EQ(bench.state(), 0x40);
}

TEST(DriveQuirks, TheEmergencyOfAFaultComesAndGoesAndItsResetIsToldSixTimes) {
  QuirkBench bench("emergency_chatter: true");
  bench.fault();
  bench.run(ms(600));
  const std::pair<int, int> set{0x2310, 0x03}, end{0, 0};
  EXPECT_EQ(bench.emergencies(), (Codes{set, end, set, end, set, end, set}));
  bench.sent.clear();
  bench.reset();
  EXPECT_EQ(bench.emergencies(), Codes(6, end));
  EXPECT_EQ(bench.state(), 0x40);
}

TEST(DriveQuirks, WhoComesUpAloneIsInErrorPassive) {
  QuirkBench bench("passive_when_alone: true");
  EXPECT_EQ(bench.state(), 0x08);
  EXPECT_EQ(bench.read(0x603F), 0x8120U);
  bench.reset();
  EXPECT_EQ(bench.state(), 0x40);
  bench.nmt(0x81);
  bench.sync();
  bench.run(ms(50));
  EXPECT_EQ(bench.state(), 0x40) << "somebody was heard";
}

TEST(DriveQuirks, AChangeOfModeTakesItsTimeAndShowsNoneMeanwhile) {
  QuirkBench bench("mode_change_time: 0.5");
  bench.write(0x6060, 0, 3, 1);
  EXPECT_EQ(bench.read(0x6061) & 0xFF, 0xFFU);
  bench.run(ms(480));
  EXPECT_EQ(bench.read(0x6061) & 0xFF, 0xFFU);
  bench.run(ms(30));
  EXPECT_EQ(bench.read(0x6061) & 0xFF, 3U);
}

TEST(DriveQuirks, AModeIsShownThatNobodyCommanded) {
  QuirkBench bench("mode_shown_at_start: 2");
  EXPECT_EQ(bench.read(0x6061) & 0xFF, 2U);
  bench.write(0x6060, 0, 8, 1);
  EXPECT_EQ(bench.read(0x6061) & 0xFF, 8U);
}

TEST(DriveQuirks, EnablingWithoutASyncIsAnRpdoTimeOut) {
  QuirkBench bench("sync_needed: true");
  bench.enable();
  EXPECT_EQ(bench.state(), 0x08);
  EXPECT_EQ(bench.emergencies(), (Codes{{0x8250, 0x11}}));
  bench.reset();
  bench.sync();
  bench.enable();
  EXPECT_EQ(bench.state(), 0x27);
}

TEST(DriveQuirks, QuickStopIsShownForAMomentButTheRampIsWhole) {
  QuirkBench bench("quick_stop_flashes: true");
  bench.write(0x6085, 0, 131072 * 10, 4);
  bench.write(0x6060, 0, 3, 1);
  bench.enable();
  bench.write(0x60FF, 0, 131072 * 5, 4);
  bench.run(ms(1500));
  bench.control(0x0002);
  EXPECT_EQ(bench.status() & 0x6F, 0x07);
  bench.run(ms(10));
  EXPECT_EQ(bench.status() & 0x6F, 0x40);
  EXPECT_TRUE(bench.drive->truth(bench.now).power_stage_on);
  bench.run(ms(1000));
  EXPECT_FALSE(bench.drive->truth(bench.now).power_stage_on);
  EXPECT_FALSE(bench.drive->truth(bench.now).moving);
}

TEST(DriveQuirks, WithoutItsMasterItHaltsWithTorque) {
  QuirkBench bench("master_lost_holds: true");
  bench.write(0x1016, 1, 0x007F0064, 4);  // node 127, 100 ms
  bench.write(0x6060, 0, 3, 1);
  bench.frame(0x77F, {0x05});
  bench.enable();
  bench.write(0x60FF, 0, 131072, 4);
  bench.run(ms(80));
  EXPECT_TRUE(bench.drive->truth(bench.now).moving);
  bench.run(ms(1000));
  EXPECT_FALSE(bench.drive->truth(bench.now).moving);
  EXPECT_TRUE(bench.drive->truth(bench.now).power_stage_on);
  EXPECT_EQ(bench.state(), 0x27);
}

TEST(DriveQuirks, AfterASaveItIsEnabledOnlyOnceItsPowerWasOff) {
  QuirkBench bench("needs_power_cycle_to_save: true");
  bench.enable();
  EXPECT_EQ(bench.state(), 0x27);
  bench.control(0x0000);
  bench.write(0x1010, 1, 0x65766173, 4);  // "save"
  bench.enable();
  EXPECT_EQ(bench.state(), 0x23);
  bench.nmt(0x81);
  bench.run(ms(50));
  bench.enable();
  EXPECT_EQ(bench.state(), 0x23) << "a reset is no power cycle";
  bench.drive->powerOff(bench.now);
  bench.drive->powerOn(bench.now);
  bench.run(ms(50));
  bench.enable();
  EXPECT_EQ(bench.state(), 0x27);
}

}  // namespace
}  // namespace cia402::sim
