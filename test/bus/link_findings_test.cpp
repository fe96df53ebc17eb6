// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/link_findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "folders.h"

namespace cia402::bus {
namespace {

using testing::AllOf;
using testing::HasSubstr;

config::RobotConfig robotAt(const std::string& bitrate) {
  const std::string motor =
      ", drive: sv660c, counts_per_turn: 100000, gear_ratio: 50.0, rated_torque: 2.39, write: "
      "[{object: gear_numerator, raw: 262144}, {object: gear_denominator, raw: 3125}]}\n";
  Problems problems;
  const config::RobotConfig robot = config::loadRobot(
      YAML::Load("bus: {interface: can0, sync_period: 0.01, heartbeat: 0.1, bitrate: " + bitrate +
                 "}\naxes:\n  shoulder: {node_id: 1" + motor + "  elbow: {node_id: 2" + motor +
                 "  wrist: {node_id: 3, drive: generic_cia402, counts_per_turn: 4096}\n"),
      config::profilesIn({cia402::test::configFolder() + "/drives"}), problems);
  EXPECT_TRUE(problems.empty()) << problems.text();
  return robot;
}

can::LinkSettings linkAt(std::uint32_t bitrate, double sample_point) {
  can::LinkSettings link;
  link.name = "can0";
  link.kind = "can";
  link.bitrate = bitrate;
  link.sample_point = sample_point;
  return link;
}

// H0C.08 = 6: 80 %, 7: 70 % [L9301-9307].
TEST(Sv660cSamplePoint, OfTheInterfaceIsComparedAtOneMegabit) {
  const config::RobotConfig robot = robotAt("1000000");
  const auto findings = linkFindings(linkAt(1'000'000, 0.875), robot, true);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_FALSE(findings[0].error);
  EXPECT_THAT(findings[0].text,
              AllOf(HasSubstr("87.5 %"), HasSubstr("shoulder, elbow (sv660c) at 80 % or 70 %"),
                    HasSubstr("bitrate 1000000 sample-point 0.800")));
  EXPECT_TRUE(linkFindings(linkAt(1'000'000, 0.75), robot, true).empty());
}

TEST(Sv660cSamplePoint, OfOtherBitRatesIsTheirOwnMatter) {
  EXPECT_TRUE(linkFindings(linkAt(500'000, 0.95), robotAt("500000"), true).empty());
}

TEST(LinkFindings, AWrongBitRateIsToldAlone) {
  const auto findings = linkFindings(linkAt(500'000, 0.875), robotAt("1000000"), true);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_TRUE(findings[0].error);
  EXPECT_THAT(findings[0].text, HasSubstr("runs at 500000 bit/s"));
}

}  // namespace
}  // namespace cia402::bus
