// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/dictionary/template.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace cia402::sim {
namespace {

using testing::HasSubstr;

ObjectDictionary build(const std::string& text, canopen::NodeId node = 3) {
  const auto parsed = DictionaryTemplate::parse(YAML::Load(text));
  if (!parsed.ok()) {
    ADD_FAILURE() << parsed.error().message;
    return {};
  }
  return parsed->build(node);
}

std::string problems(const std::string& text) {
  const auto parsed = DictionaryTemplate::parse(YAML::Load(text));
  return parsed.ok() ? "" : parsed.error().message;
}

std::uint64_t number(const ObjectDictionary& dictionary, std::uint16_t index, std::uint8_t sub) {
  const Entry* entry = dictionary.find({index, sub});
  if (entry == nullptr) {
    ADD_FAILURE() << "no such entry " << std::hex << index << ":" << int{sub};
    return 0;
  }
  return entry->number;
}

TEST(DictionaryYaml, ReadsAnObject) {
  const auto dictionary = build("- [0x6060, 1, modes, int8, rw, rt, -1, -2, 10]");
  const Entry& entry = *dictionary.find({0x6060, 1});
  EXPECT_EQ(entry.name, "modes");
  EXPECT_EQ(entry.type, DataType::int8);
  EXPECT_EQ(entry.access, Access::rw);
  EXPECT_TRUE(entry.rpdo);
  EXPECT_TRUE(entry.tpdo);
  EXPECT_EQ(asSigned(entry), -1);
  EXPECT_EQ(entry.initial_number, 0xFFU);
  EXPECT_EQ(entry.low, -2);
  EXPECT_EQ(entry.high, 10);
}

TEST(DictionaryYaml, DefaultsAreZeroOrEmptyUnlessGiven) {
  const auto dictionary = build(
      "- [0x1000, 0, type, uint32, const, '-']\n"
      "- [0x1008, 0, name, visible_string, ro, '-', DM4310]\n");
  EXPECT_EQ(number(dictionary, 0x1000, 0), 0U);
  EXPECT_EQ(dictionary.find({0x1000, 0})->access, Access::constant);
  const Entry& name = *dictionary.find({0x1008, 0});
  EXPECT_EQ(std::string(name.bytes.begin(), name.bytes.end()), "DM4310");
}

TEST(DictionaryYaml, AddsTheNodeId) {
  const auto dictionary = build(
      "- [0x1014, 0, emcy, uint32, rw, '-', $NODEID+0x80]\n"
      "- [0x2003, 1, id, uint32, rw, '-', $NODEID]\n",
      5);
  EXPECT_EQ(number(dictionary, 0x1014, 0), 0x85U);
  EXPECT_EQ(number(dictionary, 0x2003, 1), 5U);
}

TEST(DictionaryYaml, TakesTheBitPatternOfARealNumber) {
  const auto dictionary = build(
      "- [0x6080, 0, speed, int32, rw, '-', f600.0]\n"
      "- [0x6064, 0, position, int32, ro, t, f-0.5]\n"
      "- [0x2000, 0, real, real32, ro, '-', 1.0]\n"
      "- [0x2000, 1, real, real64, ro, '-', 1.0]\n");
  EXPECT_EQ(number(dictionary, 0x6080, 0), 0x44160000U);
  EXPECT_EQ(number(dictionary, 0x6064, 0), 0xBF000000U);
  EXPECT_EQ(number(dictionary, 0x2000, 0), 0x3F800000U);
  EXPECT_EQ(number(dictionary, 0x2000, 1), 0x3FF0000000000000U);
}

TEST(DictionaryYaml, ArrayMacroWritesTheCountAndEqualEntries) {
  const auto dictionary = build(
      "- array: {index: 0x1016, name: consumer, count: 3, type: uint32, default: [7, 8, 9]}\n"
      "- array: {index: 0x1003, count: 2, type: uint32, access: ro, count_access: rw, "
      "count_default: 0}\n");
  EXPECT_EQ(number(dictionary, 0x1016, 0), 3U);
  EXPECT_EQ(number(dictionary, 0x1016, 3), 9U);
  EXPECT_EQ(dictionary.find({0x1016, 1})->access, Access::rw);
  EXPECT_EQ(number(dictionary, 0x1003, 0), 0U);
  EXPECT_EQ(dictionary.find({0x1003, 0})->access, Access::rw);
  EXPECT_EQ(dictionary.find({0x1003, 2})->access, Access::ro);
}

TEST(DictionaryYaml, PdoMacrosUseThePredefinedConnectionSet) {
  const auto dictionary = build(
      "- rpdos: {count: 5, valid: [true, true, false, false, true], types: [1, 1, 1, 254, 255]}\n"
      "- tpdos: {count: 4, valid: false}\n",
      1);
  EXPECT_EQ(number(dictionary, 0x1400, 1), 0x201U);
  EXPECT_EQ(number(dictionary, 0x1401, 1), 0x301U);
  EXPECT_EQ(number(dictionary, 0x1402, 1), 0x80000401U);
  EXPECT_EQ(number(dictionary, 0x1403, 1), 0x80000501U);
  EXPECT_EQ(number(dictionary, 0x1404, 1), 0x80000000U);
  EXPECT_EQ(number(dictionary, 0x1403, 2), 254U);
  EXPECT_EQ(number(dictionary, 0x1400, 0), 2U);
  EXPECT_EQ(dictionary.find({0x1400, 5}), nullptr);
  EXPECT_EQ(number(dictionary, 0x1800, 1), 0x80000181U);
  EXPECT_EQ(number(dictionary, 0x1803, 1), 0x80000481U);
  EXPECT_EQ(number(dictionary, 0x1803, 2), 255U);
  EXPECT_EQ(number(dictionary, 0x1A03, 0), 0U);
  EXPECT_NE(dictionary.find({0x1A03, 8}), nullptr);
  EXPECT_EQ(dictionary.find({0x1A03, 9}), nullptr);
}

TEST(DictionaryYaml, PdoMacrosTakeOptionalSubindicesAndMaps) {
  const auto dictionary = build(
      "- tpdos: {count: 2, cob_ids: [0x190, $NODEID+0x1A0], types: 1, inhibit_times: 10,\n"
      "          event_timers: [100, 200], sync_starts: 0, rtr: false, entries: 2,\n"
      "          maps: [[0x60410010, 0x60640020]]}\n",
      2);
  EXPECT_EQ(number(dictionary, 0x1800, 0), 6U);
  EXPECT_EQ(number(dictionary, 0x1800, 1), 0x40000190U);
  EXPECT_EQ(number(dictionary, 0x1801, 1), 0x400001A2U);
  EXPECT_EQ(number(dictionary, 0x1800, 3), 10U);
  EXPECT_EQ(number(dictionary, 0x1801, 5), 200U);
  EXPECT_EQ(number(dictionary, 0x1801, 6), 0U);
  EXPECT_EQ(number(dictionary, 0x1A00, 0), 2U);
  EXPECT_EQ(number(dictionary, 0x1A00, 2), 0x60640020U);
  EXPECT_EQ(number(dictionary, 0x1A01, 0), 0U);
  EXPECT_EQ(dictionary.find({0x1A00, 3}), nullptr);
}

TEST(DictionaryYaml, NamesEveryProblemWithItsLine) {
  const std::string text = problems(
      "- [0x16040, 0, a, uint16, rw, r, 0]\n"
      "- [0x6040, 0, b, uint17, rw, r, 0]\n"
      "- [0x6041, 0, c, uint16, r, t, 0]\n"
      "- [0x6042, 0, d, uint16, ro, x, 0]\n"
      "- [0x6043, 0, e, uint16, rw, r, 65536]\n"
      "- [0x6044, 0, f, uint8, rw, r, f1.5]\n"
      "- [0x6045, 0, g, uint16, ro, r, 0]\n"
      "- [0x6046, 0, h, uint16, rw, r, 9, 0, 8]\n"
      "- [0x6046, 0, i, uint16, rw, r, 0]\n"
      "- [0x6047, 0]\n"
      "- pods: {count: 4}\n"
      "- rpdos: {count: 4, validd: true}\n"
      "- tpdos: {count: 4, types: [1, 2]}\n"
      "- 12\n");
  EXPECT_THAT(text, HasSubstr("line 1: an index"));
  EXPECT_THAT(text, HasSubstr("line 2: unknown type 'uint17'"));
  EXPECT_THAT(text, HasSubstr("line 3: access is ro, wo, rw or const, not 'r'"));
  EXPECT_THAT(text, HasSubstr("line 4: PDO is"));
  EXPECT_THAT(text, HasSubstr("line 5: 0x6043:00: the default 65536 does not fit 16 bits"));
  EXPECT_THAT(text, HasSubstr("line 6: 0x6044:00: a real number needs"));
  EXPECT_THAT(text, HasSubstr("line 7: 0x6045:00 cannot be written"));
  EXPECT_THAT(text, HasSubstr("line 8: 0x6046:00: the default is outside"));
  EXPECT_THAT(text, HasSubstr("line 9: 0x6046:00 is there twice"));
  EXPECT_THAT(text, HasSubstr("line 10: an object has 6, 7 or 9 fields"));
  EXPECT_THAT(text, HasSubstr("line 11: unknown macro 'pods'"));
  EXPECT_THAT(text, HasSubstr("line 12: unknown key 'validd'"));
  EXPECT_THAT(text, HasSubstr("line 13: 'types' needs 4 values"));
  EXPECT_THAT(text, HasSubstr("line 14: expected an object"));
}

TEST(DictionaryYaml, RefusesAnythingButAList) {
  EXPECT_THAT(problems("{a: 1}"), HasSubstr("a list of objects and macros"));
}

TEST(DictionaryYaml, AMisspeltNumberIsNotTakenForZero) {
  for (const char* value : {"12x", "0x", "--1", "1 2", "$NODEID-1", "fx", "99999999999999999999"}) {
    EXPECT_NE(problems("- [0x2000, 0, a, int32, rw, '-', '" + std::string(value) + "']"), "")
        << value;
  }
}

}  // namespace
}  // namespace cia402::sim
