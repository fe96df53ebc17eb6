// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "folders.h"
#include "profile/whole_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::config {
namespace {

using drive::CoordinateMark;
using drive::DriveProfile;
using drive::Encoding;
using drive::ErrorText;
using drive::HomingSpec;
using fieldbus::DataType;
using fieldbus::ObjectId;
using testing::ElementsAre;
using testing::HasSubstr;

const char* const kSmall = R"(name: small
units: {position: count, velocity: count/s}
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int8}
  mode_display: {object: "6061:00", type: int8, access: ro, pdo: tpdo}
  target_position: {object: "607A:00", type: int32, quantity: position, pdo: rpdo}
  position_actual: {object: "6064:00", type: int32, quantity: position, access: ro, pdo: tpdo}
  profile_velocity: {object: "6081:00", type: uint32, quantity: velocity}
modes:
  csp: {value: 8, control: position, cyclic: true, target: target_position}
pdos:
  rpdo1: [controlword, target_position]
  tpdo1: [statusword, position_actual]
)";

// The small profile with the first `from` replaced by `to`.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = kSmall;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string problemsOf(const std::string& text) {
  Problems problems;
  parseDriveFamily(text, "small.yaml", problems);
  return problems.text();
}

WholeProfile shipped(const char* name) {
  Problems problems;
  const WholeProfile profile =
      loadDriveFamily(cia402::test::configFolder() + "/drives/" + name + ".yaml", problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_EQ(profile.name, name);
  return profile;
}

TEST(DriveProfile, ReadsASmallOne) {
  Problems problems;
  const WholeProfile profile = parseDriveFamily(kSmall, "small.yaml", problems);
  EXPECT_EQ(problems.text(), "");
  ASSERT_NE(profile.mode("csp"), nullptr);
  EXPECT_EQ(profile.mode("csp")->name, "cyclic_position");
  EXPECT_EQ(profile.mode("cyclic_position"), profile.mode("csp"));
  EXPECT_EQ(profile.mode("csv"), nullptr);
  ASSERT_NE(profile.find("target_position"), nullptr);
  EXPECT_EQ(profile.find(ObjectId{0x607A, 0}), profile.find("target_position"));
  ASSERT_EQ(profile.pdos.size(), 2u);
  EXPECT_THAT(profile.pdos[0].objects, ElementsAre("controlword", "target_position"));
  EXPECT_EQ(profile.pdos[0].transmission, 1);
}

TEST(DriveProfile, TheShippedOnesAreValid) {
  const WholeProfile generic = shipped("generic_cia402");
  for (const char* mode : {"pp", "pv", "hm", "csp", "csv"}) EXPECT_NE(generic.mode(mode), nullptr);
  EXPECT_THAT(generic.mode("pp")->handover.words, ElementsAre(0x0020, 0x0030));
  EXPECT_EQ(generic.homing.methods.count(std::nullopt), 0u);
  for (const int method : {17, 30, 33, 34, 35, 37})
    EXPECT_EQ(generic.homing.methods.count(method), 1u);
}

TEST(DriveProfile, TheDamiaoOneSaysWhatTheManualSays) {
  const WholeProfile damiao = shipped("damiao_dm");
  EXPECT_EQ(damiao.device_type, 0x00030000u);
  EXPECT_EQ(damiao.find("mode_of_operation")->type, DataType::uint16);
  EXPECT_EQ(damiao.find("target_position")->encoding, Encoding::float32);
  const std::pair<const char*, int> modes[] = {
      {"profile_position", 1},  {"cyclic_position", 1},
      {"position_velocity", 2}, {"position_velocity_torque", 3},
      {"profile_velocity", 4},  {"velocity_torque", 5},
      {"profile_torque", 6}};
  for (const auto& [name, value] : modes) {
    ASSERT_NE(damiao.mode(name), nullptr) << name;
    EXPECT_EQ(damiao.mode(name)->value, value) << name;
    EXPECT_TRUE(damiao.mode(name)->handover.words.empty()) << name;
  }
  ASSERT_EQ(damiao.homing.methods.size(), 1u);
  EXPECT_EQ(damiao.homing.methods.count(std::nullopt), 1u) << "the position is declared";
  EXPECT_FALSE(damiao.halt_supported);
  EXPECT_TRUE(damiao.warning_stops);
  EXPECT_THAT(damiao.quick_stop_holds, ElementsAre(4, 3));
  EXPECT_EQ(damiao.sync_counter, 240);
  EXPECT_EQ(damiao.sync_period_step, std::chrono::microseconds(500));
  EXPECT_TRUE(damiao.pdo_map_count_may_be_read_only);
  ASSERT_EQ(damiao.before_enable.size(), 2u);
  EXPECT_EQ(damiao.before_enable[0].object, "quick_stop_option");
  EXPECT_EQ(damiao.before_enable[1].object, "target_position");
  EXPECT_EQ(damiao.before_enable[1].from, "position_actual");
  EXPECT_EQ(damiao.errors.count(0x8201) + damiao.errors.count(0x8250), 2u);
  EXPECT_EQ(drive::missingByCode(damiao, 0x8201), ErrorText::Missing::cycle);
  EXPECT_EQ(drive::missingByCode(damiao, 0x8250), ErrorText::Missing::outputs);
  EXPECT_EQ(drive::missingByCode(damiao, 0x2310), ErrorText::Missing::nothing);
}

struct Mistake {
  const char *from, *to, *problem;
};
// One change each, and what must be said about it: with the line it stands in.
const Mistake kMistakes[] = {
    {"units: {", "untis: {", "small.yaml:2: untis: unknown key, did you mean `units`?"},
    {"name: small", "name: small\nname: twice", "small.yaml:2: name: is given twice"},
    {"position: count,", "position: count/s,",
     "small.yaml:2: units/position: `count/s` is no unit"},
    {"velocity: count/s", "velocity: parsec", "`parsec` is no unit of velocity"},
    {"type: uint16, pdo: rpdo", "type: uint61, pdo: rpdo",
     "small.yaml:4: objects/controlword/type: unknown type, did you mean `uint16`?"},
    {"type: uint16, pdo: rpdo", "type: visible_string, pdo: rpdo", "has no fixed length"},
    {"\"6040:00\"", "\"60X0\"", "small.yaml:4: objects/controlword/object: `60X0` is no object"},
    {"\"6041:00\"", "\"6040:00\"", "6040:00 has the name `controlword` already"},
    {"  statusword:", "  controlword:", "objects/statusword is missing"},
    {"  statusword:", "  controlword:", "small.yaml:5: objects/controlword: is given twice"},
    {"pdo: tpdo}\n  mode_of", "pdo: rpdo}\n  mode_of", "a read-only object cannot be in an RPDO"},
    {"quantity: position, pdo: rpdo", "encoding: bfloat16, quantity: position, pdo: rpdo",
     "floats of 16 bits need a type as wide, not int32"},
    {"\"6060:00\", type: int8", "\"6060:00\", type: int8, encoding: float32",
     "float32 needs a type of 32 bits, not int8"},
    {"quantity: velocity}", "quantity: torque}", "`units` has no entry for what it measures"},
    {"quantity: velocity}", "quantity: velocity, factor: 0}", "factor: must not be 0"},
    {"quantity: velocity}", "quantity: velocity, unit: degC}", "`degC` is no unit of velocity"},
    {"value: 8", "value: 300", "modes/csp/value: must be between -128 and 127, not `300`"},
    {"value: 8", "value: eight", "modes/csp/value: must be a whole number, not `eight`"},
    {"target: target_position", "target: target_positon",
     "no object `target_positon`, did you mean `target_position`?"},
    {"target: target_position", "target: position_actual", "cannot be in an RPDO"},
    {"target: target_position", "target: controlword", "does not measure what the mode controls"},
    {"cyclic: true", "handshake: new_set_point", "needs status_bits/set_point_acknowledge"},
    {"cyclic: true", "controlword_bits: 0x80", "must leave bits 0 to 3 and 7"},
    {"  csp: {",
     "  csp: {value: 8, control: position, target: target_position}\n  cyclic_position: {",
     "small.yaml:13: modes/cyclic_position: the mode cyclic_position is given already"},
    {"control: position", "control: homing", "homing has no target"},
    {"[controlword, target_position]", "[controlword, target_position, controlword]",
     "small.yaml:14: pdos/rpdo1[2]: `controlword` is mapped already, in pdos/rpdo1"},
    {"[controlword, target_position]", "[controlword, profile_velocity]",
     "`profile_velocity` cannot be mapped into an RPDO"},
    {"[statusword, position_actual]", "[statusword, positon_actual]",
     "did you mean `position_actual`?"},
    {"[statusword, position_actual]", "{objects: [statusword], transmission: 250}",
     "transmission types 241 to 251"},
    {"[statusword, position_actual]", "{objects: [statusword], inhibit: 7}",
     "tpdo1/inhibit: must be at least 0 and at most 6.5535"},
    {"  tpdo1:", "  tpdo5:", "no such PDO; there are rpdo1 to rpdo4"},
    {"pdos:", "homing: {kind: drive}\npdos:", "needs `methods`"},
    {"pdos:", "homing: {kind: declare_zero, methods: {1: x}}\npdos:", "`methods` are for kind"},
    {"pdos:", "homing: {kind: drive, methods: {x: y}}\npdos:", "a homing method is a number"},
    {"pdos:", "errors: {0x12345: text}\npdos:", "an error code is a number"},
    {"pdos:", "errors: {0x8201: {text: late, missing: tpdo}}\npdos:", "0x8201/missing: "},
    {"pdos:", "sync: {counter: 1}\npdos:", "1 is no counter"},
    {"pdos:", "startup: [{object: profile_velocity}]\npdos:", "has no value"},
    {"pdos:", "startup: [{object: profile_velocty, raw: 1}]\npdos:",
     "did you mean `profile_velocity`"},
    {"pdos:", "startup: [{object: \"2000:01\", raw: 1}]\npdos:", "add its type"},
    {"pdos:", "startup: [{object: statusword, raw: 1}]\npdos:", "`statusword` is read-only"},
    {"pdos:", "startup: [{object: mode_of_operation, raw: 200}]\npdos:", "between -128 and 127"},
    {"pdos:", "startup: [{object: profile_velocity, from: limits.velocty}]\npdos:",
     "did you mean `limits.velocity`?"},
    {"pdos:", "startup: [{object: target_position, from: position_actual}]\npdos:",
     "copying `position_actual` is only possible in before_enable"},
    {"pdos:", "before_enable: [{object: mode_of_operation, from: position_actual}]\npdos:",
     "is not coded as `mode_of_operation` is"},
    {"pdos:", "startup: [{object: profile_velocity, value: 1, raw: 1}]\npdos:", "keep one"},
    {"pdos:", "startup: [{object: target_position, from: limits.lower}]\npdos:",
     "add `when: homed`"},
    {"pdos:", "before_enable: [{object: target_position, from: limits.upper}]\npdos:",
     "add `when: homed` and move it to startup"},
    {"pdos:", "startup: [{object: profile_velocity, from: limits.velocity, when: homed}]\npdos:",
     "is for position objects with `from: limits.lower` or `limits.upper`"},
    {"pdos:", "startup: [{object: target_position, from: limits.lower, when: moved}]\npdos:",
     "unknown word `moved`"},
    {"modes:", "coordinates: {profile_velocty: none}\nmodes:",
     "`profile_velocty` is neither an object of the profile nor a range"},
    {"modes:", "coordinates: {\"607C\": set_positon}\nmodes:", "did you mean `set_position`?"},
    {"objects:", "encodings: {\"2001-1FFF\": float32}\nobjects:",
     "encodings/2001-1FFF: `2001-1FFF` is no range of objects"},
    {"objects:", "encodings: {\"2001\": float23}\nobjects:", "did you mean `float32`?"},
    {"objects:",
     "encodings: {\"2001\": float32}\nstartup: [{object: \"2001:01\", type: int32, "
     "raw: -1}]\nobjects:",
     "startup[0]/raw: 0xFFFFFFFF is no finite number in an object that holds a float"},
    {"objects:",
     "encodings: {\"2001\": float32}\nstartup: [{object: \"2001:01\", type: int32, "
     "value: .nan}]\nobjects:",
     "must be a finite number"},
    {"objects:",
     "encodings: {\"2001\": float32}\nstartup: [{object: \"2001:01\", type: int32, "
     "value: 1e39}]\nobjects:",
     "does not fit the float that the object holds"},
    {"pdos:", "startup: [{object: profile_velocity, value: 1, times: 2}]\npdos:",
     "there is no `from`"},
};

TEST(DriveProfile, TellsEveryMistakeWithItsPlace) {
  for (const Mistake& mistake : kMistakes) {
    EXPECT_THAT(problemsOf(changed(mistake.from, mistake.to)), HasSubstr(mistake.problem))
        << mistake.to;
  }
}

TEST(DriveProfile, ObjectsAreFloatsByTheirPlace) {
  Problems problems;
  const WholeProfile profile = parseDriveFamily(
      changed("objects:",
              "encodings: {\"2000-20FF\": float32, \"2003\": integer, \"2003:05-06\": "
              "bfloat16}\nobjects:\n"
              "  gain: {object: \"2001:02\", type: uint32}\n"
              "  count: {object: \"2001:03\", type: uint32, encoding: integer}\n"
              "  flag: {object: \"2001:04\", type: uint8}"),
      "small.yaml", problems);
  EXPECT_EQ(problems.text(), "");
  EXPECT_EQ(profile.find("gain")->encoding, Encoding::float32);
  EXPECT_EQ(profile.find("count")->encoding, Encoding::integer);
  EXPECT_EQ(profile.find("flag")->encoding, Encoding::integer);
  EXPECT_EQ(profile.encodingOf({0x2001, 2}, DataType::uint32), Encoding::float32);
  EXPECT_EQ(profile.encodingOf({0x2001, 3}, DataType::uint32), Encoding::integer);
  EXPECT_EQ(profile.encodingOf({0x20FF, 0xFF}, DataType::int32), Encoding::float32);
  EXPECT_EQ(profile.encodingOf({0x2100, 0}, DataType::int32), Encoding::integer);
  EXPECT_EQ(profile.encodingOf({0x2003, 1}, DataType::uint32), Encoding::integer);
  EXPECT_EQ(profile.encodingOf({0x2003, 5}, DataType::uint16), Encoding::bfloat16);
  EXPECT_EQ(profile.encodingOf({0x2100, 0}, DataType::real32), Encoding::float32);
  ASSERT_TRUE(profile.unnamedFloat({0x2002, 1}, 4));
  EXPECT_EQ(profile.unnamedFloat({0x2002, 1}, 4)->encoding, Encoding::float32);
  EXPECT_FALSE(profile.unnamedFloat({0x2002, 0}, 1)) << "the number of sub-indices";
  EXPECT_FALSE(profile.unnamedFloat({0x2003, 1}, 4));
}

TEST(DriveProfile, TheDamiaoManualsFloatsAreFloats) {
  const WholeProfile damiao = shipped("damiao_dm");
  for (const ObjectId id : {ObjectId{0x2002, 1}, ObjectId{0x2002, 9}, ObjectId{0x2002, 0x0C},
                            ObjectId{0x2004, 3}, ObjectId{0x2005, 1}, ObjectId{0x2006, 2},
                            ObjectId{0x2008, 1}, ObjectId{0x2009, 2}, ObjectId{0x200A, 4}}) {
    EXPECT_TRUE(damiao.unnamedFloat(id, 4)) << fieldbus::toString(id);
  }
  for (const ObjectId id :
       {ObjectId{0x2001, 3}, ObjectId{0x2002, 0x0A}, ObjectId{0x2002, 0x0D}, ObjectId{0x2002, 0x0E},
        ObjectId{0x2003, 2}, ObjectId{0x2008, 2}, ObjectId{0x200B, 1}}) {
    EXPECT_FALSE(damiao.unnamedFloat(id, 4)) << fieldbus::toString(id);
  }
}

TEST(DriveProfile, ObjectsThatShiftCoordinatesAreMarkedOnEveryDrive) {
  Problems problems;
  const WholeProfile profile = parseDriveFamily(kSmall, "small.yaml", problems);
  using Mark = CoordinateMark;
  EXPECT_EQ(profile.coordinateMark({0x607C, 0}), Mark::home);
  EXPECT_EQ(profile.coordinateMark({0x687C, 0}), Mark::home) << "of the device's second axis";
  EXPECT_EQ(profile.coordinateMark({0x6064, 0}), Mark::set_position);
  EXPECT_EQ(profile.coordinateMark({0x1011, 4}), Mark::restore_parameters);
  for (const ObjectId id : {ObjectId{0x607E, 0}, ObjectId{0x608F, 1}, ObjectId{0x6091, 1},
                            ObjectId{0x6092, 2}, ObjectId{0x6093, 1}, ObjectId{0x6096, 1}}) {
    EXPECT_EQ(profile.coordinateMark(id), Mark::configuration) << fieldbus::toString(id);
  }
  for (const ObjectId id : {ObjectId{0x1010, 1}, ObjectId{0x1017, 0}, ObjectId{0x2000, 1},
                            ObjectId{0x6040, 0}, ObjectId{0x6065, 0}, ObjectId{0x607A, 0},
                            ObjectId{0x607D, 1}, ObjectId{0x6098, 0}, ObjectId{0x60C2, 1}}) {
    EXPECT_EQ(profile.coordinateMark(id), Mark::none) << fieldbus::toString(id);
  }
}

TEST(DriveProfile, AProfileMarksItsOwnObjectsAndTakesMarksAway) {
  Problems problems;
  const WholeProfile profile = parseDriveFamily(
      changed("modes:",
              "coordinates: {\"607E\": none, \"2000-2001\": calibration, \"2001:03\": none, "
              "profile_velocity: set_position}\nmodes:"),
      "small.yaml", problems);
  EXPECT_EQ(problems.text(), "");
  using Mark = CoordinateMark;
  EXPECT_EQ(profile.coordinateMark({0x607E, 0}), Mark::none);
  EXPECT_EQ(profile.coordinateMark({0x607C, 0}), Mark::home);
  EXPECT_EQ(profile.coordinateMark({0x2001, 2}), Mark::calibration);
  EXPECT_EQ(profile.coordinateMark({0x2001, 3}), Mark::none);
  EXPECT_EQ(profile.coordinateMark({0x6081, 0}), Mark::set_position);
  const WholeProfile damiao = shipped("damiao_dm");
  EXPECT_EQ(damiao.coordinateMark({0x200B, 2}), Mark::set_position);
  EXPECT_EQ(damiao.coordinateMark({0x200B, 1}), Mark::none);
  EXPECT_EQ(damiao.coordinateMark({0x2002, 0x0D}), Mark::calibration);
}

TEST(DriveProfile, OnlyFixedPdosMayShareAnObject) {
  const std::string rules = R"(
pdo_rules:
  fixed:
    rpdo1: [controlword, target_position]
    rpdo2: [controlword]
    tpdo1: [statusword, position_actual]
    tpdo2: [statusword]
)";
  Problems problems;
  const WholeProfile profile = parseDriveFamily(kSmall + rules, "small.yaml", problems);
  EXPECT_EQ(problems.text(), "");
  ASSERT_EQ(profile.fixed_pdos.size(), 4u);
  EXPECT_THAT(profile.fixed_pdos[1].objects, ElementsAre("controlword"));
  EXPECT_THAT(problemsOf(changed("  tpdo1:", "  rpdo2: [controlword]\n  tpdo1:")),
              HasSubstr("`controlword` is mapped already, in pdos/rpdo1"));
}

