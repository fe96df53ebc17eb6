// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/value_text.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "decode/decode_fixture.h"

namespace cia402::decode {
namespace {

using fieldbus::Bytes;

ValueText valuesOf(const std::string& axis) {
  const config::RobotConfig robot = test::robot();
  const auto found = std::find_if(robot.axes.begin(), robot.axes.end(),
                                  [&](const drive::AxisConfig& a) { return a.name == axis; });
  return ValueText(*found);
}

TEST(ValueText, NumbersAreInTheUnitsOfTheJoint) {
  const ValueText values = valuesOf("slide");
  EXPECT_EQ(values.describe({0x6064, 0}, 0xFFFF9E58, 32), "-0.25 m (-25000)");
  EXPECT_EQ(values.describe({0x6079, 0}, 48500, 32), "48.5 V (48500)");
  EXPECT_EQ(values.describe({0x6066, 0}, 20, 16), "0.02 s (20)");
}

TEST(ValueText, FloatsAreShownAsWhatTheyCarry) {
  const ValueText values = valuesOf("gripper");
  const drive::ObjectSpec* target = values.axis().profile->find("target_position");
  ASSERT_NE(target, nullptr);
  ASSERT_EQ(target->encoding, drive::Encoding::float32);
  EXPECT_EQ(values.describe(target->id, 0xBFC00000, 32), "-1.5 rad");
}

TEST(ValueText, AFloatThatNothingNamesIsOneByItsPlace) {
  const ValueText values = valuesOf("gripper");
  EXPECT_EQ(values.describe({0x200A, 3}, 0x42C80000, 32), "100");
  EXPECT_EQ(values.describe({0x200A, 3}, Bytes{0x00, 0x00, 0xC8, 0x42}), "100");
  EXPECT_EQ(values.describe({0x200A, 0}, Bytes{0x08}), "8") << "the number of sub-indices";
}

TEST(ValueText, WithoutARatedTorqueTheDevicesNumberIsShown) {
  EXPECT_EQ(valuesOf("slide").describe({0x6077, 0}, 0xFF06, 16), "-250 (0xFF06)");
}

TEST(ValueText, ObjectsWithoutAUnitAreDecimalAndHexadecimal) {
  const ValueText values = valuesOf("shoulder");
  EXPECT_EQ(values.describe({0x60FD, 0}, 0x00010000, 32), "65536 (0x00010000)");
  EXPECT_EQ(values.describe({0x2345, 1}, 7, 8), "7");
  EXPECT_EQ(values.describe({0x2345, 1}, 0xFF, 8), "255 (0xFF)");
  EXPECT_EQ(values.describe({0x6041, 0}, 0x37, 8), "55 (0x37)") << "not as wide as the object";
}

TEST(ValueText, BytesAreTextOrHexadecimal) {
  EXPECT_EQ(bytesText({}), "nothing");
  EXPECT_EQ(bytesText({'D', 'M'}), "\"DM\"");
  EXPECT_EQ(bytesText({0x00, 0xAB}), "00 AB");
  EXPECT_EQ(bytesText(Bytes(33, 'x')), "\"" + std::string(32, 'x') + "\"...");
}

// VISIBLE_STRINGs by CiA 301, 7.5.2.8 to 7.5.2.10.
TEST(ValueText, NamesAndVersionsAreTextsHoweverShort) {
  const ValueText values = valuesOf("shoulder");
  EXPECT_EQ(values.describe({0x1008, 0}, Bytes{'D', 'M'}), "\"DM\"");
  EXPECT_EQ(values.describe({0x1009, 0}, Bytes{'A'}), "\"A\"");
  EXPECT_EQ(values.describe({0x100A, 0}, Bytes{'1', '.', '0', '2'}), "\"1.02\"");
  EXPECT_EQ(values.describe({0x100A, 0}, Bytes{'1', '.', '0', 0}), "\"1.0\"") << "padded as in C";
  EXPECT_EQ(values.describe({0x1008, 1}, Bytes{2}), "2") << "no such object";
}

TEST(ValueText, TitlesHoldTheName) {
  const ValueText values = valuesOf("shoulder");
  EXPECT_EQ(values.title({0x6041, 0}), "6041:00 statusword");
  EXPECT_EQ(values.title({0x1017, 0}), "1017:00 producer heartbeat time");
  EXPECT_EQ(values.title({0x2345, 1}), "2345:01");
}

TEST(ValueText, CommandsOfTheControlwordAreThoseOfTheTable) {
  // CiA 402-2, table "command coding".
  EXPECT_EQ(controlwordText(0x0006, nullptr), "0x0006 shutdown");
  EXPECT_EQ(controlwordText(0x0007, nullptr), "0x0007 switch on");
  EXPECT_EQ(controlwordText(0x000F, nullptr), "0x000F enable operation");
  EXPECT_EQ(controlwordText(0x0000, nullptr), "0x0000 disable voltage");
  EXPECT_EQ(controlwordText(0x0002, nullptr), "0x0002 quick stop");
  EXPECT_EQ(controlwordText(0x0080, nullptr), "0x0080 fault reset");
  EXPECT_EQ(controlwordText(0x010F, nullptr), "0x010F enable operation; halt");
  EXPECT_EQ(controlwordText(0x003F, nullptr), "0x003F enable operation; bit 4, bit 5");
}

TEST(ValueText, TheStatuswordIsItsStateAndTheBitsBeyond) {
  EXPECT_EQ(statuswordText(0x0250, nullptr, {}),
            "0x0250 switch on disabled; voltage enabled, remote");
  EXPECT_EQ(statuswordText(0x0218, nullptr, {}), "0x0218 fault; voltage enabled, remote");
  EXPECT_EQ(statuswordText(0x1C27, nullptr, {}),
            "0x1C27 operation enabled; target reached, internal limit active, bit 12");
  EXPECT_EQ(statuswordText(0x0000, nullptr, {}), "0x0000 not ready to switch on");
}

TEST(ValueText, ModesAndErrorsHaveNames) {
  const ValueText values = valuesOf("shoulder");
  const drive::DriveProfile& profile = *values.axis().profile;
  EXPECT_EQ(modeText(8, profile), "8 cyclic_position");
  EXPECT_EQ(modeText(0, profile), "0 no mode");
  EXPECT_EQ(modeText(-77, profile), "-77 unknown to the profile");
  EXPECT_EQ(errorText(0, profile), "0x0000 none");
  EXPECT_EQ(errorText(0x7305, profile), "0x7305 incremental sensor 1 fault");
  EXPECT_EQ(errorText(0x8240, profile), "0x8240 unexpected SYNC data length");
}

}  // namespace
}  // namespace cia402::decode
