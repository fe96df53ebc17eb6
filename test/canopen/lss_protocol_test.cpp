// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

using test::frame;
using test::text;

constexpr lss::Identity kServo{0x0000ABCD, 0x000D0117, 0x00010002, 12345};

TEST(LssProtocol, SwitchesGloballyToWaitingAndToConfiguration) {
  EXPECT_EQ(text(lss::switchGlobal(lss::State::waiting)), "7E5 04 00 00 00 00 00 00 00");
  EXPECT_EQ(text(lss::switchGlobal(lss::State::configuration)), "7E5 04 01 00 00 00 00 00 00");
}

TEST(LssProtocol, SelectsByFourNumbers) {
  const auto frames = lss::switchSelective(kServo);
  EXPECT_EQ(text(frames[0]), "7E5 40 CD AB 00 00 00 00 00");
  EXPECT_EQ(text(frames[1]), "7E5 41 17 01 0D 00 00 00 00");
  EXPECT_EQ(text(frames[2]), "7E5 42 02 00 01 00 00 00 00");
  EXPECT_EQ(text(frames[3]), "7E5 43 39 30 00 00 00 00 00");
}

TEST(LssProtocol, InquiresIdentityAndNodeId) {
  EXPECT_EQ(text(lss::inquire(0)), "7E5 5A 00 00 00 00 00 00 00");
  EXPECT_EQ(text(lss::inquire(1)), "7E5 5B 00 00 00 00 00 00 00");
  EXPECT_EQ(text(lss::inquire(2)), "7E5 5C 00 00 00 00 00 00 00");
  EXPECT_EQ(text(lss::inquire(3)), "7E5 5D 00 00 00 00 00 00 00");
  EXPECT_EQ(text(lss::inquireNodeId()), "7E5 5E 00 00 00 00 00 00 00");
  EXPECT_EQ(lss::numberOf(frame("7E4 5D 39 30 00 80 00 00 00")), 0x80003039u);
  EXPECT_EQ(lss::numberOf(frame("7E4 5D 39 30 00 80 FF FF FF")), 0x80003039u) << "four bytes";
  EXPECT_EQ(lss::nodeIdOf(frame("7E4 5E FF 00 00 00 00 00 00")), lss::kUnconfigured);
}

TEST(LssProtocol, ConfiguresNodeIdBitTimingAndStores) {
  EXPECT_EQ(text(lss::configureNodeId(5)), "7E5 11 05 00 00 00 00 00 00");
  EXPECT_EQ(text(lss::configureBitTiming(3)), "7E5 13 00 03 00 00 00 00 00");
  EXPECT_EQ(text(lss::activateBitTiming(1000)), "7E5 15 E8 03 00 00 00 00 00");
  EXPECT_EQ(text(lss::store()), "7E5 17 00 00 00 00 00 00 00");
}

TEST(LssProtocol, AsksFastscanQuestions) {
  EXPECT_EQ(text(lss::fastscan(0, lss::kFastscanStart, 0, 0)), "7E5 51 00 00 00 00 80 00 00");
  EXPECT_EQ(text(lss::fastscan(0x000D0100, 8, 1, 1)), "7E5 51 00 01 0D 00 08 01 01");
  EXPECT_EQ(text(lss::fastscan(12345, 0, 3, 0)), "7E5 51 39 30 00 00 00 03 00");
}

TEST(LssProtocol, TellsErrorsInWords) {
  EXPECT_FALSE(lss::errorOf(frame("7E4 11 00 00 00 00 00 00 00")));
  EXPECT_EQ(lss::errorOf(frame("7E4 11 01 00 00 00 00 00 00")), "error 1 (node-ID out of range)");
  EXPECT_EQ(lss::errorOf(frame("7E4 13 01 00 00 00 00 00 00")),
            "error 1 (bit timing not supported)");
  EXPECT_EQ(lss::errorOf(frame("7E4 17 01 00 00 00 00 00 00")),
            "error 1 (the device cannot store its LSS settings)");
  EXPECT_EQ(lss::errorOf(frame("7E4 17 02 00 00 00 00 00 00")),
            "error 2 (the storage medium cannot be accessed)");
  EXPECT_EQ(lss::errorOf(frame("7E4 17 FF 07 00 00 00 00 00")), "error 255 (of the maker: 7)");
  EXPECT_EQ(lss::errorOf(frame("7E4 11 09 00 00 00 00 00 00")), "error 9 (unknown to CiA 305)");
}

TEST(LssProtocol, KnowsTheBitTimingTable) {
  EXPECT_EQ(lss::bitTimingIndex(1000), 0);
  EXPECT_EQ(lss::bitTimingIndex(800), 1);
  EXPECT_EQ(lss::bitTimingIndex(500), 2);
  EXPECT_EQ(lss::bitTimingIndex(250), 3);
  EXPECT_EQ(lss::bitTimingIndex(125), 4);
  EXPECT_EQ(lss::bitTimingIndex(50), 6) << "5 is reserved";
  EXPECT_EQ(lss::bitTimingIndex(20), 7);
  EXPECT_EQ(lss::bitTimingIndex(10), 8);
  EXPECT_FALSE(lss::bitTimingIndex(100));
  EXPECT_EQ(lss::bitRates(), "1000, 800, 500, 250, 125, 50, 20 or 10");
}

TEST(LssProtocol, TellsAnIdentityInWords) {
  EXPECT_EQ(toString(kServo),
            "vendor 0x0000ABCD, product 0x000D0117, revision 0x00010002, serial 12345 "
            "(0x00003039)");
}

}  // namespace
}  // namespace cia402::canopen
