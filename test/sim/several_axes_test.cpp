// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Two axes in one device (CiA 402-2): what each has for itself, and what they share.
#include <gmock/gmock.h>

#include <cstdio>
#include <fstream>

#include "drive_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

/// Node 1 with axis 0 at 6000h and axis 1 at 6800h.
struct DualBench : DriveBench {
  DualBench() : DriveBench("generic_cia402_dual") {}

  void controlSecond(std::uint16_t word) { write(0x6840, 0, word, 2); }
  void enableSecond() {
    controlSecond(0x0006);
    controlSecond(0x0007);
    controlSecond(0x000F);
  }
  /// Statuswords as a master reads them.
  std::uint32_t first() { return read(0x6041) & 0xFFFF; }
  std::uint32_t second() { return read(0x6841) & 0xFFFF; }
  /// The data of the last frame with that identifier; empty without one.
  Bytes last(std::uint32_t id) const {
    Bytes found;
    for (const can::Frame& f : sent) {
      if (f.id == id) found.assign(f.data.begin(), f.data.begin() + f.size);
    }
    return found;
  }
  int count(std::uint32_t id) const {
    int frames = 0;
    for (const can::Frame& f : sent) frames += f.id == id ? 1 : 0;
    return frames;
  }
};

TEST(SeveralAxes, EachIsEnabledByItsOwnControlword) {
  DualBench b;
  EXPECT_EQ(b.first(), 0x0250U);
  EXPECT_EQ(b.second(), 0x0250U);

  EXPECT_EQ(b.sdo({0x2B, 0x40, 0x60, 0x00, 0x06, 0x00, 0x00, 0x00}),
            (Bytes{0x60, 0x40, 0x60, 0x00, 0x00, 0x00, 0x00, 0x00}));
  EXPECT_EQ(b.sdo({0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}),
            (Bytes{0x4B, 0x41, 0x60, 0x00, 0x31, 0x02, 0x00, 0x00}));
  EXPECT_EQ(b.sdo({0x40, 0x41, 0x68, 0x00, 0, 0, 0, 0}),
            (Bytes{0x4B, 0x41, 0x68, 0x00, 0x50, 0x02, 0x00, 0x00}));

  b.enableSecond();
  EXPECT_EQ(b.second() & 0x006F, 0x0027U);
  EXPECT_EQ(b.first(), 0x0231U);
  EXPECT_FALSE(b.drive->truth(b.now, 0).power_stage_on);
  EXPECT_TRUE(b.drive->truth(b.now, 1).power_stage_on);

  b.enable();
  EXPECT_EQ(b.first() & 0x006F, 0x0027U);
  EXPECT_EQ(b.second() & 0x006F, 0x0027U);
}

TEST(SeveralAxes, EachHasItsOwnModeTargetAndMotor) {
  DualBench b;
  b.write(0x6060, 0, 1, 1);
  b.write(0x6860, 0, 3, 1);
  EXPECT_EQ(b.read(0x6061) & 0xFF, 1U);
  EXPECT_EQ(b.read(0x6861) & 0xFF, 3U);
  b.write(0x607A, 0, 131072, 4);      // a turn
  b.write(0x68FF, 0, 0xFFFE0000, 4);  // -131072 counts/s: a turn per second backwards
  b.enable();
  b.enableSecond();
  b.control(0x001F);
  b.run(ms(3000));
  EXPECT_EQ(b.read(0x6064), 131072U);
  EXPECT_EQ(static_cast<std::int32_t>(b.read(0x606C)), 0);
  EXPECT_NEAR(static_cast<std::int32_t>(b.read(0x686C)), -131072, 200);
  EXPECT_NEAR(b.drive->truth(b.now, 0).position_turns, 1.0, 1e-4);
  EXPECT_LT(b.drive->truth(b.now, 1).position_turns, -2.0);
}

TEST(SeveralAxes, AFaultOfOneLeavesTheOtherRunning) {
  DualBench b;
  b.write(0x6060, 0, 3, 1);
  b.write(0x60FF, 0, 131072, 4);
  b.enable();
  b.enableSecond();
  b.run(ms(500));
  ASSERT_TRUE(b.drive->inject("overcurrent", b.now, 1).ok());
  b.run(ms(500));

  EXPECT_THAT(b.last(0x081), ElementsAre(0x10, 0x23, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00));
  EXPECT_EQ(b.count(0x081), 1);
  EXPECT_EQ(b.second() & 0x004F, 0x0008U);
  EXPECT_EQ(b.read(0x683F) & 0xFFFF, 0x2310U);
  EXPECT_EQ(b.read(0x1001) & 0xFF, 0x03U);

  EXPECT_EQ(b.first() & 0x006F, 0x0027U);
  EXPECT_EQ(b.read(0x603F) & 0xFFFF, 0U);
  EXPECT_NEAR(static_cast<std::int32_t>(b.read(0x606C)), 131072, 200);

  b.control(0x008F);  // the other axis' reset
  EXPECT_EQ(b.second() & 0x004F, 0x0008U);
  b.controlSecond(0x0000);
  b.controlSecond(0x0080);
  EXPECT_EQ(b.second() & 0x006F, 0x0040U);
  EXPECT_THAT(b.last(0x081), ElementsAre(0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00));
}

