// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Modes whose commands go to the drive one after the other, bits in words, and homing by an edge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using drive::Handover;
using testing::ElementsAre;
using testing::HasSubstr;

std::string driveWith(const std::string& objects, const std::string& modes,
                      const std::string& more = {}) {
  return "bit_fields: {alarm: [{name: reaction, bits: [24, 31], words: {3: held}}, "
         "{name: code, bits: [0, 15]}, {name: loud, bits: 16}]}\n" +
         std::string(kLeastDrive) + "\n" + objects + "modes:\n" + modes +
         "  homing: {value: 6, control: homing, status_bits: {homing_attained: 12}}\n" + more;
}

const std::string kQueued =
    "  queued: {value: 1, control: position, target: target_position, handshake: new_set_point,"
    " queued: true, status_bits: {set_point_acknowledge: 12}}\n";

WholeProfile parsed(const std::string& text, Problems& problems) {
  return parseDriveFamily(text, "tested.yaml", problems);
}

TEST(OneByOne, CommandsHaveTheWordsOfTheStandard) {
  Problems problems;
  const WholeProfile profile = parsed(
      driveWith("",
                kQueued +
                    "  far: {value: 1, control: position, target: target_position,"
                    " handshake: new_set_point, relative_to: position,"
                    " status_bits: {set_point_acknowledge: 12}}\n"
                    "  both: {value: 1, control: position, target: target_position, queued: true,"
                    " handshake: new_set_point, relative_to: target,"
                    " status_bits: {set_point_acknowledge: 12}}\n"),
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  const auto words = [&](const char* mode) {
    const Handover& handover = profile.mode(mode)->handover;
    return std::vector<unsigned>{handover.words[1], handover.ofCommand(1)};
  };
  EXPECT_THAT(words("queued"), ElementsAre(0x30, 0x10));
  EXPECT_THAT(words("far"), ElementsAre(0x30, 0x70));
  EXPECT_THAT(words("both"), ElementsAre(0x30, 0x50));
  EXPECT_EQ(profile.mode("queued")->handover.from, Handover::From::zero);
  EXPECT_EQ(profile.mode("far")->handover.from, Handover::From::position);
  EXPECT_EQ(profile.mode("both")->handover.from, Handover::From::target);
}

TEST(OneByOne, ModesThatCannotBeSoAreRefused) {
  const std::pair<std::string, const char*> mistakes[] = {
      {"  a: {value: 1, control: position, target: target_position, queued: true}\n",
       "`queued` needs `handshake: new_set_point`"},
      {"  a: {value: 1, control: position, target: target_position, relative_to: demand}\n",
       "whose set-points are acknowledged"},
      {"  a: {value: 1, control: position, target: target_position, handshake: new_set_point,"
       " replaces_queue: true, status_bits: {set_point_acknowledge: 12}}\n",
       "`replaces_queue` is of `queued`"},
      {"  a: {value: 1, control: position, target: target_position, relative_to: target,"
       " handshake: {words: [0, 32, 48], acknowledge: rise}, status_bits: {set_point_acknowledge: "
       "12}}\n",
       ""},
      {"  a: {value: 1, control: position, target: target_position, relative_to: demand,"
       " handshake: {words: [0, 16]}, status_bits: {set_point_acknowledge: 12}}\n",
       ""},
      {"  a: {value: 1, control: position, target: target_position, handshake: new_set_point,"
       " queued: true, controlword_bits: 0x20, status_bits: {set_point_acknowledge: 12}}\n",
       "leave controlword bits 4 to 6"},
      {"  a: {value: 1, control: position, target: target_position, handshake: new_set_point,"
       " queued: true, stop: set_points, status_bits: {set_point_acknowledge: 12}}\n",
       "stopped by the halt bit"},
      {"  a: {value: 1, control: position, target: target_position, handshake: new_set_point,"
       " relative_to: here, status_bits: {set_point_acknowledge: 12}}\n",
       "relative_to"}};
  for (const auto& [mode, told] : mistakes) {
    Problems problems;
    parsed(driveWith("", mode), problems);
    if (*told == '\0') {
      EXPECT_TRUE(problems.empty()) << problems.text();
    } else {
      EXPECT_THAT(problems.text(), HasSubstr(told));
    }
  }
}

TEST(BitFields, AreNamedByObjectsAndToldInWords) {
  Problems problems;
  const WholeProfile profile = parsed(
      driveWith(
          "  stall: {object: \"200E:01\", type: uint32, fields: alarm, when_disabled: true}\n",
          kQueued),
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  const drive::ObjectSpec* object = profile.find("stall");
  ASSERT_NE(object, nullptr);
  EXPECT_TRUE(object->when_disabled);
  EXPECT_FALSE(profile.find("target_position")->when_disabled);
  EXPECT_EQ(drive::fieldsText(profile.bit_fields.at(object->fields), 0x03017121),
            "reaction 3 (held), code 0x7121, loud 1");
  EXPECT_EQ(drive::fieldsText(profile.bit_fields.at(object->fields), 0x04FE0000),
            "reaction 4, code 0x0000, loud 0");
}

TEST(BitFields, ThatCannotBeAreRefused) {
  for (const auto& [object, told] :
       {std::pair("  a: {object: \"200E:01\", type: uint32, fields: alarms}\n",
                  "`bit_fields` has no `alarms`"),
        std::pair("  a: {object: \"200E:01\", type: uint16, fields: alarm}\n",
                  "has bit 31, which uint16 has not")}) {
    Problems problems;
    parsed(driveWith(object, kQueued), problems);
    EXPECT_THAT(problems.text(), HasSubstr(told));
  }
}

TEST(ProfileSettings, EachOnceAndReadBackAreAsWritten) {
  Problems problems;
  const WholeProfile profile =
      parsed(driveWith("  one: {object: \"2003:01\", type: uint16}\n"
                       "  two: {object: \"2003:03\", type: uint16}\n",
                       kQueued,
                       "checks: [{each_once: [one, two], but: [0, 9], text: t, remedy: r}]\n"
                       "may_be_cut: [two, one]\n"),
             problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  ASSERT_EQ(profile.checks.size(), 1U);
  EXPECT_TRUE(profile.checks[0].each_once);
  EXPECT_THAT(profile.checks[0].objects, ElementsAre("one", "two"));
  EXPECT_THAT(profile.checks[0].condition.numbers, ElementsAre(0, 9));
  EXPECT_THAT(profile.may_be_cut, ElementsAre("two", "one"));
}

TEST(HomingEdge, IsABitOfAnObjectAndMovesNothing) {
  Problems problems;
  const std::string bits = "  bits: {object: \"2017:02\", type: uint16}\n";
  const WholeProfile profile =
      parsed(driveWith(bits, kQueued,
                       "homing: {kind: drive, methods: {35: {text: here, moves: false, edge: "
                       "{object: bits, bit: 3}}}}\n"),
             problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  const auto& edge = profile.homing.methods.at(35).edge;
  ASSERT_TRUE(edge.has_value());
  EXPECT_EQ(edge->object, "bits");
  EXPECT_EQ(edge->bit, 3U);
  Problems wrong;
  parsed(driveWith(
             bits, kQueued,
             "homing: {kind: drive, methods: {17: {text: here, edge: {object: bits, bit: 3}}}}\n"),
         wrong);
  EXPECT_THAT(wrong.text(), HasSubstr("write `moves: false`"));
}

}  // namespace
}  // namespace cia402::config
