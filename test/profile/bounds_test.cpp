// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The last value of each key of a drive profile that is allowed, the first that is refused, and the
// keys that no part of it knows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using drive::Quantity;
using drive::UnitSpec;
using testing::HasSubstr;

const char* const kPlainHead = R"(name: tested
units: {position: count, velocity: count/s}
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int8}
  mode_display: {object: "6061:00", type: int8, access: ro}
  target_position: {object: "607A:00", type: int32, quantity: position, pdo: rpdo}
  position_actual: {object: "6064:00", type: int32, quantity: position, access: ro, pdo: tpdo}
  label: {object: "2000:01", type: visible_string}
  small: {object: "2000:02", type: uint8, pdo: rpdo}
  short: {object: "2000:03", type: int16}
  wide: {object: "2000:04", type: uint64, pdo: rpdo}
)";
const char* const kPlainModes =
    "modes:\n"
    "  csp: {value: 8, control: position, cyclic: true, target: target_position}\n"
    "  homing: {value: 6, control: homing, status_bits: {homing_attained: 12}}\n";

/// The profile with `text` behind it, or, where that gives the objects or modes more, in it.
WholeProfile profileWith(const std::string& text, Problems& problems) {
  const bool object = text.compare(0, 4, "  o:") == 0;
  return parseDriveFamily(
      object ? kPlainHead + text + "\n" + kPlainModes : kPlainHead + (kPlainModes + text) + "\n",
      "tested.yaml", problems);
}

std::string problemsWith(const std::string& text) {
  Problems problems;
  profileWith(text, problems);
  return problems.text();
}

std::string with(const char* text, const std::string& value) {
  std::string result = text;
  return result.replace(result.find('@'), 1, value);
}

struct Bounds {
  const char* text;  ///< @: the value
  const char* path;  ///< in the message
  std::vector<const char*> allowed, refused;
};

