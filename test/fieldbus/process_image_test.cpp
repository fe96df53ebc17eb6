// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/process_image.h"

#include <gtest/gtest.h>

namespace cia402::fieldbus {
namespace {

using std::chrono::milliseconds;

constexpr ObjectId kControlword{0x6040, 0}, kStatusword{0x6041, 0}, kTarget{0x607A, 0},
    kPosition{0x6064, 0};

/// A bus that a test plays by hand: one frame of 320 bits may bring all of it, as on EtherCAT.
struct Image : ProcessImage {
  using ProcessImage::addInput;
  using ProcessImage::addOutput;
  using ProcessImage::clear;
  using ProcessImage::countSent;
  using ProcessImage::leaveOutInput;
  using ProcessImage::leaveOutOutput;
  using ProcessImage::outdate;
  using ProcessImage::setCarrier;
  using ProcessImage::setDelivery;
  using ProcessImage::take;
  void sendAgain(Slot) override {}
};

TEST(ProcessImage, AnObjectHasOneSlotInEachDirection) {
  Image image;
  const Slot in = image.addInput(kPosition), out = image.addOutput(kPosition);
  EXPECT_EQ(image.addInput(kPosition), in);
  EXPECT_EQ(image.addOutput(kPosition), out);
  EXPECT_EQ(image.inputSlot(kPosition), in);
  EXPECT_NE(image.addInput(kStatusword), in);
  EXPECT_EQ(image.outputSlot(kStatusword), kNoSlot);
  EXPECT_FALSE(image.fresh(kNoSlot));
}

TEST(ProcessImage, AnInputIsUnknownUntilItComesAndAfterItWasForgotten) {
  Image image;
  const Slot slot = image.addInput(kStatusword);
  EXPECT_FALSE(image.input(slot).valid || image.fresh(slot));
  image.take(slot, 0x0237, Time(milliseconds(5)));
  EXPECT_TRUE(image.input(slot).valid && image.fresh(slot));
  EXPECT_EQ(image.input(slot).raw, 0x0237U);
  EXPECT_EQ(image.input(slot).stamp, Time(milliseconds(5)));
  image.outdate(slot);
  EXPECT_TRUE(image.input(slot).valid) << "what it was is known";
  EXPECT_FALSE(image.fresh(slot));
  image.take(slot, 0x0240, Time(milliseconds(9)));
  image.forget(slot);
  EXPECT_FALSE(image.input(slot).valid || image.fresh(slot));
}

TEST(ProcessImage, CountsWhatLeavesByItsCarrier) {
  Image image;
  const Slot controlword = image.addOutput(kControlword), target = image.addOutput(kTarget);
  image.setCarrier(controlword, 0);
  image.setCarrier(target, 1);
  image.countSent(1);
  image.countSent(1);
  EXPECT_EQ(image.sent(controlword), 0U);
  EXPECT_EQ(image.sent(target), 2U);
  EXPECT_EQ(image.carrierOf(target), 1U);
}

TEST(ProcessImage, WhatComesByTheCycleComesAsOftenAsTheCycleLetsIt) {
  Image image;
  const Slot position = image.addInput(kPosition), statusword = image.addInput(kStatusword);
  EXPECT_FALSE(image.regular(position));
  image.setDelivery(position, {true, 3, milliseconds(100)});
  EXPECT_TRUE(image.regular(position));
  EXPECT_EQ(image.interval(position, milliseconds(4)), milliseconds(12));
  image.setDelivery(statusword, {false, 0, milliseconds(7)});
  EXPECT_FALSE(image.regular(statusword));
  EXPECT_EQ(image.interval(statusword, milliseconds(4)), milliseconds(7));
}

TEST(ProcessImage, ClearingLeavesNothingThatCouldBeSentOrBelieved) {
  Image image;
  const Slot statusword = image.addInput(kStatusword), controlword = image.addOutput(kControlword);
  image.setCarrier(controlword, 0);
  image.take(statusword, 0x0237, Time(milliseconds(5)));
  image.setOutput(controlword, 0x000F);
  image.countSent(0);
  image.leaveOutInput(statusword, true);
  image.clear();
  EXPECT_EQ(image.output(controlword), 0U);
  EXPECT_FALSE(image.input(statusword).valid || image.fresh(statusword));
  EXPECT_EQ(image.sent(controlword), 1U) << "it did leave";
  EXPECT_TRUE(image.inputLeftOut(statusword));
  EXPECT_FALSE(image.outputLeftOut(controlword));
  image.leaveOutOutput(controlword, true);
  EXPECT_TRUE(image.outputLeftOut(controlword));
}

}  // namespace
}  // namespace cia402::fieldbus
