// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/object_dictionary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::fieldbus {
namespace {

DictionaryEntry variable(ObjectId id, const char* name, DataType type = DataType::int32) {
  DictionaryEntry entry;
  entry.id = id;
  entry.name = name;
  entry.type = type;
  return entry;
}

ObjectDictionary dictionary() {
  ObjectDictionary all;
  DictionaryObject target{0x607A, "Target position", ObjectCode::variable, {}};
  target.entries[0] = variable({0x607A, 0}, "Target position");
  all.set(target);
  for (const std::uint16_t index : {std::uint16_t{0x1018}, std::uint16_t{0x1800}}) {
    DictionaryObject record{
        index, index == 0x1018 ? "Identity object" : "TPDO parameter", ObjectCode::record, {}};
    record.entries[0] = variable({index, 0}, "Highest sub-index", DataType::uint8);
    record.entries[1] = variable({index, 1}, index == 0x1018 ? "Vendor-ID" : "COB-ID");
    all.set(record);
  }
  return all;
}

TEST(ObjectDictionary, FindsByNameWithoutRegardToCaseAndBlanks) {
  const ObjectDictionary all = dictionary();
  ASSERT_TRUE(all.find("Target position").ok());
  EXPECT_EQ((*all.find("TARGETPOSITION"))->id, (ObjectId{0x607A, 0}));
  EXPECT_EQ((*all.find("identity object / vendor-id"))->id, (ObjectId{0x1018, 1}));
  EXPECT_EQ((*all.find("COB-ID"))->id, (ObjectId{0x1800, 1}));
  EXPECT_EQ(all.fullName(**all.find("cob-id")), "TPDO parameter/COB-ID");
}

TEST(ObjectDictionary, TellsWhichObjectsAnAmbiguousNameMeans) {
  const auto found = dictionary().find("Highest sub-index");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().message,
            "2 objects are called \"Highest sub-index\" (1018:00, 1800:00); name it by its index");
  EXPECT_EQ(dictionary().find("nonsense").error().message, "there is no object \"nonsense\"");
  EXPECT_FALSE(dictionary().find("").ok());
}

TEST(ObjectDictionary, AnObjectGoesBeforeAnEntryOfTheSameName) {
  ObjectDictionary all = dictionary();
  DictionaryObject cob_id{0x2001, "COB-ID", ObjectCode::variable, {}};
  cob_id.entries[0] = variable({0x2001, 0}, "COB-ID");
  all.set(cob_id);
  ASSERT_TRUE(all.find("COB-ID").ok()) << all.find("COB-ID").error().message;
  EXPECT_EQ((*all.find("COB-ID"))->id, (ObjectId{0x2001, 0}));
  EXPECT_EQ((*all.find("TPDO parameter/COB-ID"))->id, (ObjectId{0x1800, 1}));
  EXPECT_FALSE(all.find("COB-ID/COB-ID").ok()) << "a variable has no entries to be named";
}

TEST(ObjectDictionary, AWriteIsCheckedAgainstAccessLengthAndLimits) {
  DictionaryEntry entry = variable({0x607A, 0}, "Target position", DataType::int16);
  entry.low = ObjectValue{0xF6, 0xFF};   // -10
  entry.high = ObjectValue{0x0A, 0x00};  // 10
  EXPECT_TRUE(checkWrite(entry, {0xF6, 0xFF}, "m.eds").ok());
  EXPECT_TRUE(checkWrite(entry, {0x0A, 0x00}, "m.eds").ok());
  EXPECT_EQ(checkWrite(entry, {0x0B, 0x00}, "m.eds").error().message,
            "11 is above the limit 10 of m.eds");
  EXPECT_EQ(checkWrite(entry, {0xF5, 0xFF}, "m.eds").error().message,
            "-11 is below the limit -10 of m.eds");
  EXPECT_EQ(checkWrite(entry, {0}, "m.eds").error().message,
            "m.eds says that it is int16, not 1 bytes long");
  entry.access = Access::constant;
  EXPECT_EQ(checkWrite(entry, {0, 0}, "m.eds").error().message,
            "m.eds says that it is const, not to be written");
}

TEST(ObjectDictionary, NothingThatIsNotFiniteIsWrittenIntoAFloat) {
  const DictionaryEntry narrow = variable({0x2011, 0}, "Gain", DataType::real32);
  EXPECT_TRUE(checkWrite(narrow, {0, 0, 0xC0, 0x3F}, "m.eds").ok());  // 1.5
  for (const ObjectValue& value :
       {ObjectValue{0, 0, 0x80, 0x7F}, ObjectValue{0xFF, 0xFF, 0xFF, 0xFF}}) {
    EXPECT_THAT(checkWrite(narrow, value, "m.eds").error().message,
                testing::HasSubstr("is no finite number, and m.eds says that it is real32"));
  }
  const DictionaryEntry wide = variable({0x2011, 0}, "Gain", DataType::real64);
  EXPECT_TRUE(checkWrite(wide, {0, 0, 0, 0, 0, 0, 0xF8, 0x3F}, "m.eds").ok());
  EXPECT_FALSE(checkWrite(wide, {0, 0, 0, 0, 0, 0, 0xF0, 0xFF}, "m.eds").ok());
}

TEST(ObjectDictionary, UnsignedAndRealNumbersAreComparedAsWhatTheyAre) {
  EXPECT_GT(compareValues(DataType::uint8, {0xFF}, {0x01}), 0);
  EXPECT_LT(compareValues(DataType::int8, {0xFF}, {0x01}), 0);
  EXPECT_LT(compareValues(DataType::int24, {0xFF, 0xFF, 0xFF}, {0, 0, 0}), 0);
  // -2.0 and 1.0 as IEEE-754
  EXPECT_LT(compareValues(DataType::real32, {0, 0, 0, 0xC0}, {0, 0, 0x80, 0x3F}), 0);
  EXPECT_EQ(describeValue(DataType::real32, {0, 0, 0, 0xC0}), "-2");
  EXPECT_EQ(describeValue(DataType::octet_string, {1, 0xAB}), "01 AB");
  EXPECT_EQ(describeValue(DataType::visible_string, {}), "\"\"");
}

TEST(ObjectDictionary, TheSmallestTypeIsComparedAndTypesThatAreNoNumbersAreNot) {
  EXPECT_LT(compareValues(DataType::boolean, {0}, {1}), 0);
  EXPECT_GT(compareValues(DataType::boolean, {1}, {0}), 0);
  for (const DataType type : {DataType::visible_string, DataType::octet_string, DataType::domain}) {
    EXPECT_EQ(compareValues(type, {'a'}, {'b'}), 0) << toString(type);
  }
}

TEST(ObjectDictionary, TextIsDescribedAsTextWhereAllOfItCanBeRead) {
  EXPECT_EQ(describeValue(DataType::visible_string, {' ', '~'}), "\" ~\"");
  EXPECT_EQ(describeValue(DataType::visible_string, {'a', 0x1F}), "61 1F");
  EXPECT_EQ(describeValue(DataType::visible_string, {'a', 0x7F}), "61 7F");
}

}  // namespace
}  // namespace cia402::fieldbus