TEST(SeveralAxes, ShareOneErrorRegisterAndTellWhatIsLeftInIt) {
  DualBench b;
  ASSERT_TRUE(b.drive->inject("overcurrent", b.now, 0).ok());
  ASSERT_TRUE(b.drive->inject("encoder", b.now, 1).ok());
  EXPECT_THAT(b.last(0x081), ElementsAre(0x05, 0x73, 0x83, 0x00, 0x00, 0x00, 0x00, 0x00));
  b.control(0x0080);
  // CiA 301, 7.2.7.1: one error is gone, the register tells of the other.
  EXPECT_THAT(b.last(0x081), ElementsAre(0x00, 0x00, 0x81, 0x00, 0x00, 0x00, 0x00, 0x00));
  EXPECT_EQ(b.read(0x1001) & 0xFF, 0x81U);
  EXPECT_EQ(b.read(0x603F) & 0xFFFF, 0U);
  EXPECT_EQ(b.read(0x683F) & 0xFFFF, 0x7305U);
  b.controlSecond(0x0080);
  EXPECT_THAT(b.last(0x081), ElementsAre(0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00));
  EXPECT_EQ(b.read(0x1001) & 0xFF, 0x00U);
  EXPECT_EQ(b.read(0x1003, 0) & 0xFF, 2U) << "the end of an error is none";
}

TEST(SeveralAxes, TellOfAFollowingErrorOfTheSecondByItself) {
  DualBench b;
  b.write(0x6860, 0, 1, 1);
  b.write(0x687A, 0, 1310720, 4);
  b.enable();
  b.enableSecond();
  ASSERT_TRUE(b.drive->inject("blocked_rotor", b.now, 1).ok());
  b.controlSecond(0x001F);
  b.run(ms(2000));
  EXPECT_THAT(b.last(0x081), ElementsAre(0x11, 0x86, 0x21, 0x00, 0x00, 0x00, 0x00, 0x00));
  EXPECT_EQ(b.second() & 0x004F, 0x0008U);
  EXPECT_EQ(b.first() & 0x006F, 0x0027U);
}

TEST(SeveralAxes, NmtResetNodeResetsBoth) {
  DualBench b;
  b.write(0x6883, 0, 100, 4);
  b.enable();
  b.enableSecond();
  const int boots = b.count(0x701);
  b.nmt(0x81);
  EXPECT_FALSE(b.drive->truth(b.now, 0).power_stage_on);
  EXPECT_FALSE(b.drive->truth(b.now, 1).power_stage_on);
  b.run(ms(100));
  EXPECT_EQ(b.count(0x701), boots + 1) << "one device, one boot-up";
  EXPECT_THAT(b.last(0x701), ElementsAre(0x00));
  EXPECT_EQ(b.first(), 0x0250U);
  EXPECT_EQ(b.second(), 0x0250U);
  EXPECT_NE(b.read(0x6883), 100U);
}

TEST(SeveralAxes, LeavingNmtOperationalStopsBoth) {
  DualBench b;
  b.nmt(0x01);
  b.enable();
  b.enableSecond();
  b.nmt(0x80);
  b.run(ms(100));
  EXPECT_FALSE(b.drive->truth(b.now, 0).power_stage_on);
  EXPECT_FALSE(b.drive->truth(b.now, 1).power_stage_on);
}

TEST(SeveralAxes, APdoMayHoldObjectsOfBoth) {
  DualBench b;
  b.write(0x1400, 1, 0x80000201, 4);
  b.write(0x1600, 0, 0, 1);
  b.write(0x1600, 1, 0x60400010, 4);
  b.write(0x1600, 2, 0x68400010, 4);
  b.write(0x1600, 0, 2, 1);
  b.write(0x1400, 1, 0x00000201, 4);
  b.write(0x1800, 1, 0x80000181, 4);
  b.write(0x1800, 2, 1, 1);
  b.write(0x1A00, 0, 0, 1);
  b.write(0x1A00, 1, 0x60410010, 4);
  b.write(0x1A00, 2, 0x68410010, 4);
  b.write(0x1A00, 3, 0x68640020, 4);
  b.write(0x1A00, 0, 3, 1);
  b.write(0x1800, 1, 0x00000181, 4);
  b.nmt(0x01);
  b.frame(0x201, {0x06, 0x00, 0x00, 0x00});
  b.sync();
  EXPECT_THAT(b.last(0x181), ElementsAre(0x31, 0x02, 0x50, 0x02, 0x00, 0x00, 0x00, 0x00));
  b.frame(0x201, {0x06, 0x00, 0x06, 0x00});
  b.sync();
  EXPECT_THAT(b.last(0x181), ElementsAre(0x31, 0x02, 0x31, 0x02, 0x00, 0x00, 0x00, 0x00));
}

