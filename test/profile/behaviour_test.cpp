// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How a drive changes its mode, stops and takes a reset by its profile, and what is found in one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using drive::ControlKind;
using drive::CoordinateMark;
using drive::DriveProfile;
using drive::Encoding;
using drive::ErrorText;
using drive::ModeChange;
using drive::ModeSpec;
using drive::StopBy;
using fieldbus::ObjectId;
using testing::HasSubstr;

const char* const kFewKeys = R"(name: small
units: {position: count, velocity: count/s}
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int8}
  mode_display: {object: "6061:00", type: int8, access: ro}
  target_position: {object: "607A:00", type: int32, quantity: position, pdo: rpdo}
  target_velocity: {object: "60FF:00", type: int32, quantity: velocity, pdo: rpdo}
  position_actual: {object: "6064:00", type: int32, quantity: position, access: ro, pdo: tpdo}
modes:
  pp: {value: 1, control: position, target: target_position}
  csp: {value: 8, control: position, cyclic: true, target: target_position}
  csv: {value: 9, control: velocity, cyclic: true, target: target_velocity}
)";

WholeProfile profileWith(const std::string& text, const std::string& problem = "") {
  Problems problems;
  const WholeProfile profile = parseDriveFamily(kFewKeys + text, "small.yaml", problems);
  EXPECT_EQ(problems.text().empty(), problem.empty()) << text << "\n" << problems.text();
  EXPECT_THAT(problems.text(), HasSubstr(problem)) << text;
  return profile;
}

TEST(ProfileBehaviour, TheModeChangeIsAsWritten) {
  const ModeChange plain = profileWith("").mode_change;
  EXPECT_FALSE(plain.needs_disabling || plain.shown_when_enabled);
  EXPECT_EQ(plain.again, ModeChange::Again::never);
  EXPECT_TRUE(plain.while_halted);
  EXPECT_TRUE(plain.detours.empty());
  const ModeChange full =
      profileWith(
          "mode_change: {when: disabled, shown: enabled, again: through_zero, while_halted: false}")
          .mode_change;
  EXPECT_TRUE(full.needs_disabling);
  EXPECT_TRUE(full.shown_when_enabled);
  EXPECT_EQ(full.again, ModeChange::Again::through_zero);
  EXPECT_FALSE(full.while_halted);
  const ModeChange words =
      profileWith("mode_change: {when: any, shown: always, again: same}").mode_change;
  EXPECT_FALSE(words.needs_disabling || words.shown_when_enabled);
  EXPECT_EQ(words.again, ModeChange::Again::same);
  EXPECT_EQ(profileWith("mode_change: {again: never}").mode_change.again, ModeChange::Again::never);
  EXPECT_FALSE(profileWith("mode_change: any").mode_change.needs_disabling);
}

TEST(ProfileBehaviour, ADetourIsForItsTwoModesInItsDirection) {
  const ModeChange change =
      profileWith("mode_change: {detours: {csp: {csv: disabled, pp: csv}, csv: {pp: csp}}}")
          .mode_change;
  const char* const modes[] = {"cyclic_position", "cyclic_velocity", "profile_position"};
  for (const std::string from : modes) {
    for (const std::string to : modes) {
      SCOPED_TRACE(from + " to " + to);
      const ModeChange::Detour* detour = change.detour(from, to);
      if (from == "cyclic_position" && to == "cyclic_velocity") {
        ASSERT_NE(detour, nullptr);
        EXPECT_EQ(detour->through, "") << "disabled";
      } else if (from == "cyclic_position" && to == "profile_position") {
        ASSERT_NE(detour, nullptr);
        EXPECT_EQ(detour->through, "cyclic_velocity");
      } else if (from == "cyclic_velocity" && to == "profile_position") {
        ASSERT_NE(detour, nullptr);
        EXPECT_EQ(detour->through, "cyclic_position");
      } else {
        EXPECT_EQ(detour, nullptr);
      }
    }
  }
}

TEST(ProfileBehaviour, ADetourNeedsModesThatThereAre) {
  const char* const problem = "mode_change/detours: there is no mode `cyclic_torque`";
  profileWith("mode_change: {detours: {cst: {csp: pp}}}", problem);
  profileWith("mode_change: {detours: {csp: {cst: pp}}}", problem);
  profileWith("mode_change: {detours: {csp: {pp: cst}}}", problem);
  const WholeProfile wrong = profileWith("mode_change: {detours: {csp: {pp: [csv]}}}",
                                         "mode_change/detours/csp/pp: must be a text, not a list");
  EXPECT_TRUE(wrong.mode_change.detours.empty());
}