TEST(ProfileBounds, AreThemselvesAllowedAndNothingBeyond) {
  const std::vector<const char*> words{"0", "4294967295"}, no_words{"-1", "4294967296"};
  const std::vector<const char*> sixteen{"1", "16"}, no_sixteen{"0", "17"};
  const std::vector<const char*> deadline{"0.001", "600"}, no_deadline{"0.0009", "600.1"};
  const std::vector<const char*> bits{"0", "15"}, no_bits{"-1", "16"};
  const Bounds all[] = {
      {"identity: {device_type: @}", "identity/device_type", words, no_words},
      {"identity: {vendor_id: @}", "identity/vendor_id", words, no_words},
      {"identity: {product_code: @}", "identity/product_code", words, no_words},
      {"pdo_rules: {max_pdos: @}", "pdo_rules/max_pdos", sixteen, no_sixteen},
      {"pdo_rules: {max_rpdos: @}", "pdo_rules/max_rpdos", sixteen, no_sixteen},
      {"pdo_rules: {max_tpdos: @}", "pdo_rules/max_tpdos", sixteen, no_sixteen},
      {"pdo_rules: {max_entries: @}", "pdo_rules/max_entries", {"1", "64"}, {"0", "65"}},
      {"pdo_rules: {fixed_entries: @}", "pdo_rules/fixed_entries", {"1", "64"}, {"0", "65"}},
      {"sync: {counter: @}", "sync/counter", {"0", "2", "240"}, {"-1", "1", "241"}},
      {"sync: {period_step: @}", "sync/period_step", {"0.000001", "1"}, {"0.0000009", "1.01"}},
      {"sync: {period_min: @}", "sync/period_min", {"0.000001", "10"}, {"0.0000009", "10.1"}},
      {"sync: {period_max: @}", "sync/period_max", {"0.000001", "10"}, {"0.0000009", "10.1"}},
      {"timing: {boot: @}", "timing/boot", deadline, no_deadline},
      {"timing: {state_change: @}", "timing/state_change", deadline, no_deadline},
      {"timing: {transitions: {4: @}}", "timing/transitions/4", deadline, no_deadline},
      {"timing: {mode_change: @}", "timing/mode_change", deadline, no_deadline},
      {"timing: {sdo: @}", "timing/sdo", deadline, no_deadline},
      {"timing: {brake_release: @}", "timing/brake_release", {"0", "60"}, {"-0.1", "60.1"}},
      {"timing: {sdo_retries: @}", "timing/sdo_retries", {"0", "10"}, {"-1", "11"}},
      {"parameters: {save: [@]}", "parameters/save[0]", {"1", "127"}, {"0", "128"}},
      {"parameters: {restore: [@]}", "parameters/restore[0]", {"1", "127"}, {"0", "128"}},
      {"parameters: {timeout: @}", "parameters/timeout", deadline, no_deadline},
      {"quick_stop_holds: [@]", "quick_stop_holds[0]", {"-32768", "32767"}, {"-32769", "32768"}},
      {"fault_reset_tries: @", "fault_reset_tries", {"1", "20"}, {"0", "21"}},
      {"fault_reset_nmt_stop: @", "fault_reset_nmt_stop", {"0", "10"}, {"-0.1", "10.1"}},
      {"homing: {kind: drive, methods: {@: x}}",
       "homing/methods",
       {"-128", "127"},
       {"-129", "128"}},
      {"errors: {@: x}", "errors", {"1", "0xFFFF"}, {"0", "0x10000"}},
      {"warnings: {@: x}", "warnings", {"1", "0xFFFF"}, {"0", "0x10000"}},
      {"  a: {control: position, target: target_position, value: @}",
       "modes/a/value",
       {"-128", "127"},
       {"-129", "128"}},
      {"  a: {value: 1, control: position, target: target_position, status_bits: "
       "{target_reached: @}}",
       "modes/a/status_bits/target_reached", bits, no_bits},
      {"  a: {value: 1, control: position, target: target_position, status_bits: "
       "{following_error: @}}",
       "modes/a/status_bits/following_error", bits, no_bits},
      {"  a: {value: 1, control: position, target: target_position, status_bits: "
       "{set_point_acknowledge: @}}",
       "modes/a/status_bits/set_point_acknowledge", bits, no_bits},
      {"  a: {value: 1, control: position, target: target_position, status_bits: {speed_zero: @}}",
       "modes/a/status_bits/speed_zero", bits, no_bits},
      {"  a: {value: 1, control: position, target: target_position, status_bits: "
       "{follows_command: @}}",
       "modes/a/status_bits/follows_command", bits, no_bits},
      {"  a: {value: 1, control: homing, status_bits: {homing_attained: @}}",
       "modes/a/status_bits/homing_attained", bits, no_bits},
      {"  a: {value: 1, control: homing, status_bits: {homing_attained: 1, homing_error: @}}",
       "modes/a/status_bits/homing_error", bits, no_bits},
      {"  a: {value: 1, control: position, target: target_position, controlword_bits: @}",
       "modes/a",
       {"0", "0x0010", "0x0020", "0x0040", "0x0100", "0x8000", "0xFF70"},
       {"-1", "0x0001", "0x0002", "0x0004", "0x0008", "0x0080", "0x10000"}},
      {"pdos: {tpdo1: {objects: [statusword], transmission: @}}",
       "pdos/tpdo1/transmission",
       {"0", "1", "240", "252", "253", "254", "255"},
       {"-1", "241", "251", "256"}},
      {"pdos: {rpdo1: {objects: [controlword], transmission: @}}",
       "pdos/rpdo1/transmission",
       {"0", "1", "240", "254", "255"},
       {"-1", "241", "251", "252", "253", "256"}},
      {"pdos: {tpdo1: {objects: [statusword], inhibit: @}}",
       "pdos/tpdo1/inhibit",
       {"0", "6.5535"},
       {"-0.0001", "6.5536"}},
      {"pdos: {tpdo1: {objects: [statusword], event_timer: @}}",
       "pdos/tpdo1/event_timer",
       {"0", "65.535"},
       {"-0.001", "65.536"}},
      {"pdos: {tpdo1: {objects: [statusword], transmission: 252, request_every: @}}",
       "pdos/tpdo1/request_every",
       {"1", "10000"},
       {"0", "10001"}},
      {"pdos: {rpdo1: {objects: [controlword], refresh_every: @}}",
       "pdos/rpdo1/refresh_every",
       {"1", "1000"},
       {"0", "1001"}},
      {"pdos: {rpdo1: {objects: [controlword], cob_id: @}}",
       "pdos/rpdo1/cob_id",
       {"0x181", "0x6DF", "drive", "$NODEID+0x180", "$NODEID+0x6DF"},
       {"0x180", "0x6E0", "$NODEID+0x17F", "$NODEID+0x6E0", "$NODEID", "none"}},
      {"pdos: {rpdo@: [controlword]}", "pdos", {"1", "4"}, {"0", "5"}},
      {"pdos: {tpdo@: [statusword]}", "pdos", {"1", "4"}, {"0", "5"}},
      {"startup: [{object: small, raw: @}]", "startup[0]/raw", {"0", "255"}, {"-1", "256"}},
      {"startup: [{object: short, raw: @}]",
       "startup[0]/raw",
       {"-32768", "32767"},
       {"-32769", "32768"}},
      {"startup: [{object: wide, raw: @}]", "startup[0]/raw", {"0", "9223372036854775807"}, {"-1"}},
      {"startup: [{object: \"2100:00\", type: int64, raw: @}]",
       "startup[0]/raw",
       {"-9223372036854775808", "9223372036854775807"},
       {"9223372036854775808"}},
      {"startup: [{object: \"2100:00\", type: boolean, raw: @}]",
       "startup[0]/raw",
       {"0", "1"},
       {"-1", "2"}},
      {"startup: [{object: small, from: limits.effort, times: @}]",
       "startup[0]/times",
       {"0.001", "1000"},
       {"0", "-1"}},
      {"  o: {object: \"2100:00\", type: int32, quantity: current, unit: {unit: A, scale: @}}",
       "objects/o/unit/scale",
       {"0.001", "1000"},
       {"0", "-1"}},
      {"  o: {object: \"2100:00\", type: int32, quantity: position, factor: @}",
       "objects/o/factor",
       {"-1", "0.001"},
       {"0", ".inf"}},
  };
  for (const Bounds& bounds : all) {
    for (const char* value : bounds.allowed) {
      EXPECT_EQ(problemsWith(with(bounds.text, value)), "") << with(bounds.text, value);
    }
    for (const char* value : bounds.refused) {
      EXPECT_THAT(problemsWith(with(bounds.text, value)), HasSubstr(bounds.path))
          << with(bounds.text, value);
    }
  }
}

