// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/dictionary/object_dictionary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

Entry entry(std::uint16_t index, std::uint8_t sub, DataType type, Access access,
            std::uint64_t number = 0) {
  Entry e;
  e.id = ObjectId{index, sub};
  e.type = type;
  e.access = access;
  e.number = number;
  return e;
}

TEST(ObjectDictionary, GivesNumbersInLittleEndianOrderAndOwnWidth) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x6041, 0, DataType::uint16, Access::ro, 0x0237));
  dictionary.add(entry(0x6064, 0, DataType::int32, Access::ro, static_cast<std::uint64_t>(-2)));
  dictionary.add(entry(0x60FD, 1, DataType::boolean, Access::ro, 1));
  dictionary.add(entry(0x2000, 0, DataType::uint64, Access::ro, 0x1122334455667788U));
  Bytes out;
  EXPECT_EQ(dictionary.read({0x6041, 0}, out), 0U);
  EXPECT_EQ(out, (Bytes{0x37, 0x02}));
  EXPECT_EQ(dictionary.read({0x6064, 0}, out), 0U);
  EXPECT_EQ(out, (Bytes{0xFE, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(dictionary.read({0x60FD, 1}, out), 0U);
  EXPECT_EQ(out, (Bytes{0x01}));
  EXPECT_EQ(dictionary.read({0x2000, 0}, out), 0U);
  EXPECT_EQ(out, (Bytes{0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11}));
}

TEST(ObjectDictionary, TellsMissingObjectsFromMissingSubindices) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x1018, 1, DataType::uint32, Access::ro));
  Bytes out;
  EXPECT_EQ(dictionary.read({0x1018, 7}, out), 0x06090011U);
  EXPECT_EQ(dictionary.read({0x1019, 0}, out), 0x06020000U);
  EXPECT_EQ(dictionary.write({0x1018, 0}, {0}), 0x06090011U);
  EXPECT_EQ(dictionary.write({0x1017, 0}, {0}), 0x06020000U);
}

TEST(ObjectDictionary, EnforcesAccessRights) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x6041, 0, DataType::uint16, Access::ro));
  dictionary.add(entry(0x1000, 0, DataType::uint32, Access::constant, 0x30000));
  dictionary.add(entry(0x2001, 0, DataType::uint8, Access::wo));
  Bytes out;
  EXPECT_EQ(dictionary.write({0x6041, 0}, {1, 2}), 0x06010002U);
  EXPECT_EQ(dictionary.write({0x1000, 0}, {1, 2, 3, 4}), 0x06010002U);
  EXPECT_EQ(dictionary.write({0x2001, 0}, {9}), 0U);
  EXPECT_EQ(dictionary.read({0x2001, 0}, out), 0x06010001U);
  EXPECT_EQ(dictionary.writeNumber(*dictionary.find({0x6041, 0}), 3), 0x06010002U);
  EXPECT_EQ(dictionary.find({0x6041, 0})->number, 0U);
}

TEST(ObjectDictionary, RefusesWrongLengths) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x6060, 0, DataType::uint16, Access::rw));
  EXPECT_EQ(dictionary.write({0x6060, 0}, {1}), 0x06070013U);
  EXPECT_EQ(dictionary.write({0x6060, 0}, {1, 0, 0, 0}), 0x06070012U);
  EXPECT_EQ(dictionary.write({0x6060, 0}, {6, 0}), 0U);
  EXPECT_EQ(dictionary.find({0x6060, 0})->number, 6U);
  EXPECT_EQ(dictionary.checkWritable({0x6060, 0}, 3), 0x06070012U);
  EXPECT_EQ(dictionary.checkWritable({0x6060, 0}, std::nullopt), 0U);
}

TEST(ObjectDictionary, RefusesValuesOutOfRangeByTheirOwnSign) {
  ObjectDictionary dictionary;
  Entry mode = entry(0x6060, 0, DataType::int8, Access::rw);
  mode.low = -1;
  mode.high = 10;
  dictionary.add(mode);
  Entry polarity = entry(0x607E, 0, DataType::uint8, Access::rw);
  polarity.low = 1;
  polarity.high = 0xC0;
  dictionary.add(polarity);
  EXPECT_EQ(dictionary.write({0x6060, 0}, {0xFF}), 0U);
  EXPECT_EQ(asSigned(*dictionary.find({0x6060, 0})), -1);
  EXPECT_EQ(dictionary.write({0x6060, 0}, {0xFE}), 0x06090032U);
  EXPECT_EQ(dictionary.write({0x6060, 0}, {0x0B}), 0x06090031U);
  EXPECT_EQ(dictionary.write({0x607E, 0}, {0xC0}), 0U);
  EXPECT_EQ(dictionary.write({0x607E, 0}, {0xC1}), 0x06090031U);
  EXPECT_EQ(dictionary.write({0x607E, 0}, {0x00}), 0x06090032U);
  EXPECT_EQ(dictionary.find({0x607E, 0})->number, 0xC0U);
}

