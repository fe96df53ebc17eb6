// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/object_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::DataType;
using drive::Encoding;
using drive::Quantity;
using fieldbus::Bytes;
using testing::HasSubstr;

struct ObjectTextTest : testing::Test {
  drive::ObjectSpec object(DataType type, Quantity quantity = Quantity::none) const {
    drive::ObjectSpec spec;
    spec.name = "thing";
    spec.id = {0x2000, 1};
    spec.type = type;
    spec.quantity = quantity;
    if (type == DataType::real32) spec.encoding = Encoding::float32;  // as the profile reader does
    return spec;
  }
  ObjectText describe(const drive::ObjectSpec& spec, const Bytes& data) const {
    return describeObject(&spec, axis, data);
  }
  std::string refusal(DataType type, const std::string& value) const {
    const auto encoded = encodeObject(object(type), value);
    return encoded ? "" : encoded.error().message;
  }
  Bytes encoded(const drive::ObjectSpec& spec, const std::string& value) const {
    const auto bytes = encodeObject(spec, value);
    EXPECT_TRUE(bytes.ok()) << value << ": " << (bytes ? "" : bytes.error().message);
    return bytes ? *bytes : Bytes();
  }
  Bytes encoded(DataType type, const std::string& value) const {
    return encoded(object(type), value);
  }

  const drive::AxisConfig axis = test::testAxis("shoulder", 1);  // 1e-5 rad a count
};

TEST_F(ObjectTextTest, ShowsNumbersInDecimalAndHexadecimal) {
  EXPECT_EQ(describe(object(DataType::uint32), {0xD2, 0x04, 0, 0}).value, "1234 (0x000004D2)");
  EXPECT_EQ(describe(object(DataType::uint8), {0xFF}).value, "255 (0xFF)");
  EXPECT_EQ(describe(object(DataType::int8), {0xFF}).value, "-1 (0xFF)");
  EXPECT_EQ(describe(object(DataType::int16), {0x00, 0x80}).value, "-32768 (0x8000)");
}

TEST_F(ObjectTextTest, GivesTheNumberInDeviceUnits) {
  EXPECT_EQ(describe(object(DataType::int16), {0xFE, 0xFF}).number, -2.0);
  EXPECT_EQ(describe(object(DataType::int32, Quantity::position), {0xE8, 0x03, 0, 0}).number, 1000);
  EXPECT_EQ(describe(object(DataType::boolean), {1}).number, 1.0);
}

TEST_F(ObjectTextTest, ShowsJointUnitsWhereTheQuantityIsKnown) {
  EXPECT_EQ(describe(object(DataType::int32, Quantity::position), {0xA0, 0x86, 1, 0}).value,
            "100000 (0x000186A0) = 1 rad");
  EXPECT_EQ(describe(object(DataType::int32, Quantity::velocity), {0x60, 0x79, 0xFE, 0xFF}).value,
            "-100000 (0xFFFE7960) = -1 rad/s");
  // 500 per mille of 10 N m
  EXPECT_EQ(describe(object(DataType::int16, Quantity::torque), {0xF4, 0x01}).value,
            "500 (0x01F4) = 5 N m");
}

TEST_F(ObjectTextTest, ShowsFloatsInIntegersAsFloats) {
  drive::ObjectSpec spec = object(DataType::uint32);
  spec.encoding = Encoding::float32;
  const ObjectText text = describe(spec, {0x00, 0x00, 0xC0, 0xBF});  // 0xBFC00000
  EXPECT_EQ(text.value, "-1.5");
  EXPECT_EQ(text.number, -1.5);
  EXPECT_EQ(describe(object(DataType::real32), {0x00, 0x00, 0x20, 0x40}).value, "2.5");
}

TEST_F(ObjectTextTest, ShowsTextsAsTextsHoweverShort) {
  EXPECT_EQ(describe(object(DataType::visible_string), {'D', 'M'}).value, "\"DM\"");
  EXPECT_EQ(
      describe(object(DataType::visible_string), {'T', 'e', 's', 't', ' ', 'd', 'r', 'i', 'v', 'e'})
          .value,
      "\"Test drive\"");
  EXPECT_EQ(describe(object(DataType::octet_string), {0x00, 0xAB}).value, "00 AB");
  EXPECT_EQ(describe(object(DataType::domain), {}).value, "nothing");
}

TEST_F(ObjectTextTest, TellsASizeThatContradictsTheProfile) {
  const ObjectText text = describe(object(DataType::uint32), {0x01, 0x02});
  EXPECT_EQ(text.value, "01 02 (2 bytes, but the profile says uint32)");
  EXPECT_TRUE(std::isnan(text.number));
}

