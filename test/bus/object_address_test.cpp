// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/object_address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/dcf_world.h"

namespace cia402::bus {
namespace {

using fieldbus::DataType;
using fieldbus::ObjectId;
using testing::AllOf;
using testing::HasSubstr;

/// The profile says that 2000h and 2001h hold floats, whatever their type is.
struct ObjectAddress : testing::Test {
  ObjectAddress() {
    auto profile = std::make_shared<drive::DriveProfile>(*axis.profile);
    profile->encodings.add({{0x2000, 0}, {0x2000, 0xFF}}, drive::Encoding::float32);
    profile->encodings.add({{0x2001, 0}, {0x2001, 0xFF}}, drive::Encoding::bfloat16);
    axis.profile = profile;
  }
  std::string refusal(const std::string& text) const {
    const auto found = findObject(axis, text);
    return found ? "" : found.error().message;
  }
  drive::AxisConfig axis = test::testAxis("shoulder", 1);
};

TEST_F(ObjectAddress, IsAnIndexAndATypeWithBlanksAroundThem) {
  for (const char* const text : {"2003h:2 u16", "2003h:2  u16", "2003h:2 u16 ", "2003h:2  u16  "}) {
    SCOPED_TRACE(text);
    const auto found = findObject(axis, text);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->id, (ObjectId{0x2003, 2}));
    EXPECT_EQ(found->title, "2003:02");
    ASSERT_TRUE(found->spec);
    EXPECT_EQ(found->spec->id, (ObjectId{0x2003, 2}));
    EXPECT_EQ(found->spec->type, DataType::uint16);
    EXPECT_EQ(found->spec->encoding, drive::Encoding::integer);
  }
}

TEST_F(ObjectAddress, TakesNoTypeForAnObjectThatHoldsAFloatByTheProfile) {
  for (const char* const text : {"2000h:1 i32", "2000h:1 u32", "2000h:1 f32", "2001h:1 u16",
                                 "2000h:1 bytes", "2000h:1 text"}) {
    EXPECT_THAT(refusal(text), HasSubstr("holds a float by profile test_drive (encodings), "
                                         "whatever its type is; leave the type out"))
        << text;
  }
  EXPECT_FALSE(findObject(axis, "2000h:1")->spec) << "the float is known by the size of its answer";
}

// Sub-index 0 counts the others in one byte.
TEST_F(ObjectAddress, TakesATypeOfAnotherSizeAmongObjectsThatHoldFloats) {
  const auto found = findObject(axis, "2000h:0 u8");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->spec->type, DataType::uint8);
}

TEST_F(ObjectAddress, TakesAnyTypeForWhatTheProfileExceptsFromItsFloats) {
  auto profile = std::make_shared<drive::DriveProfile>(*axis.profile);
  profile->encodings.add({{0x2000, 5}, {0x2000, 5}}, drive::Encoding::integer);
  axis.profile = profile;
  for (const char* const text : {"2000h:5 i32", "2000h:5 u32", "2000h:5 f32", "2000h:5 bytes"}) {
    EXPECT_EQ(refusal(text), "") << text;
  }
}

TEST_F(ObjectAddress, WhatTheEdsDoesNotNameEitherIsSaidOfIt) {
  axis.description = test::robotWithEds().axes[0].description;
  EXPECT_THAT(refusal("homing_speed"),
              AllOf(HasSubstr("is neither an object of profile test_drive nor an index"),
                    HasSubstr(" (motor.eds: ")));
}

}  // namespace
}  // namespace cia402::bus