struct Unknown {
  const char* text;  ///< with the key `xyzzy`
  const char* path;
};

TEST(ProfileBounds, WhatNoPartKnowsIsTold) {
  const Unknown all[] = {
      {"xyzzy: 1", ": xyzzy: unknown key"},
      {"identity: {xyzzy: 1}", "identity/xyzzy: unknown key"},
      {"pdo_rules: {xyzzy: 1}", "pdo_rules/xyzzy: unknown key"},
      {"sync: {xyzzy: 1}", "sync/xyzzy: unknown key"},
      {"heartbeat: {xyzzy: 1}", "heartbeat/xyzzy: unknown key"},
      {"timing: {xyzzy: 1}", "timing/xyzzy: unknown key"},
      {"parameters: {xyzzy: 1}", "parameters/xyzzy: unknown key"},
      {"mode_change: {xyzzy: 1}", "mode_change/xyzzy: unknown key"},
      {"homing: {kind: none, xyzzy: 1}", "homing/xyzzy: unknown key"},
      {"errors: {1: {text: x, xyzzy: 1}}", "errors/1/xyzzy: unknown key"},
      {"warnings: {1: {text: x, reset: by_bit}}", "warnings/1/reset: unknown key"},
      {"warnings: {1: {text: x, reaction: coasts}}", "warnings/1/reaction: unknown word `coasts`"},
      {"errors: {1: {text: x, reaction: holds}}", "errors/1/reaction: unknown word `holds`"},
      {"fault_reaction: stops", "fault_reaction: unknown word `stops`"},
      {"statusword: {7: none}\nwarnings: {1: x}", "warnings: the drive has no warning bit"},
      {"startup: [{object: small, raw: 1, xyzzy: 1}]", "startup[0]/xyzzy: unknown key"},
      {"pdos: {rpdo1: {objects: [controlword], xyzzy: 1}}", "pdos/rpdo1/xyzzy: unknown key"},
      {"  a: {value: 1, control: position, target: target_position, xyzzy: 1}",
       "modes/a/xyzzy: unknown key"},
      {"  a: {value: 1, control: position, target: target_position, status_bits: {xyzzy: 1}}",
       "modes/a/status_bits/xyzzy: unknown key"},
      {"  o: {object: \"2100:00\", type: int32, xyzzy: 1}", "objects/o/xyzzy: unknown key"},
      {"  o: {object: \"2100:00\", type: int32, quantity: current, unit: {unit: A, xyzzy: 1}}",
       "objects/o/unit/xyzzy: unknown key"},
  };
  for (const Unknown& unknown : all) {
    EXPECT_THAT(problemsWith(unknown.text), HasSubstr(unknown.path)) << unknown.text;
  }
}