TEST(SeveralAxes, SyncMovesBothAlongTheirTargets) {
  DualBench b;
  b.write(0x6060, 0, 8, 1);
  b.write(0x6860, 0, 8, 1);
  b.write(0x1440, 1, 0x00000281, 4);  // RPDO 65: 6840h
  b.write(0x1442, 1, 0x00000481, 4);  // RPDO 67: 6840h, 687Ah
  b.nmt(0x01);
  b.enable();
  b.frame(0x281, {0x06, 0x00});
  b.frame(0x281, {0x07, 0x00});
  b.frame(0x281, {0x0F, 0x00});
  for (int i = 1; i <= 100; ++i) {
    const auto counts = static_cast<std::uint32_t>(i * 100);
    b.frame(0x401, {0x0F, 0x00, b.low(counts), b.high(counts), 0x00, 0x00});
    b.frame(0x481, {0x0F, 0x00, b.low(2 * counts), b.high(2 * counts), 0x00, 0x00});
    b.sync();
    b.run(ms(4));
  }
  b.run(ms(200));
  EXPECT_EQ(b.read(0x6064), 10000U);
  EXPECT_EQ(b.read(0x6864), 20000U);
}

TEST(SeveralAxes, StoreTheirParametersTogetherAndNotWhileOneIsEnabled) {
  DualBench b;
  b.write(0x6083, 0, 1111, 4);
  b.write(0x6883, 0, 2222, 4);
  b.write(0x687A, 0, 3333, 4);
  b.enableSecond();
  EXPECT_EQ(b.abortOf({0x23, 0x10, 0x10, 0x01, 0x73, 0x61, 0x76, 0x65}), 0x08000022U);
  b.controlSecond(0x0000);
  EXPECT_EQ(b.sdo({0x23, 0x10, 0x10, 0x01, 0x73, 0x61, 0x76, 0x65})[0], 0x60);
  b.drive->powerOff(b.now);
  b.drive->powerOn(b.now);
  b.run(ms(100));
  EXPECT_EQ(b.read(0x6083), 1111U);
  EXPECT_EQ(b.read(0x6883), 2222U);
  EXPECT_EQ(b.read(0x687A), 0U) << "set-points are never stored";
}

TEST(SeveralAxes, HaveADictionaryThatSaysSoAndEndsWithTheLast) {
  DualBench b;
  EXPECT_EQ(b.read(0x1000), 0xFFFF0192U);
  EXPECT_EQ(b.read(0x67FF), 0x00020192U);
  EXPECT_EQ(b.read(0x6FFF), 0x00020192U);
  EXPECT_EQ(b.abortOf({0x40, 0x40, 0x70, 0x00, 0, 0, 0, 0}), 0x06020000U);
  EXPECT_EQ(b.refusal(0x6860, 0, 5, 1), 0x06090030U) << "no such mode in the second axis either";
  EXPECT_EQ(b.refusal(0x6898, 0, 15, 1), 0x06090030U);
  EXPECT_EQ(b.drive->axisCount(), 2U);
}

TEST(SeveralAxes, HaveSwitchesOfTheirOwn) {
  const auto definition = loadDriveDefinition(cia402::test::configFolder() +
                                              "/simulated_drives/generic_cia402_dual.yaml");
  struct NoBus : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } bus;
  AxisMechanics second;
  second.initial_position = 0.25;
  second.negative_limit_switch = 0.5;
  Drive drive(definition.value(), 1, bus, {}, {}, {second});
  drive.powerOn(Time{});
  EXPECT_EQ(drive.dictionary().find({0x60FD, 0})->number, 0U);
  EXPECT_EQ(drive.dictionary().find({0x68FD, 0})->number, 1U);
  EXPECT_EQ(drive.truth(Time{}, 1).position_turns, 0.25);
  EXPECT_EQ(drive.mechanics(1).negative_limit_switch, 0.5);
}

std::string problemOf(const std::string& text) {
  const std::string path = testing::TempDir() + "several_axes_test.yaml";
  std::ofstream(path) << "dictionary: [[0x6040, 0, controlword, uint16, rw, rt, 0]]\n" << text;
  const auto loaded = loadDriveDefinition(path);
  std::remove(path.c_str());
  return loaded.ok() ? "" : loaded.error().message;
}

TEST(SeveralAxes, AreOneToEight) {
  EXPECT_EQ(problemOf("axes: 8\n"), "");
  EXPECT_THAT(problemOf("axes: 9\n"), HasSubstr("several_axes_test.yaml:2: axes: "));
  EXPECT_THAT(problemOf("axes: []\n"), HasSubstr("several_axes_test.yaml:2: axes: "));
  EXPECT_THAT(problemOf("axes: [{}, {colour: red}]\n"),
              HasSubstr("several_axes_test.yaml:2: axes[1]/colour: unknown key"));
  EXPECT_THAT(problemOf("axes: 2\nobjects: {save_zero: \"2003:01\"}\n"),
              HasSubstr("save_zero: a drive with several axes must have it in 6000h to 67FFh"));
}

}  // namespace
}  // namespace cia402::sim
