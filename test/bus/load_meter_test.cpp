// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/load_meter.h"

#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;

struct CountingSink : can::Sink {
  bool send(const can::Frame&) override {
    ++count;
    return takes;
  }
  int count = 0;
  bool takes = true;
};

struct LoadMeterTest : testing::Test {
  LoadMeterTest() { meter.update(start); }
  double loadAfter(Duration duration) {
    meter.update(start + duration);
    return meter.load();
  }
  const Time start{100s};
  CountingSink sink;
  LoadMeter meter{sink, 1000.0};  // bit/s
};

// ISO 11898-1 without stuff bits: SOF 1, identifier 11, RTR 1, IDE 1, r0 1, DLC 4, CRC 15 + 1,
// ACK 1 + 1, EOF 7, intermission 3.
TEST_F(LoadMeterTest, CountsAFrameWithoutDataAs47Bits) {
  meter.count(can::Frame(0x80, {}));
  EXPECT_DOUBLE_EQ(loadAfter(1s), 0.047);
}

TEST_F(LoadMeterTest, CountsAFrameWithEightBytesAs111Bits) {
  meter.count(can::Frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_DOUBLE_EQ(loadAfter(1s), 0.111);
}

// 34 bits before the CRC delimiter and 64 of data may be stuffed, one after each four but the first
// five: 24.
TEST_F(LoadMeterTest, TellsWhatStuffBitsMayAdd) {
  meter.count(can::Frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
  meter.update(start + 1s);
  EXPECT_DOUBLE_EQ(meter.mostLoad(), 0.135);
  meter.update(start + 2s);
  EXPECT_DOUBLE_EQ(meter.mostLoad(), 0.0);
}

// 20 bits more: 18 of the identifier, SRR, r1.
TEST_F(LoadMeterTest, CountsAnExtendedFrameWithOneByteAs75Bits) {
  can::Frame frame(0x12345, {1});
  frame.extended = true;
  meter.count(frame);
  EXPECT_DOUBLE_EQ(loadAfter(1s), 0.075);
}

TEST_F(LoadMeterTest, CountsNoDataOfARemoteFrame) {
  can::Frame frame(0x701, {0, 0, 0, 0});
  frame.remote = true;
  meter.count(frame);
  EXPECT_DOUBLE_EQ(loadAfter(1s), 0.047);
}

TEST_F(LoadMeterTest, DoesNotCountErrorFrames) {
  can::Frame frame(0x4, {0, 0, 0, 0, 0, 0, 0, 0});
  frame.error = true;
  meter.count(frame);
  EXPECT_DOUBLE_EQ(loadAfter(1s), 0.0);
}

TEST_F(LoadMeterTest, CountsWhatTheInterfaceTookAndPassesItOn) {
  EXPECT_TRUE(meter.send(can::Frame(0x80, {})));
  sink.takes = false;
  EXPECT_FALSE(meter.send(can::Frame(0x80, {})));
  EXPECT_EQ(sink.count, 2);
  EXPECT_DOUBLE_EQ(loadAfter(1s), 0.047);
}

TEST_F(LoadMeterTest, KeepsTheLoadUntilASecondIsOverAndThenForgetsIt) {
  meter.count(can::Frame(0x80, {}));
  EXPECT_DOUBLE_EQ(loadAfter(999ms), 0.0);
  EXPECT_DOUBLE_EQ(loadAfter(2s), 0.0235);  // 47 bits in 2 s
  EXPECT_DOUBLE_EQ(loadAfter(2999ms), 0.0235);
  EXPECT_DOUBLE_EQ(loadAfter(3s), 0.0);
}

}  // namespace
}  // namespace cia402::bus