TEST_F(ObjectTextTest, ShowsWhatNothingNamesAsBytesAndSaysSo) {
  const ObjectText text = describeObject(nullptr, axis, {0x92, 0x01, 0x02, 0x00});
  EXPECT_THAT(text.value, HasSubstr("92 01 02 00 (4 bytes; its type is not known"));
  EXPECT_TRUE(std::isnan(text.number));
  EXPECT_THAT(describeObject(nullptr, axis, {'D', 'M'}).value,
              HasSubstr("44 4D (2 bytes, as text \"DM\"; its type is not known"));
  EXPECT_EQ(describeObject(nullptr, axis, Bytes(9, 'x')).value,
            "\"xxxxxxxxx\" (9 bytes; its type is not known: give it behind the object, e.g. text, "
            "bytes)");
}

TEST_F(ObjectTextTest, EncodesNumbersInWireOrder) {
  EXPECT_EQ(encoded(DataType::uint16, "0x1A2B"), (Bytes{0x2B, 0x1A}));
  EXPECT_EQ(encoded(DataType::int16, "-2"), (Bytes{0xFE, 0xFF}));
  EXPECT_EQ(encoded(DataType::int32, "100000"), (Bytes{0xA0, 0x86, 0x01, 0x00}));
  EXPECT_EQ(encoded(DataType::uint64, "18446744073709551615"), Bytes(8, 0xFF));
  EXPECT_EQ(encoded(DataType::int8, "-128"), (Bytes{0x80}));
  EXPECT_EQ(encoded(DataType::boolean, "1"), (Bytes{0x01}));
}

TEST_F(ObjectTextTest, TakesADecimalNumberWithLeadingZerosAsDecimal) {
  EXPECT_EQ(encoded(DataType::uint8, "010"), (Bytes{10}));
}

TEST_F(ObjectTextTest, TakesHexadecimalAsTheBitPattern) {
  EXPECT_EQ(encoded(DataType::int32, "0x80000181"), (Bytes{0x81, 0x01, 0x00, 0x80}));
  EXPECT_EQ(encoded(DataType::int8, "0xFF"), (Bytes{0xFF}));
  EXPECT_THAT(refusal(DataType::int8, "0x100"), HasSubstr("does not fit"));
}

TEST_F(ObjectTextTest, RefusesNumbersThatDoNotFit) {
  EXPECT_EQ(refusal(DataType::int16, "40000"), "40000 does not fit int16 (-32768..32767)");
  EXPECT_EQ(refusal(DataType::int8, "-129"), "-129 does not fit int8 (-128..127)");
  EXPECT_EQ(refusal(DataType::uint8, "256"), "256 does not fit uint8 (0..255)");
  EXPECT_THAT(refusal(DataType::uint16, "-1"), HasSubstr("does not fit uint16"));
  EXPECT_NE(refusal(DataType::uint64, "18446744073709551616"), "");
  EXPECT_NE(refusal(DataType::int64, "9223372036854775808"), "");
  EXPECT_EQ(refusal(DataType::int64, "-9223372036854775808"), "");
  EXPECT_THAT(refusal(DataType::boolean, "2"), HasSubstr("does not fit"));
}

TEST_F(ObjectTextTest, RefusesWhatIsNoNumber) {
  for (const char* value : {"", "-", "x", "12a", "1.5", "0x", " 5", "5 ", "--5", "+5"}) {
    EXPECT_THAT(refusal(DataType::int32, value), HasSubstr("is not a whole number")) << value;
  }
}

TEST_F(ObjectTextTest, EncodesFloatsByTheObjectsEncoding) {
  drive::ObjectSpec spec = object(DataType::uint32, Quantity::velocity);  // not converted
  spec.encoding = Encoding::float32;
  EXPECT_EQ(encoded(spec, "-1.5"), (Bytes{0x00, 0x00, 0xC0, 0xBF}));
  EXPECT_EQ(encoded(DataType::real32, "2.5"), (Bytes{0x00, 0x00, 0x20, 0x40}));
  EXPECT_THAT(refusal(DataType::real32, "fast"), HasSubstr("is not a number"));
  EXPECT_THAT(refusal(DataType::real32, "nan"), HasSubstr("cannot be sent"));
  EXPECT_THAT(refusal(DataType::real32, "1e99"), HasSubstr("cannot be sent"));
}

TEST_F(ObjectTextTest, RefusesWhatIsNotFiniteInEveryKindOfFloat) {
  drive::ObjectSpec half = object(DataType::uint16);
  half.encoding = Encoding::bfloat16;
  const std::pair<drive::ObjectSpec, std::vector<const char*>> kinds[] = {
      {object(DataType::real32), {"nan", "-inf", "1e39", "0x7F800001", "0xFFFFFFFF"}},
      {object(DataType::real64), {"nan", "inf", "1e999", "0x7FF0000000000000"}},
      {half, {"nan", "inf", "1e39", "0x7F80", "0xFFFF"}}};
  for (const auto& [spec, values] : kinds) {
    for (const char* value : values) {
      const auto bytes = encodeObject(spec, value);
      ASSERT_FALSE(bytes) << value;
      EXPECT_THAT(bytes.error().message, testing::AllOf(HasSubstr(value), HasSubstr("finite")));
    }
  }
}

