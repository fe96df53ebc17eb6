// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/traffic_meter.h"

#include <gtest/gtest.h>

namespace cia402::can {
namespace {

using namespace std::chrono_literals;

LinkSettings counted(std::uint64_t frames_received, std::uint64_t bytes_received,
                     std::uint64_t frames_sent, std::uint64_t bytes_sent,
                     const std::string& kind = "can") {
  LinkSettings link;
  link.kind = kind;
  link.traffic = LinkSettings::Traffic{frames_received, frames_sent, bytes_received, bytes_sent};
  return link;
}

const Time kStart{5s};

TEST(TrafficMeter, CountsTheBitsOfAllFramesOfTheLastSecond) {
  TrafficMeter meter(1e6);
  meter.update(counted(700, 5000, 300, 100), kStart);
  EXPECT_FALSE(meter.load());
  // 1000 frames of 8 bytes received, 500 without data sent: 1000 * 111 + 500 * 47 bits, and with
  // stuff bits 1000 * 135 + 500 * 55.
  meter.update(counted(1700, 13000, 800, 100), kStart + 1s);
  ASSERT_TRUE(meter.load());
  EXPECT_NEAR(meter.load()->nominal, 0.1345, 1e-9);
  EXPECT_NEAR(meter.load()->most, 0.1625, 1e-9);
}

TEST(TrafficMeter, TakesTheTrueTimeThatHasPassed) {
  TrafficMeter meter(1e6);
  meter.update(counted(0, 0, 0, 0), kStart);
  meter.update(counted(100, 0, 0, 0), kStart + 900ms);
  EXPECT_FALSE(meter.load()) << "no full second yet";
  meter.update(counted(1000, 0, 0, 0), kStart + 2s);
  EXPECT_NEAR(meter.load()->nominal, 0.0235, 1e-9);
}

TEST(TrafficMeter, OfAVirtualInterfaceCountsEachFrameOnce) {
  TrafficMeter meter(1e6);
  meter.update(counted(0, 0, 0, 0, "vcan"), kStart);
  meter.update(counted(1000, 8000, 1000, 8000, "vcan"), kStart + 1s);
  EXPECT_NEAR(meter.load()->nominal, 0.111, 1e-9);
}

TEST(TrafficMeter, BeginsAnewWhereTheCountersDo) {
  TrafficMeter meter(1e6);
  meter.update(counted(5000, 40000, 0, 0), kStart);
  meter.update(counted(10, 80, 0, 0), kStart + 1s);
  EXPECT_FALSE(meter.load()) << "the interface was removed and created again";
  meter.update(counted(1010, 8080, 0, 0), kStart + 2s);
  EXPECT_NEAR(meter.load()->nominal, 0.111, 1e-9);
  meter.update(LinkSettings(), kStart + 3s);
  EXPECT_FALSE(meter.load()) << "the kernel does not count";
}

}  // namespace
}  // namespace cia402::can