TEST(ObjectDictionary, TakesABooleanOnlyAsZeroOrOne) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x2010, 0, DataType::boolean, Access::rw));
  EXPECT_EQ(dictionary.write({0x2010, 0}, {1}), 0U);
  EXPECT_EQ(dictionary.write({0x2010, 0}, {2}), 0x06090030U);
}

TEST(ObjectDictionary, AsksTheCheckBeforeAndTheHookAfterAWrite) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x6040, 0, DataType::uint16, Access::rw, 5));
  std::vector<std::uint64_t> seen;
  dictionary.onWriteCheck({0x6040, 0}, [&](const Entry& e, std::uint64_t number) {
    seen.push_back(e.number);
    return number == 0x80 ? 0x08000022U : 0U;
  });
  dictionary.onWrite({0x6040, 0}, [&](const Entry& e) { seen.push_back(e.number); });
  EXPECT_EQ(dictionary.write({0x6040, 0}, {0x80, 0x00}), 0x08000022U);
  EXPECT_EQ(dictionary.write({0x6040, 0}, {0x06, 0x00}), 0U);
  EXPECT_EQ(dictionary.writeNumber(*dictionary.find({0x6040, 0}), 0x70007), 0U);
  EXPECT_THAT(seen, testing::ElementsAre(5, 5, 6, 6, 7));
}

TEST(ObjectDictionary, LetsTheReadHookRefreshOrRefuse) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x6064, 0, DataType::int16, Access::ro));
  dictionary.onRead({0x6064, 0}, [](Entry& e) {
    e.number = 0x1234;
    return 0U;
  });
  dictionary.add(entry(0x1003, 1, DataType::uint32, Access::ro));
  dictionary.onRead({0x1003, 1}, [](Entry&) { return 0x08000024U; });
  Bytes out;
  EXPECT_EQ(dictionary.read({0x6064, 0}, out), 0U);
  EXPECT_EQ(out, (Bytes{0x34, 0x12}));
  EXPECT_EQ(dictionary.read({0x1003, 1}, out), 0x08000024U);
}

TEST(ObjectDictionary, HooksAndPointersOutliveReplacementOfTheEntry) {
  ObjectDictionary dictionary;
  Entry* pointer = &dictionary.add(entry(0x6040, 0, DataType::uint16, Access::rw, 1));
  const ObjectDictionary::Hooks& hooks = dictionary.hooks({0x6040, 0});
  int calls = 0;
  dictionary.onWrite({0x6040, 0}, [&](const Entry&) { ++calls; });
  dictionary.add(entry(0x6040, 0, DataType::uint16, Access::rw, 2));
  EXPECT_EQ(pointer->number, 2U);
  EXPECT_EQ(dictionary.writeNumber(*pointer, 9, hooks), 0U);
  EXPECT_EQ(calls, 1);
}

TEST(ObjectDictionary, KeepsStringsOfAnyLength) {
  ObjectDictionary dictionary;
  Entry name = entry(0x1008, 0, DataType::visible_string, Access::rw);
  name.bytes = {'D', 'M'};
  dictionary.add(name);
  Bytes out;
  EXPECT_EQ(dictionary.write({0x1008, 0}, {'D', 'M', '4', '3', '1', '0'}), 0U);
  EXPECT_EQ(dictionary.read({0x1008, 0}, out), 0U);
  EXPECT_EQ(out, (Bytes{'D', 'M', '4', '3', '1', '0'}));
  dictionary.restoreInitial();
  EXPECT_EQ(dictionary.read({0x1008, 0}, out), 0U);
  EXPECT_EQ(out, (Bytes{'D', 'M'}));
}

TEST(ObjectDictionary, RestoresAllOrARangeWithoutCallingHooks) {
  ObjectDictionary dictionary;
  dictionary.add(entry(0x1017, 0, DataType::uint16, Access::rw, 10));
  dictionary.add(entry(0x1FFF, 0, DataType::uint16, Access::rw, 11));
  dictionary.add(entry(0x6065, 0, DataType::uint32, Access::rw, 12));
  int calls = 0;
  dictionary.onWrite({0x1017, 0}, [&](const Entry&) { ++calls; });
  for (const auto& item : dictionary.entries()) dictionary.find(item.first)->number = 99;
  dictionary.restoreInitial(0x1000, 0x1FFF);
  EXPECT_EQ(dictionary.find({0x1017, 0})->number, 10U);
  EXPECT_EQ(dictionary.find({0x1FFF, 0})->number, 11U);
  EXPECT_EQ(dictionary.find({0x6065, 0})->number, 99U);
  dictionary.restoreInitial();
  EXPECT_EQ(dictionary.find({0x6065, 0})->number, 12U);
  EXPECT_EQ(calls, 0);
}

TEST(ObjectDictionary, TruncatesDefaultsToTheirWidth) {
  ObjectDictionary dictionary;
  const Entry& e = dictionary.add(entry(0x605A, 0, DataType::int16, Access::rw, ~std::uint64_t{0}));
  EXPECT_EQ(e.number, 0xFFFFU);
  EXPECT_EQ(asSigned(e), -1);
}

}  // namespace
}  // namespace cia402::sim
