// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Objects that hold floats are floats under any name: judged by what the drive's dictionary holds.
#include "system/scene.h"

namespace cia402 {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr fieldbus::ObjectId kTemperatureLimit{0x200A, 3};  // MOSFET, nobody names it

class FloatObjects : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(scene.boot()) << scene.told(); }
  bus::Answer write(const std::string& object, const std::string& value) {
    return call(scene, bus::WriteObjectCommand{"joint", object, value});
  }
  std::uint64_t held(fieldbus::ObjectId id) {
    return scene.drive("joint").dictionary().find(id)->number;
  }
  Scene scene{loadText(damiaoJoint())};
};

TEST_F(FloatObjects, ANumberByIndexIsAFloatAndNotItsBits) {
  const auto written = write("200A:03", "-1");
  EXPECT_TRUE(written.success) << written.message;
  EXPECT_EQ(held(kTemperatureLimit), 0xBF800000u) << "-1.0, and not the bits of -1, which are NaN";
  ASSERT_TRUE(write("200A:03", "85.5").success);
  EXPECT_EQ(held(kTemperatureLimit), 0x42AB0000u);
  const auto read = call(scene, bus::ReadObjectCommand{"joint", "200A:03"});
  EXPECT_EQ(read.number, 85.5);
  EXPECT_EQ(read.text, "85.5");
}

TEST_F(FloatObjects, WhatIsNotFiniteLeavesForNoObjectByNoName) {
  for (const char* object : {"200A:03", "2005:01", "target_position", "607A:00", "6065"}) {
    for (const char* value :
         {"nan", "inf", "-inf", "1e39", "0xFFFFFFFF", "0x7FC00000", "0x7F800000", "0xFF800000"}) {
      const auto answer = write(object, value);
      EXPECT_FALSE(answer.success) << object << " " << value;
      EXPECT_THAT(answer.message, AllOf(HasSubstr("joint (node 4): "), HasSubstr(" not written: "),
                                        HasSubstr(value), HasSubstr("finite number")));
    }
  }
  EXPECT_EQ(held(kTemperatureLimit), 0x42C80000u) << "100.0 from the factory";
  EXPECT_EQ(scene.badFloats(), 0u);
}

TEST_F(FloatObjects, HexadecimalIsTheBitsUnderEveryName) {
  ASSERT_TRUE(write("200A:03", "0x42AB0000").success);
  EXPECT_EQ(held(kTemperatureLimit), 0x42AB0000u);
  ASSERT_TRUE(write("following_error_window", "0x3F000000").success);
  EXPECT_EQ(held({0x6065, 0}), 0x3F000000u);
  ASSERT_TRUE(write("200A:03", "0x80000000").success);
  EXPECT_EQ(held(kTemperatureLimit), 0u) << "-0.0 is never sent";
}

TEST_F(FloatObjects, TheSubIndexThatCountsOthersIsNoFloat) {
  const auto read = call(scene, bus::ReadObjectCommand{"joint", "2005:00 u8"});
  EXPECT_EQ(read.number, 3.0);
  EXPECT_EQ(read.text, "3 (0x03)");
}

TEST_F(FloatObjects, WholeNumbersAmongThemStayWhole) {
  const auto read = call(scene, bus::ReadObjectCommand{"joint", "2002:0D u32"});  // pole pairs
  EXPECT_EQ(read.number, 14.0);
}

// A type must not be a way around what the profile says of the bits.
TEST_F(FloatObjects, ATypeIsRefusedWhereTheProfileKnowsTheEncoding) {
  for (const char* type : {"u32", "i32", "f32", "bytes", "text"}) {
    const auto answer = write(std::string("200A:03 ") + type, "-1");
    EXPECT_FALSE(answer.success) << type;
    EXPECT_THAT(answer.message, HasSubstr("leave the type out")) << type;
  }
  EXPECT_EQ(held(kTemperatureLimit), 0x42C80000u);
}

}  // namespace
}  // namespace cia402
