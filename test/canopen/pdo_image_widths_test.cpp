// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Values that are narrower on the wire, that come without a PDO, or later at first than afterwards.
#include <gtest/gtest.h>

#include "canopen/pdo/image.h"

namespace cia402::canopen {
namespace {

using namespace std::chrono_literals;
using fieldbus::Encoding;

constexpr ObjectId kWord{0x6041, 0}, kTorque{0x6077, 0}, kPlace{0x6064, 0}, kWanted{0x6071, 0};

PdoConfig tpdoOf(std::vector<PdoEntry> entries) {
  PdoConfig pdo;
  pdo.direction = PdoDirection::tpdo;
  pdo.cob_id = 0x181;
  pdo.entries = std::move(entries);
  return pdo;
}

PdoConfig rpdoOf(std::vector<PdoEntry> entries) {
  PdoConfig pdo = tpdoOf(std::move(entries));
  pdo.direction = PdoDirection::rpdo;
  pdo.cob_id = 0x201;
  return pdo;
}

can::Frame frameOf(std::vector<std::uint8_t> bytes) {
  can::Frame frame;
  frame.id = 0x181;
  frame.size = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) frame.data[i] = bytes[i];
  return frame;
}

const std::vector<HalfFloat> kKnown = {{kTorque, "torque", Encoding::bfloat16},
                                       {kWanted, "wanted", Encoding::bfloat16}};

TEST(PdoImageWidths, OfHalfFloatsAreThoseOfTheDriveAndTheRestMovesUp) {
  PdoImage image({tpdoOf({{kTorque, 32, ""}, {kWord, 16, ""}}),
                  rpdoOf({{kWanted, 32, ""}, {kPlace, 16, ""}})});
  HalfFloats halves;
  halves.add(kKnown[0]);
  halves.add(kKnown[1]);
  image.setHalfFloats(kKnown, halves);
  EXPECT_EQ(image.tpdos()[0].size, 4);
  EXPECT_TRUE(image.receive(0, frameOf({0xC0, 0xBF, 0x37, 0x02}), Time(1s)));
  EXPECT_EQ(image.input(image.inputSlot(kTorque)).raw, 0xBFC00000U) << "-1.5";
  EXPECT_EQ(image.input(image.inputSlot(kWord)).raw, 0x0237U);
  image.setOutput(image.outputSlot(kWanted), 0x40200000);  // 2.5
  image.setOutput(image.outputSlot(kPlace), 0x1234);
  can::Frame sent;
  image.pack(0, sent);
  EXPECT_EQ(sent.size, 4);
  EXPECT_EQ(sent.data[0], 0x20);
  EXPECT_EQ(sent.data[1], 0x40);
  EXPECT_EQ(sent.data[2], 0x34);
  EXPECT_EQ(sent.data[3], 0x12);
}

TEST(PdoImageWidths, AreThoseOf32BitsAgainForAnotherDrive) {
  PdoImage image({tpdoOf({{kTorque, 32, ""}, {kWord, 16, ""}})});
  HalfFloats halves;
  halves.add(kKnown[0]);
  image.setHalfFloats(kKnown, halves);
  halves.clear();
  image.setHalfFloats(kKnown, halves);
  EXPECT_EQ(image.tpdos()[0].size, 6);
  EXPECT_TRUE(image.receive(0, frameOf({0x00, 0x00, 0xC0, 0xBF, 0x37, 0x02}), Time(1s)));
  EXPECT_EQ(image.input(image.inputSlot(kTorque)).raw, 0xBFC00000U);
  EXPECT_EQ(image.input(image.inputSlot(kWord)).raw, 0x0237U);
}

TEST(PdoImageWidths, StandBesideEntriesThatAreLeftOut) {
  PdoImage image({tpdoOf({{kPlace, 16, ""}, {kTorque, 32, ""}, {kWord, 16, ""}})});
  HalfFloats halves;
  halves.add(kKnown[0]);
  image.setHalfFloats(kKnown, halves);
  image.leaveOut(PdoDirection::tpdo, 1, kPlace);
  EXPECT_EQ(image.tpdos()[0].size, 4);
  EXPECT_TRUE(image.receive(0, frameOf({0x80, 0x3F, 0x21, 0x00}), Time(1s)));
  EXPECT_EQ(image.input(image.inputSlot(kTorque)).raw, 0x3F800000U);
  EXPECT_EQ(image.input(image.inputSlot(kWord)).raw, 0x21U);
  image.includeAll();
  EXPECT_EQ(image.tpdos()[0].size, 6);
}

TEST(PdoImageAlone, AValueIsFreshUntilItStaysAway) {
  PdoConfig alone = tpdoOf({{kPlace, 32, ""}});
  alone.cob_id = 0;
  alone.transmission = 255;
  alone.event_timer = 20;
  alone.stale_after = 10;
  PdoImage image({alone});
  const fieldbus::Slot slot = image.inputSlot(kPlace);
  EXPECT_FALSE(image.fresh(slot));
  image.takeAlone(0, 77, Time(1s));
  EXPECT_TRUE(image.fresh(slot));
  EXPECT_EQ(image.input(slot).raw, 77U);
  image.age(Time(1s + 200ms));
  EXPECT_TRUE(image.fresh(slot));
  image.age(Time(1s + 201ms));
  EXPECT_FALSE(image.fresh(slot));
  image.takeAlone(0, 78, Time(2s));
  EXPECT_TRUE(image.fresh(slot));
}

// With a SYNC start value the first may take a turn of the counter more.
TEST(PdoImageStart, TheFirstMayTakeLonger) {
  PdoConfig slow = tpdoOf({{kPlace, 32, ""}});
  slow.transmission = 4;
  slow.stale_after = 2;
  slow.sync_start_wait = 100;
  PdoImage image({slow});
  for (int i = 0; i < 108; ++i) image.age(Time(1s + i * 1ms));
  EXPECT_FALSE(image.tpdos()[0].stale);
  image.age(Time(2s));
  EXPECT_TRUE(image.tpdos()[0].stale);
  EXPECT_TRUE(image.receive(0, frameOf({1, 0, 0, 0}), Time(3s)));
  for (int i = 0; i < 8; ++i) image.age(Time(3s + i * 1ms));
  EXPECT_FALSE(image.tpdos()[0].stale);
  image.age(Time(4s));
  EXPECT_TRUE(image.tpdos()[0].stale) << "as soon as others from then on";
  image.invalidate();
  for (int i = 0; i < 108; ++i) image.age(Time(5s + i * 1ms));
  EXPECT_FALSE(image.tpdos()[0].stale);
}

}  // namespace
}  // namespace cia402::canopen