TEST(ProfileBounds, WhatIsGivenTwiceIsTold) {
  const Unknown all[] = {
      {"  o: {object: \"2100:00\", type: int32}\n  o: {object: \"2101:00\", type: int32}",
       "objects/o: is given twice"},
      {"  csp: {value: 1, control: position, target: target_position}",
       "modes/csp: is given twice"},
      {"homing: {kind: drive, methods: {1: x, 1: y}}", "homing/methods/1: is given twice"},
      {"errors: {1: x, 1: y}", "errors/1: is given twice"},
      {"encodings: {\"2100\": float32, \"2100\": integer}", "encodings/2100: is given twice"},
      {"coordinates: {\"2100\": none, \"2100\": home}", "coordinates/2100: is given twice"},
      {"pdos: {rpdo1: [controlword], rpdo1: [controlword]}", "pdos/rpdo1: is given twice"},
      {"mode_change: {detours: {csp: {csp: disabled}, csp: {csp: disabled}}}",
       "mode_change/detours/csp: is given twice"},
      {"mode_change: {detours: {csp: {csp: disabled, csp: csp}}}",
       "mode_change/detours/csp/csp: is given twice"},
  };
  for (const Unknown& twice : all) {
    EXPECT_THAT(problemsWith(twice.text), HasSubstr(twice.path)) << twice.text;
  }
}

TEST(ProfileBounds, WhatIsNoNumberIsNotWritten) {
  EXPECT_THAT(problemsWith("startup: [{object: label, raw: 1}]"),
              HasSubstr("startup[0]/raw: only numbers can be written"));
  EXPECT_THAT(
      problemsWith("startup: [{object: \"2100:00\", type: visible_string, from: limits.effort}]"),
      HasSubstr("startup[0]/type: only numbers can be written"));
}

TEST(ProfileBounds, UnitsHaveNoOtherPartsThanTheStandardOnes) {
  const auto velocity = [](const char* unit) {
    return problemsWith(std::string("  o: {object: \"2100:00\", type: int32, quantity: velocity, "
                                    "unit: ") +
                        unit + "}");
  };
  const auto acceleration = [](const char* unit) {
    return problemsWith(
        std::string("  o: {object: \"2100:00\", type: int32, quantity: acceleration, "
                    "unit: ") +
        unit + "}");
  };
  for (const char* good : {"count/s", "turn/min", "deg/s^1", "rad/s"}) {
    EXPECT_EQ(velocity(good), "") << good;
  }
  for (const char* bad :
       {"count", "count/h", "count/s/h", "count/s^2", "count/min/min", "A/s", "/s", "count/"}) {
    EXPECT_THAT(velocity(bad), HasSubstr("is no unit of velocity; write for example `count/s`"))
        << bad;
  }
  for (const char* good : {"count/s^2", "rad/s2", "turn/min/s", "deg/s/s"}) {
    EXPECT_EQ(acceleration(good), "") << good;
  }
  for (const char* bad : {"count/s", "turn/min/min", "rad/s^3", "rad/s^2/h"}) {
    EXPECT_THAT(acceleration(bad), HasSubstr("is no unit of acceleration; write for example `count/"
                                             "s^2`"))
        << bad;
  }
}

TEST(ProfileBounds, APdoHoldsSixtyFourBits) {
  EXPECT_EQ(problemsWith("pdos: {rpdo1: [wide]}"), "");
  EXPECT_THAT(problemsWith("pdos: {rpdo1: [wide, small]}"),
              HasSubstr("pdos/rpdo1: is 72 bits long (64 + 8), a PDO holds 64"));
}

TEST(ProfileBounds, AMistakeIsToldOnceWithoutOthersThatFollowFromIt) {
  for (const char* text : {"startup: [{object: \"2100:00\", raw: 300}]",
                           "  o: {object: \"2100:00\", type: uint8, access: rx, pdo: rpdo}",
                           "  o: {object: \"2100:00\", type: unit8}",
                           "  a: {value: 1, control: positon, target: target_position}",
                           "  a: {value: 300, control: position, target: target_position}"}) {
    Problems problems;
    profileWith(text, problems);
    EXPECT_EQ(problems.list().size(), 1U) << text << "\n" << problems.text();
  }
}