TEST(ProfileBehaviour, ADriveThatForgetsWhatItIsToldWhileDisabledTakesOtherDetours) {
  profileWith("mode_change: {again: same, detours: {csp: {pp: csv}}}");
  profileWith("mode_change: {again: through_zero, detours: {csp: {pp: disabled}}}");
  profileWith("mode_change: {again: same, detours: {csp: {pp: disabled}}}",
              "cyclic_position to profile_position is to go by disabling");
}

TEST(ProfileBehaviour, AModeThatBrakesMustBeReachableWhileEnabled) {
  const std::string cst =
      "  cst: {value: 10, control: torque, target: target_torque, stop: mode, stop_mode: csv}\n";
  std::string text = std::string(kFewKeys) + cst;
  text.replace(text.find("velocity: count/s}"), 18, "velocity: count/s, torque: N.m}");
  text.insert(text.find("modes:"),
              "  target_torque: {object: \"6071:00\", type: int16, quantity: torque, pdo: rpdo}\n");
  const auto problems = [&](const std::string& more) {
    Problems found;
    parseDriveFamily(text + more, "small.yaml", found);
    return found.text();
  };
  const char* const unreachable =
      "modes/cyclic_torque/stop_mode: the drive does not go into `cyclic_velocity` while enabled";
  EXPECT_EQ(problems(""), "");
  EXPECT_EQ(problems("mode_change: {detours: {csv: {cst: disabled}}}"), "") << "the other way";
  EXPECT_THAT(problems("mode_change: {when: disabled}"), HasSubstr(unreachable));
  EXPECT_THAT(problems("mode_change: {detours: {cst: {csv: csp}}}"), HasSubstr(unreachable));
}

TEST(ProfileBehaviour, AFaultResetMayNeedAnEmptyHistoryAndAResetMayBeForbidden) {
  const WholeProfile plain = profileWith("");
  EXPECT_FALSE(plain.fault_reset.clears_history);
  EXPECT_TRUE(plain.nmt_reset_node);
  EXPECT_TRUE(profileWith("fault_reset_clears_history: true").fault_reset.clears_history);
  EXPECT_FALSE(profileWith("nmt_reset_node: false").nmt_reset_node);
  EXPECT_FALSE(profileWith("nmt_reset_node: false").nmt_reset_does_nothing);
  const WholeProfile in_vain = profileWith("nmt_reset_node: does_nothing");
  EXPECT_FALSE(in_vain.nmt_reset_node);
  EXPECT_TRUE(in_vain.nmt_reset_does_nothing);
}

TEST(ProfileBehaviour, SaysByWhichTransitionsItIsDisabled) {
  const auto ways = [](const std::string& text) {
    return profileWith(text).disabling.transitions();
  };
  EXPECT_EQ(ways(""), (std::vector<int>{5, 10}));
  for (const std::vector<int>& way :
       {std::vector<int>{5, 10}, {5, 6, 7}, {8, 7}, std::vector<int>{9}}) {
    std::string list;
    for (const int number : way) list += (list.empty() ? "" : ", ") + std::to_string(number);
    EXPECT_EQ(ways("disable_by: [" + list + "]"), way);
  }
  for (const char* wrong : {"[5, 9]", "[7]", "[10, 5]", "[]"}) {
    profileWith("disable_by: " + std::string(wrong),
                "disable_by: from operation enabled to switch on disabled there are the "
                "transitions [5, 10], [5, 6, 7], [8, 7] and [9]");
  }
}

TEST(ProfileBehaviour, AModeStopsAsItSaysElseAsItsKindCan) {
  struct Row {
    ControlKind kind;
    bool cyclic, halt;
    std::optional<StopBy> says;
    StopBy stop;
  };
  const Row rows[] = {
      {ControlKind::position, true, true, {}, StopBy::set_points},
      {ControlKind::velocity, true, true, {}, StopBy::set_points},
      {ControlKind::torque, true, true, {}, StopBy::quick_stop},
      {ControlKind::position, false, true, {}, StopBy::halt},
      {ControlKind::torque, false, true, {}, StopBy::halt},
      {ControlKind::position, false, false, {}, StopBy::set_points},
      {ControlKind::torque, false, false, {}, StopBy::quick_stop},
      {ControlKind::position, true, true, StopBy::halt, StopBy::halt},
      {ControlKind::position, false, true, StopBy::set_points, StopBy::set_points},
      {ControlKind::velocity, false, false, StopBy::quick_stop, StopBy::quick_stop},
      {ControlKind::torque, true, true, StopBy::mode, StopBy::mode},
  };
  for (const Row& row : rows) {
    ModeSpec mode;
    mode.kind = row.kind;
    mode.cyclic = row.cyclic;
    mode.stop = row.says;
    DriveProfile profile;
    profile.halt_supported = row.halt;
    EXPECT_EQ(drive::stopBy(mode, profile), row.stop) << &row - rows;
  }
}