TEST(DriveProfile, AnEventDrivenTpdoThatWouldNeverComeIsRefusedWhereTheDriveSendsItByTimerOnly) {
  const auto with = [](const std::string& tpdo, const std::string& rules) {
    return changed("tpdo1: [statusword, position_actual]",
                   "tpdo1: {objects: [statusword, position_actual], " + tpdo + "}") +
           rules;
  };
  const std::string by_timer = "pdo_rules: {type_255_by_timer: true}\n";
  EXPECT_THAT(problemsOf(with("transmission: 255", by_timer)),
              HasSubstr("pdos/tpdo1/transmission: 255 without `event_timer` is never sent by this "
                        "drive"));
  EXPECT_EQ(problemsOf(with("transmission: 255, event_timer: 0.01", by_timer)), "");
  EXPECT_EQ(problemsOf(with("transmission: 254", by_timer)), "");
  EXPECT_EQ(problemsOf(with("transmission: 255", "")), "") << "on a change, as CiA 301 has it";
  EXPECT_TRUE(shipped("damiao_dm").type_255_by_timer);
}

TEST(DriveProfile, AnRpdoOfAnotherTypeThanItsObjectDemandsIsRefused) {
  const auto with = [](const std::string& demanded, const std::string& rpdo) {
    std::string text = changed("quantity: position, pdo: rpdo}",
                               "quantity: position, pdo: rpdo, transmission: " + demanded + "}");
    const std::string from = "rpdo1: [controlword, target_position]";
    return text.replace(text.find(from), from.size(), "rpdo1: " + rpdo);
  };
  const std::string listed = "[controlword, target_position]";  // of type 1
  EXPECT_EQ(problemsOf(with("1", listed)), "");
  EXPECT_EQ(problemsOf(with("255", "{objects: " + listed + ", transmission: 255}")), "");
  EXPECT_THAT(problemsOf(with("1", "{objects: " + listed + ", transmission: 255}")),
              HasSubstr("pdos/rpdo1: has transmission type 255, but `target_position` must come "
                        "with type 1 (its `transmission` in profile small)"));
  EXPECT_THAT(problemsOf(with("252", listed)),
              HasSubstr("objects/target_position/transmission: an RPDO has a type from 0 to 240"));
  EXPECT_THAT(problemsOf(changed("access: ro, pdo: tpdo}",
                                 "access: ro, pdo: tpdo, "
                                 "transmission: 1}")),
              HasSubstr("transmission: is for objects that can be in an RPDO"));
  EXPECT_EQ(shipped("sv660c").find("interpolation_target")->transmission, 1) << "[15961]";
}