TEST(ProfileBounds, AWriteIsCodedAsItsObjectIs) {
  const std::string object =
      "  o: {object: \"2100:00\", type: uint32, encoding: float32, quantity: position}\n";
  const auto startup = [&](const char* write, Problems& problems) {
    return parseDriveFamily(kPlainHead + object + kPlainModes + "startup: [{" + write + "}]\n",
                            "tested.yaml", problems)
        .drive.startup;
  };
  Problems none;
  EXPECT_EQ(startup("object: o, raw: 0x3FC00000", none)[0].raw, 0x3FC00000);
  EXPECT_EQ(startup("object: o, value: 1.5", none)[0].value, 1.5) << "in SI units";
  EXPECT_EQ(startup("object: \"2100:00\", value: 1.5", none)[0].raw, 0x3FC00000)
      << "in those of the drive";
  EXPECT_EQ(none.text(), "");
  for (const char* write : {"object: o, raw: 0x7F800000", "object: \"2100:00\", raw: 0x7F800000"}) {
    Problems problems;
    startup(write, problems);
    EXPECT_THAT(problems.text(), HasSubstr("startup[0]/raw: 0x7F800000 is no finite number"));
  }
}

TEST(ProfileBounds, APdoWithOptionsMapsWhatItLists) {
  Problems problems;
  const WholeProfile profile = profileWith(
      "pdos: {rpdo2: {objects: [controlword, target_position], transmission: 254}}", problems);
  EXPECT_EQ(problems.text(), "");
  ASSERT_EQ(profile.pdos.size(), 1U);
  EXPECT_THAT(profile.pdos[0].objects, testing::ElementsAre("controlword", "target_position"));
  EXPECT_EQ(profile.pdos[0].number, 2U);
}

TEST(ProfileBounds, UnitsAreGivenForWhatHasOneOfItsOwn) {
  const auto units = [](const std::string& more, Problems& problems) {
    std::string text = std::string(kPlainHead) + kPlainModes;
    text.insert(text.find("velocity: count/s}"), more + ", ");
    return parseDriveFamily(text, "tested.yaml", problems).drive.units;
  };
  Problems none;
  const auto read = units("voltage: {unit: V, scale: 0.01}, jerk: turn/s^3", none);
  EXPECT_EQ(none.text(), "");
  EXPECT_EQ(read.at(Quantity::voltage).base, UnitSpec::Base::volt);
  EXPECT_EQ(read.at(Quantity::voltage).scale, 0.01);
  EXPECT_EQ(read.at(Quantity::jerk).base, UnitSpec::Base::turn);
  EXPECT_EQ(read.at(Quantity::jerk).scale, 1.0);
  EXPECT_EQ(read.at(Quantity::position).base, UnitSpec::Base::count);
  EXPECT_EQ(read.count(Quantity::torque), 0U);
  for (const std::string wrong : {"distance", "none", "jrk"}) {
    Problems problems;
    units(wrong + ": count", problems);
    EXPECT_THAT(problems.text(), HasSubstr("units/" + wrong + ": unknown key"));
  }
}

TEST(ProfileBounds, TheModeIsANumberAsLongAsItsObject) {
  const auto problems = [](const char* object, const char* type) {
    std::string text = std::string(kPlainHead) + kPlainModes;
    const std::string from = std::string(object) + "\", type: int8";
    text.replace(text.find(from), from.size(), std::string(object) + "\", type: " + type);
    Problems found;
    parseDriveFamily(text, "tested.yaml", found);
    return found.text();
  };
  EXPECT_EQ(problems("6060:00", "uint16"), "");
  EXPECT_THAT(problems("6060:00", "boolean"),
              HasSubstr("modes/csp/value: must be between 0 and 1, not `8`"));
  EXPECT_THAT(problems("6060:00", "visible_string"),
              HasSubstr("objects/mode_of_operation must be a number"));
  EXPECT_THAT(problems("6061:00", "visible_string"),
              HasSubstr("objects/mode_display must be a number"));
}

}  // namespace
}  // namespace cia402::config
