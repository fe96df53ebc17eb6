// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/link_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

namespace cia402::can {
namespace {

using testing::AllOf;
using testing::HasSubstr;

LinkSettings good() {
  LinkSettings link;
  link.name = "can0";
  link.kind = "can";
  link.up = link.carrier = link.real_controller = true;
  link.tx_queue_length = 10;
  link.bitrate = 1'000'000;
  link.restart_ms = 100;
  link.controller = BusState::error_active;
  return link;
}

std::vector<LinkFinding> find(const LinkSettings& link, bool may_restart = true) {
  return findingsOf(link, 1'000'000, std::chrono::milliseconds(4), may_restart);
}

TEST(FindingsOf, GoodSettingsAreNone) { EXPECT_TRUE(find(good()).empty()); }

TEST(FindingsOf, AVirtualInterfaceAreNone) {
  LinkSettings link;
  link.name = "vcan0";
  link.kind = "vcan";
  link.tx_queue_length = 10;
  EXPECT_TRUE(find(link, false).empty());
}

TEST(FindingsOf, AnotherBitRateIsAnErrorWithBothRates) {
  LinkSettings link = good();
  link.bitrate = 500'000;
  const auto findings = find(link);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_TRUE(findings[0].error);
  EXPECT_THAT(findings[0].text,
              AllOf(HasSubstr("can0 runs at 500000 bit/s"), HasSubstr("bus/bitrate 1000000"),
                    HasSubstr("ip link set can0 up type can bitrate 1000000")));
}

TEST(SamplePoint, FarFromThoseOfTheDevicesIsToldWithBothAndTheRemedy) {
  LinkSettings link = good();
  const SamplePoints devices{"shoulder, elbow (sv660c)", {0.8, 0.7}};
  link.sample_point = 0.875;
  const auto finding = samplePointFinding(link, 1'000'000, devices);
  ASSERT_TRUE(finding);
  EXPECT_FALSE(finding->error);
  EXPECT_THAT(finding->text,
              AllOf(HasSubstr("can0 reads a bit at 87.5 % of its time, shoulder, elbow (sv660c) at "
                              "80 % or 70 %"),
                    HasSubstr("ip link set can0 down; ip link set can0 up type can bitrate 1000000 "
                              "sample-point 0.800`")));
  link.sample_point = 0.6;
  EXPECT_TRUE(samplePointFinding(link, 1'000'000, devices));
}

TEST(SamplePoint, NearOneOfThoseOfTheDevicesIsWell) {
  LinkSettings link = good();
  const SamplePoints devices{"joint (sv660c)", {0.8, 0.7}};
  for (const double point : {0.65, 0.7, 0.75, 0.8, 0.85}) {
    link.sample_point = point;
    EXPECT_FALSE(samplePointFinding(link, 1'000'000, devices)) << point;
  }
  link.sample_point = 0.95;
  EXPECT_FALSE(samplePointFinding(link, 1'000'000, {"joint (generic)", {}})) << "nothing is wanted";
  link.sample_point.reset();
  EXPECT_FALSE(samplePointFinding(link, 1'000'000, devices)) << "nothing is known";
}

TEST(FindingsOf, ListenOnlyAndOneShotAreTold) {
  LinkSettings link = good();
  link.listen_only = true;
  ASSERT_EQ(find(link).size(), 1u);
  EXPECT_TRUE(find(link)[0].error);
  link = good();
  link.one_shot = true;
  ASSERT_EQ(find(link).size(), 1u);
  EXPECT_FALSE(find(link)[0].error);
}

TEST(FindingsOf, ABusOffThatNobodyEndsIsTold) {
  LinkSettings link = good();
  link.restart_ms = 0;
  EXPECT_TRUE(find(link, true).empty()) << "the driver restarts it";
  const auto findings = find(link, false);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0].text, AllOf(HasSubstr("stays off after bus-off"),
                                      HasSubstr("restart-ms 100"), HasSubstr("CAP_NET_ADMIN")));
  link.real_controller = false;
  ASSERT_EQ(find(link, true).size(), 1u);
  EXPECT_THAT(find(link, true)[0].text, HasSubstr("ip link set can0 down; ip link set can0 up"));
}

TEST(FindingsOf, ASlowRestartIsTold) {
  LinkSettings link = good();
  link.restart_ms = 1000;
  EXPECT_TRUE(find(link).empty());
  link.restart_ms = 1001;
  EXPECT_EQ(find(link).size(), 1u);
}

TEST(FindingsOf, ALongQueueIsToldWithTheAgeOfItsFrames) {
  LinkSettings link = good();
  link.tx_queue_length = 100;
  EXPECT_TRUE(find(link).empty());
  link.tx_queue_length = 1000;
  ASSERT_EQ(find(link).size(), 1u);
  // 1000 frames of 135 bits at 1 Mbit/s
  EXPECT_THAT(find(link)[0].text,
              AllOf(HasSubstr("1000 frames"), HasSubstr("135 ms"), HasSubstr("txqueuelen 10")));
}

TEST(LinkReader, KnowsNoInterfaceOfAnImpossibleName) {
  const LinkReader reader;
  EXPECT_FALSE(reader.read(""));
  EXPECT_FALSE(reader.read("a-name-that-is-too-long"));
  EXPECT_FALSE(reader.read("nosuchcan"));
}

TEST(LinkReader, ReadsTheLoopbackInterfaceAsOneWithoutAController) {
  const LinkReader reader;
  const auto link = reader.read("lo");
  ASSERT_TRUE(link);
  EXPECT_EQ(link->name, "lo");
  EXPECT_EQ(link->index, 1);
  EXPECT_FALSE(link->controller);
  EXPECT_EQ(reader.restart(*link), EOPNOTSUPP);
}

}  // namespace
}  // namespace cia402::can