TEST(DriveProfile, RefusesMoreThanSixtyFourBitsInAPdo) {
  const std::string text =
      changed("[statusword, position_actual]", "[statusword, position_actual, mode_display]");
  EXPECT_EQ(problemsOf(text), "");  // 56 bits
  std::string wide = changed("\"6061:00\", type: int8", "\"6061:00\", type: int32");
  const std::string from = "[statusword, position_actual]";
  wide.replace(wide.find(from), from.size(), "[statusword, position_actual, mode_display]");
  EXPECT_THAT(problemsOf(wide),
              HasSubstr("small.yaml:15: pdos/tpdo1: is 80 bits long (16 + 32 + 32)"));
}

TEST(DriveProfile, TellsAllMistakesAtOnce) {
  Problems problems;
  std::string text = changed("value: 8", "value: x");
  text.replace(text.find("int32"), 5, "int23");
  text.replace(text.find("rpdo1:"), 6, "rpdo9:");
  parseDriveFamily(text, "small.yaml", problems);
  EXPECT_EQ(problems.list().size(), 3u) << problems.text();
}

TEST(DriveProfile, SaysThatTextIsNoYaml) {
  EXPECT_THAT(problemsOf("a: [1\nb: {"), HasSubstr("is no YAML"));
  EXPECT_THAT(problemsOf("just words"), HasSubstr("is no drive profile"));
  Problems problems;
  loadDriveFamily("/nowhere/x.yaml", problems);
  EXPECT_EQ(problems.text(), "  /nowhere/x.yaml: cannot be read\n");
}

TEST(DriveProfile, KnowsTheShortNamesOfModes) {
  EXPECT_EQ(drive::canonicalModeName("pp"), "profile_position");
  EXPECT_EQ(drive::canonicalModeName("vl"), "velocity");
  EXPECT_EQ(drive::canonicalModeName("pv"), "profile_velocity");
  EXPECT_EQ(drive::canonicalModeName("pt"), "profile_torque");
  EXPECT_EQ(drive::canonicalModeName("hm"), "homing");
  EXPECT_EQ(drive::canonicalModeName("ip"), "interpolated_position");
  EXPECT_EQ(drive::canonicalModeName("csp"), "cyclic_position");
  EXPECT_EQ(drive::canonicalModeName("csv"), "cyclic_velocity");
  EXPECT_EQ(drive::canonicalModeName("cst"), "cyclic_torque");
  EXPECT_EQ(drive::canonicalModeName("velocity_torque"), "velocity_torque");
}

}  // namespace
}  // namespace cia402::config