TEST(ProfileBehaviour, AnRpdoTimeoutIsThatOfTheStandardUnlessTheProfileSaysOtherwise) {
  DriveProfile profile;
  EXPECT_EQ(drive::missingByCode(profile, 0x8250), ErrorText::Missing::outputs);
  EXPECT_EQ(drive::missingByCode(profile, 0x8251), ErrorText::Missing::nothing);
  profile.errors[0x8250].missing = ErrorText::Missing::cycle;
  profile.errors[0x8251].missing = ErrorText::Missing::outputs;
  EXPECT_EQ(drive::missingByCode(profile, 0x8250), ErrorText::Missing::cycle);
  EXPECT_EQ(drive::missingByCode(profile, 0x8251), ErrorText::Missing::outputs);
  profile.errors[0x8250].missing = ErrorText::Missing::nothing;
  EXPECT_EQ(drive::missingByCode(profile, 0x8250), ErrorText::Missing::outputs);
}

TEST(ProfileBehaviour, AFloatThatNothingNamesHasItsPlaceAndAsManyBitsAsItsBytes) {
  DriveProfile profile;
  profile.encodings.add({{0x2000, 0}, {0x2000, 0xFF}}, Encoding::float32);
  profile.encodings.add({{0x2001, 0}, {0x2001, 0xFF}}, Encoding::bfloat16);
  const auto single = profile.unnamedFloat({0x2000, 3}, 4);
  ASSERT_TRUE(single);
  EXPECT_EQ(single->id, (ObjectId{0x2000, 3}));
  EXPECT_EQ(fieldbus::sizeBits(single->type), 32U);
  EXPECT_EQ(single->encoding, Encoding::float32);
  const auto half = profile.unnamedFloat({0x2001, 4}, 2);
  ASSERT_TRUE(half);
  EXPECT_EQ(half->id, (ObjectId{0x2001, 4}));
  EXPECT_EQ(fieldbus::sizeBits(half->type), 16U);
  EXPECT_EQ(half->encoding, Encoding::bfloat16);
  for (const std::size_t bytes : {0U, 1U, 3U, 5U, 8U}) {
    EXPECT_FALSE(profile.unnamedFloat({0x2000, 3}, bytes)) << bytes;
  }
  EXPECT_FALSE(profile.unnamedFloat({0x2000, 3}, 2));
  EXPECT_FALSE(profile.unnamedFloat({0x2001, 4}, 4));
  EXPECT_FALSE(profile.unnamedFloat({0x2002, 1}, 4));
}

TEST(ProfileBehaviour, AMarkThatIsMisspeltMarksNothing) {
  const WholeProfile profile =
      profileWith("coordinates: {\"607C\": set_positon, nothing_such: calibration}",
                  "did you mean `set_position`?");
  EXPECT_EQ(profile.coordinateMark({0x607C, 0}), CoordinateMark::home) << "as the standard has it";
  EXPECT_EQ(profile.coordinateMark({0, 0}), CoordinateMark::none);
}

TEST(ProfileBehaviour, WithAnEdsObjectsAreFoundByItsNamesToo) {
  WholeProfile profile = profileWith("");
  ASSERT_FALSE(profile.objects.empty());
  profile.objects.back().eds_keys = {"positionactualvalue", "readback"};
  EXPECT_EQ(profile.find("Position actual value"), nullptr) << "there is no EDS";
  profile.eds = "motor.eds";
  EXPECT_EQ(profile.find("Position actual value"), &profile.objects.back());
  EXPECT_EQ(profile.find("Read back"), &profile.objects.back());
  EXPECT_EQ(profile.find("position_actual"), &profile.objects.back());
  EXPECT_EQ(profile.find("Position demand value"), nullptr);
}

}  // namespace
}  // namespace cia402::config