TEST_F(ObjectTextTest, TakesTheBitsOfAFloatInHexadecimal) {
  EXPECT_EQ(encoded(DataType::real32, "0xBFC00000"), (Bytes{0x00, 0x00, 0xC0, 0xBF}));
  EXPECT_EQ(encoded(DataType::real64, "0x3FF8000000000000"), (Bytes{0, 0, 0, 0, 0, 0, 0xF8, 0x3F}));
  EXPECT_EQ(encoded(DataType::real64, "1.5"), (Bytes{0, 0, 0, 0, 0, 0, 0xF8, 0x3F}));
  EXPECT_THAT(refusal(DataType::real32, "0x100000000"), HasSubstr("does not fit 4 bytes"));
}

TEST_F(ObjectTextTest, RefusesWhatTheDriveDoesNotTake) {
  drive::ObjectSpec percent = object(DataType::int16);
  percent.range = drive::ObjectSpec::Range{0, 120};
  EXPECT_EQ(encoded(percent, "120"), (Bytes{0x78, 0x00}));
  for (const char* value : {"121", "-1", "0xFFFF"}) {
    const auto bytes = encodeObject(percent, value);
    ASSERT_FALSE(bytes) << value;
    EXPECT_EQ(
        bytes.error().message,
        "thing (2000:01) takes 0 to 120 in the drive's own numbers, not " + std::string(value));
  }
}

TEST_F(ObjectTextTest, NeverSendsNegativeZero) {
  EXPECT_EQ(encoded(DataType::real32, "-0.0"), (Bytes{0, 0, 0, 0}));
  EXPECT_EQ(encoded(DataType::real32, "0x80000000"), (Bytes{0, 0, 0, 0}));
  EXPECT_EQ(encoded(DataType::real64, "-0.0"), Bytes(8, 0));
}

TEST_F(ObjectTextTest, EncodesTextsAsTheyAre) {
  EXPECT_EQ(encoded(DataType::visible_string, "12"), (Bytes{'1', '2'}));
}

TEST_F(ObjectTextTest, EncodesUnlistedNumbersInTheSizeThatTheDriveTold) {
  EXPECT_EQ(*encodeUnlisted("-1", 2), (Bytes{0xFF, 0xFF}));
  EXPECT_EQ(*encodeUnlisted("40000", 2), (Bytes{0x40, 0x9C}));  // its sign is not known
  EXPECT_FALSE(encodeUnlisted("65536", 2).ok());
  EXPECT_FALSE(encodeUnlisted("-32769", 2).ok());
  EXPECT_EQ(*encodeUnlisted("name", 10), (Bytes{'n', 'a', 'm', 'e'}));
  EXPECT_EQ(encodeUnlisted("1", 3)->size(), 3u);
}

TEST_F(ObjectTextTest, ShowsBytesAsTextOnlyIfAllArePrintable) {
  EXPECT_EQ(textOf({'o', 'k'}), "\"ok\"");
  EXPECT_EQ(textOf({'o', 0x07}), "6F 07");
}

TEST_F(ObjectTextTest, ShowsOneLetterPaddedWithZerosAsALetter) {
  EXPECT_EQ(describe(object(DataType::visible_string), {'A', 0}).value, "\"A\"");
  EXPECT_EQ(describe(object(DataType::visible_string), {'A', 0, 0}).value, "\"A\"");
}

// Eight bytes may be a number, more are none.
TEST_F(ObjectTextTest, ShowsEightPrintableBytesThatNothingNamesAsBytes) {
  EXPECT_THAT(describeObject(nullptr, axis, Bytes(8, 'x')).value,
              HasSubstr("78 78 78 78 78 78 78 78 (8 bytes, as text \"xxxxxxxx\"; its type is not "
                        "known: give it behind the object, e.g. u16"));
}

TEST_F(ObjectTextTest, EncodesUnlistedNumbersOfEightBytes) {
  EXPECT_EQ(*encodeUnlisted("18446744073709551615", 8), Bytes(8, 0xFF));
  EXPECT_EQ(*encodeUnlisted("1", 8), (Bytes{1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(*encodeUnlisted("-9223372036854775808", 8), (Bytes{0, 0, 0, 0, 0, 0, 0, 0x80}));
  EXPECT_FALSE(encodeUnlisted("-9223372036854775809", 8).ok());
}

TEST_F(ObjectTextTest, RefusesNoNumberAtAllForAFloat) {
  EXPECT_EQ(refusal(DataType::real32, ""), "\"\" is not a number; write e.g. -1.5");
  EXPECT_EQ(refusal(DataType::real32, "1.5 "), "\"1.5 \" is not a number; write e.g. -1.5");
}

}  // namespace
}  // namespace cia402::bus
