// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Node-ID and bit rate that are objects of the maker's own.
#include "drive_fixture.h"

namespace cia402::sim {
namespace {

struct OwnBusBench : DriveBench {
  OwnBusBench(const char* name, std::uint32_t bit_rate) : DriveBench(name) {
    drive->hangOn(bit_rate);
    run(ms(700));
  }
  void powerCycle() {
    drive->powerOff(now);
    sent.clear();
    drive->powerOn(now);
    run(ms(800));
  }
  /// A request for 1000h to that node is answered.
  bool answers(std::uint8_t node = 1) {
    const std::size_t before = sent.size();
    frame(0x600U + node, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    run(ms(5));
    return sent.size() > before && sent.back().id == 0x580U + node;
  }
  bool sentBootUp(std::uint32_t id) const {
    for (const can::Frame& frame : sent) {
      if (frame.id == id && frame.size == 1 && frame.data[0] == 0) return true;
    }
    return false;
  }
};

// 200Ch:03: 0 10 kbit/s ... 6 500 kbit/s ... 8 1 Mbit/s [373-386], from the next power-on [2599].
TEST(NimotionBitRate, CountsFromTheNextPowerOnOnceItIsSaved) {
  OwnBusBench bench("nimotion_stepper", 1'000'000);
  bench.write(0x200C, 3, 6, 2);
  bench.run(ms(500));
  EXPECT_TRUE(bench.answers()) << "not yet";
  bench.nmt(129);
  bench.run(ms(800));
  EXPECT_TRUE(bench.answers()) << "not yet";
  bench.powerCycle();
  EXPECT_TRUE(bench.answers()) << "it was not saved";
  bench.write(0x200C, 3, 6, 2);
  bench.frame(0x601, {0x23, 0x10, 0x10, 0x01, 0x73, 0x61, 0x76, 0x65});  // "save"
  bench.run(ms(2000));
  bench.powerCycle();
  EXPECT_TRUE(bench.sent.empty()) << "no boot-up message";
  EXPECT_FALSE(bench.answers());
  for (const std::uint32_t other :
       {10'000U, 20'000U, 50'000U, 100'000U, 125'000U, 250'000U, 800'000U}) {
    bench.drive->hangOn(other);
    bench.powerCycle();
    EXPECT_FALSE(bench.answers()) << other;
  }
  bench.drive->hangOn(500'000);
  bench.powerCycle();
  EXPECT_TRUE(bench.sentBootUp(0x701));
  EXPECT_TRUE(bench.answers());
  bench.frame(0x601, {0x23, 0x11, 0x10, 0x01, 0x6C, 0x6F, 0x61, 0x64});  // "load"
  bench.run(ms(2000));
  bench.powerCycle();
  EXPECT_FALSE(bench.answers()) << "the factory's is 1 Mbit/s [2599]";
}

TEST(NimotionBitRate, IsThatOfItsBusWhereSomebodyHasSetItUp) {
  const std::pair<std::uint32_t, std::uint64_t> codes[] = {
      {10'000, 0},  {20'000, 1},  {50'000, 2},  {100'000, 3},  {125'000, 4},
      {250'000, 5}, {500'000, 6}, {800'000, 7}, {1'000'000, 8}};
  const auto definition =
      loadDriveDefinition(cia402::test::configFolder() + "/simulated_drives/nimotion_stepper.yaml");
  ASSERT_TRUE(definition) << definition.error().message;
  struct NoBus : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } bus;
  for (const auto& [rate, code] : codes) {
    Drive drive(definition.value(), 1, bus, {});
    drive.hangOn(rate);
    EXPECT_EQ(drive.dictionary().find({0x200C, 3})->number, code) << rate;
  }
}

// H0C.08: at once [L9277].
TEST(Sv660cBitRate, CountsAsSoonAsTheWriteWasAnswered) {
  OwnBusBench bench("sv660c", 500'000);
  bench.write(0x200C, 9, 6, 2);
  bench.run(ms(5));
  EXPECT_FALSE(bench.answers());
  bench.drive->hangOn(1'000'000);
  bench.powerCycle();
  EXPECT_TRUE(bench.answers());
  bench.write(0x200C, 9, 7, 2);  // 1 Mbit/s, too, sampled earlier
  bench.run(ms(5));
  EXPECT_TRUE(bench.answers());
}

// H0C.00: at once [L9209]; how it changes over is not printed.
TEST(Sv660cNodeId, CountsAsSoonAsTheWriteWasAnswered) {
  OwnBusBench bench("sv660c", 500'000);
  bench.sent.clear();
  bench.write(0x200C, 1, 5, 2);
  bench.run(ms(800));
  EXPECT_TRUE(bench.sentBootUp(0x705));
  EXPECT_FALSE(bench.answers(1));
  EXPECT_TRUE(bench.answers(5));
  bench.powerCycle();
  EXPECT_TRUE(bench.answers(5)) << "H0C.13 is 1: it stays";
  // H0C.13 = 0, then H0C.00 = 9
  bench.frame(0x605, {0x2B, 0x0C, 0x20, 0x0E, 0, 0, 0, 0});
  bench.run(ms(5));
  bench.frame(0x605, {0x2B, 0x0C, 0x20, 0x01, 9, 0, 0, 0});
  bench.run(ms(800));
  EXPECT_TRUE(bench.answers(9));
  bench.powerCycle();
  EXPECT_TRUE(bench.answers(5)) << "that did not stay";
}

}  // namespace
}  // namespace cia402::sim
