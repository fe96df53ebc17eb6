// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a profile says of what is looked at while a drive works, and of lengths that are open.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kDriveWithSupply = std::string(kLeastDrive) + R"(
  supply: {object: "2000:01", type: uint16, quantity: voltage, unit: V}
  alarm: {object: "2000:02", type: uint16, access: ro}
  choice: {object: "2000:03", type: int8, widest: 16}
  slope: {object: "6087:00", type: uint32, pdo: rpdo}
modes:
  csp: {value: 8, control: position, cyclic: true, target: target_position}
)";

WholeProfile supervised(const std::string& text, Problems& problems) {
  return parseDriveFamily(kDriveWithSupply + text + "\n", "tested.yaml", problems);
}

TEST(ProfileSupervision, IsAsWritten) {
  Problems problems;
  const WholeProfile profile = supervised(
      "statusword_needs: [{bit: 9, is: 1, text: deaf, remedy: wait},\n"
      "  {bit: 14, is: 0, when: enabled, text: zero, remedy: look}]\n"
      "watches: [{object: supply, within: [24, 48], text: off, remedy: check}]\n"
      "fault_reads: [alarm, \"1001:00\"]\n"
      "boot_reads: [alarm, supply]\n"
      "absent_settings_pass: true\n"
      "errors: {7: {text: battery, loses_zero: true}, 8: other}\n"
      "error_bits: 0xFF00\n"
      "reads_back: true\n"
      "checks: [{object: alarm, given: true, text: a, remedy: b}]\n"
      "sync: {advice: {pdos_per_ms: 9, share: 0.4, margin: 0.002}}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  const drive::Supervision& supervision = profile.supervision;
  ASSERT_EQ(supervision.needs.size(), 2U);
  EXPECT_EQ(supervision.unmet(0x0200, true), nullptr);
  ASSERT_NE(supervision.unmet(0x0000, false), nullptr);
  EXPECT_EQ(supervision.unmet(0x0000, false)->text, "deaf");
  EXPECT_EQ(supervision.unmet(0x4200, false), nullptr) << "not enabled";
  ASSERT_NE(supervision.unmet(0x4200, true), nullptr);
  EXPECT_EQ(supervision.unmet(0x4200, true)->remedy, "look");
  ASSERT_EQ(supervision.watches.size(), 1U);
  EXPECT_EQ(supervision.watches[0].object, "supply");
  EXPECT_EQ(supervision.watches[0].low, 24.0);
  EXPECT_EQ(supervision.watches[0].high, 48.0);
  EXPECT_THAT(supervision.fault_reads, ElementsAre("alarm", "1001:00"));
  EXPECT_THAT(supervision.boot_reads, ElementsAre("alarm", "supply"));
  EXPECT_TRUE(profile.absent_settings_pass);
  EXPECT_TRUE(profile.errors.at(7).loses_zero);
  EXPECT_FALSE(profile.errors.at(8).loses_zero);
  EXPECT_EQ(profile.error_bits, 0xFF00);
  EXPECT_TRUE(profile.reads_back);
  ASSERT_EQ(profile.checks.size(), 1U);
  EXPECT_EQ(profile.checks[0].condition.kind, drive::Condition::Kind::given);
  EXPECT_EQ(profile.find("choice")->widest, 16U);
  EXPECT_EQ(profile.find("alarm")->widest, 0U);
}

TEST(ProfileSupervision, IsNothingWithoutTheseKeys) {
  Problems problems;
  const WholeProfile profile = supervised("", problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  EXPECT_TRUE(profile.supervision.needs.empty());
  EXPECT_EQ(profile.supervision.unmet(0, true), nullptr);
  EXPECT_TRUE(profile.supervision.watches.empty());
  EXPECT_TRUE(profile.supervision.fault_reads.empty());
  EXPECT_TRUE(profile.supervision.boot_reads.empty());
  EXPECT_FALSE(profile.absent_settings_pass);
  EXPECT_EQ(profile.error_bits, 0);
  EXPECT_FALSE(profile.reads_back);
}

struct Mistake {
  const char *text, *told;
};

TEST(ProfileSupervision, SaysWhatIsWrong) {
  for (const Mistake& mistake :
       {Mistake{"statusword_needs: [{bit: 6, is: 1, text: a, remedy: b}]", "/bit"},
        Mistake{"statusword_needs: [{bit: 9, is: 2, text: a, remedy: b}]", "/is"},
        Mistake{"statusword_needs: [{bit: 9, is: 1, when: moving, text: a, remedy: b}]", "/when"},
        Mistake{"statusword_needs: [{bit: 9, is: 1, remedy: b}]", "text"},
        Mistake{"watches: [{object: nothing, within: [1, 2], text: a, remedy: b}]",
                "the profile has no object `nothing`"},
        Mistake{"watches: [{object: alarm, within: [1, 2], text: a, remedy: b}]",
                "`alarm` measures nothing"},
        Mistake{"watches: [{object: supply, within: [3, 2], text: a, remedy: b}]",
                "its lowest number is above its highest"},
        Mistake{"watches: [{object: supply, within: [3], text: a, remedy: b}]", "/within"},
        Mistake{"fault_reads: [nothing]", "the profile has no object `nothing`"},
        Mistake{"boot_reads: [nothing]", "the profile has no object `nothing`"},
        Mistake{"error_bits: 0x10000", "error_bits"},
        Mistake{"checks: [{object: alarm, given: true, is: 1, text: a, remedy: b}]", "or `given`"},
        Mistake{"sync: {advice: {share: 0.4}}", "pdos_per_ms"}}) {
    Problems problems;
    supervised(mistake.text, problems);
    EXPECT_THAT(problems.text(), HasSubstr(mistake.told)) << mistake.text;
  }
}

TEST(ProfileModes, MapWhatTheyWrite) {
  const auto with = [](const std::string& mode, Problems& problems) {
    return parseDriveFamily(
        std::string(kLeastDrive) +
            "\n  slope: {object: \"6087:00\", type: uint32, pdo: rpdo}\n"
            "  still: {object: \"6088:00\", type: uint32}\nmodes:\n  csp: {value: "
            "8, control: position, cyclic: true, target: target_position, " +
            mode + "}\n",
        "tested.yaml", problems);
  };
  Problems problems;
  const WholeProfile profile =
      with("entry_writes: [{object: slope, raw: 1}], mapped: [slope]", problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  EXPECT_THAT(profile.mode("cyclic_position")->mapped, ElementsAre("slope"));
  for (const char* wrong : {"entry_writes: [{object: still, raw: 1}], mapped: [still]",
                            "mapped: [slope]", "mapped: [none]"}) {
    Problems of_wrong;
    with(wrong, of_wrong);
    EXPECT_THAT(of_wrong.text(), HasSubstr("is no object of `entry_writes` that an RPDO can carry"))
        << wrong;
  }
}

TEST(ProfileObjects, SayHowWideTheyMayBe) {
  for (const char* wrong : {"{object: \"2000:01\", type: int16, widest: 16}",
                            "{object: \"2000:01\", type: visible_string, widest: 16}",
                            "{object: \"2000:01\", type: uint8, access: wo, widest: 16}"}) {
    Problems problems;
    parseDriveFamily(std::string(kLeastDrive) + "\n  choice: " + wrong +
                         "\nmodes:\n  csp: {value: 8, control: position, cyclic: true, target: "
                         "target_position}\n",
                     "tested.yaml", problems);
    EXPECT_THAT(problems.text(), HasSubstr("objects/choice/widest")) << wrong;
  }
}

TEST(ProfileObjects, JoinTwoHalvesOfANumber) {
  const auto with = [](const std::string& objects, Problems& problems) {
    return parseDriveFamily(std::string(kLeastDrive) + objects +
                                "\nmodes:\n  csp: {value: 8, control: position, cyclic: true, "
                                "target: target_position}\n",
                            "tested.yaml", problems);
  };
  const std::string low = "\n  low: {object: \"2000:01\", type: uint32, access: ro, high: up}";
  Problems problems;
  const WholeProfile profile =
      with(low + "\n  up: {object: \"2000:02\", type: int32, access: ro}", problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  EXPECT_EQ(profile.find("low")->high, "up");
  EXPECT_EQ(profile.find("up")->high, "");
  for (const std::string& wrong :
       {low, low + "\n  up: {object: \"2000:02\", type: int16, access: ro}",
        low + "\n  up: {object: \"2000:02\", type: int32}",
        std::string("\n  low: {object: \"2000:01\", type: uint32, high: up}\n  up: {object: "
                    "\"2000:02\", type: int32, access: ro}")}) {
    Problems of_wrong;
    with(wrong, of_wrong);
    EXPECT_THAT(of_wrong.text(), HasSubstr("`high` joins two read-only objects of 32 bits"))
        << wrong;
  }
}

}  // namespace
}  // namespace cia402::config
