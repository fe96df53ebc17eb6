// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// When a simulated drive goes by what was written: at once, once its motor has no power, once its
// own power was off.
#include <yaml-cpp/yaml.h>

#include <utility>

#include "sim/definition/drive_definition.h"
#include "sv660c_bench.h"

namespace cia402::sim {
namespace {

constexpr std::uint32_t kDo1 = 0x10000, kDo2 = 0x20000;  // bits of 60FEh

struct Sv660cEffect : Sv660cBench {
  std::uint32_t outputs() { return bench.drive->truth(bench.now).outputs; }
  const Entry& entry(std::uint16_t index, std::uint8_t sub) {
    return *bench.drive->dictionary().find({index, sub});
  }
  void powerCycle() {
    bench.drive->powerOff(bench.now);
    bench.drive->powerOn(bench.now);
    bench.run(ms(800));
  }
};

// H04.00: changed at any time, in effect once stopped [L4474].
TEST_F(Sv660cEffect, OfAFunctionOfATerminalComesOnceTheMotorHasNoPower) {
  bench.write(0x60FE, 2, kDo1, 4);
  bench.write(0x60FE, 1, kDo1, 4);
  EXPECT_EQ(outputs(), 0U) << "it shows something else from the factory";
  bench.write(0x2004, 1, 31, 2);
  EXPECT_EQ(outputs(), kDo1) << "without power it is in effect at once";
  enable();
  bench.write(0x2004, 1, 1, 2);
  EXPECT_EQ(bench.read(0x2004, 1) & 0xFFFF, 1U);
  bench.write(0x2004, 1, 5, 2);
  bench.run(ms(200));
  EXPECT_EQ(bench.read(0x2004, 1) & 0xFFFF, 5U);
  EXPECT_EQ(outputs(), kDo1) << "it still goes by 31";
  control(0x07);
  bench.run(ms(50));
  ASSERT_FALSE(bench.drive->truth(bench.now).power_stage_on);
  EXPECT_EQ(outputs(), 0U);
}

// H31.04: in effect at once [L13183].
TEST_F(Sv660cEffect, OfALevelOfATerminalComesAtOnce) {
  bench.write(0x2004, 0x17, 2, 2);  // H04.22: DO2
  enable();
  bench.write(0x2031, 5, 2, 2);
  EXPECT_EQ(outputs(), kDo2);
}

// 60C2h:01: 1 to 20 ms, beyond them the limit; set while it is stopped, without effect while it
// runs [L15979-15983].
TEST_F(Sv660cEffect, OfThePeriodOfItsSetPointsIsNoneWhileItRuns) {
  const auto period = [&] { return bench.read(0x60C2, 1) & 0xFF; };
  const auto write = [&](std::uint8_t ms) {
    EXPECT_EQ(bench.sdo({0x2F, 0xC2, 0x60, 0x01, ms, 0, 0, 0}),
              (std::vector<std::uint8_t>{0x60, 0xC2, 0x60, 0x01, 0, 0, 0, 0}));
  };
  for (const auto& [written, shown] : {std::pair(21, 20U), {255, 20U}, {0, 1U}, {4, 4U}}) {
    write(static_cast<std::uint8_t>(written));
    EXPECT_EQ(period(), shown) << written;
  }
  enable();
  ASSERT_TRUE(bench.drive->truth(bench.now).power_stage_on);
  write(8);
  EXPECT_EQ(period(), 4U);
  control(0x07);
  bench.run(ms(50));
  ASSERT_FALSE(bench.drive->truth(bench.now).power_stage_on);
  EXPECT_EQ(period(), 4U) << "what came while it ran is forgotten";
  write(8);
  EXPECT_EQ(period(), 8U);
}

// H0E.10: in effect after the next power-on [L9629]; a reset by NMT is none.
TEST_F(Sv660cEffect, OfTheChoiceOfCanopenComesWithThePower) {
  bench.write(0x200E, 0x0B, 0, 2);
  EXPECT_EQ(bench.read(0x200E, 0x0B) & 0xFFFF, 0U);
  bench.nmt(129);
  bench.run(ms(800));
  EXPECT_EQ(bench.read(0x1000), 0x00020192U);
  powerCycle();
  const std::size_t before = bench.sent.size();
  bench.frame(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  bench.run(ms(500));
  EXPECT_EQ(bench.sent.size(), before);
}

// H02.01 with the rest of chapter 3 that is in effect after power-on; H0d.00 is as good as that
// [L9428].
TEST_F(Sv660cEffect, OfWhatWantsThePowerIsNotThatOfAReset) {
  bench.write(0x2002, 2, 1, 2);
  EXPECT_EQ(bench.read(0x2002, 2) & 0xFFFF, 1U);
  EXPECT_EQ(entry(0x2002, 2).acting(), 0U);
  bench.nmt(129);
  bench.run(ms(800));
  EXPECT_EQ(entry(0x2002, 2).acting(), 0U);
  enable();
  control(0x00);
  bench.run(ms(50));
  EXPECT_EQ(entry(0x2002, 2).acting(), 0U) << "that it stopped is not enough";
  bench.write(0x200D, 1, 1, 2);
  bench.run(ms(1000));
  EXPECT_EQ(entry(0x2002, 2).acting(), 1U);
}

// By a motor: H02.09, here as if it were in effect after power-on.
TEST(DriveEffect, OfANumberThatWantsThePowerIsSeenAtTheMotor) {
  DriveBench bench(
      loadDriveDefinition(cia402::test::configFolder() + "/simulated_drives/sv660c.yaml",
                          YAML::Load("effective: {power: [\"2002:0A\"]}")),
      {});
  bench.run(ms(700));
  const auto starts = [&bench] {
    bench.write(0x6060, 0, 3, 1);
    bench.write(0x60FF, 0, 0x03555555, 4);
    bench.enable();
    const Time enabled = bench.now;
    while (!bench.drive->truth(bench.now).moving && bench.now < enabled + ms(1000)) {
      bench.run(ms(1));
    }
    const double seconds = toSeconds(bench.now - enabled);
    bench.write(0x60FF, 0, 0, 4);
    bench.run(ms(100));
    bench.control(0x0000);
    bench.run(ms(500));
    return seconds;
  };
  bench.write(0x2002, 0x0A, 450, 2);
  EXPECT_NEAR(starts(), 0.25, 0.01);
  bench.drive->powerOff(bench.now);
  bench.drive->powerOn(bench.now);
  bench.run(ms(800));
  EXPECT_NEAR(starts(), 0.45, 0.01);
}

}  // namespace
}  // namespace cia402::sim
