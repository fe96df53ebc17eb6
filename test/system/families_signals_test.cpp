// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What each family tells beside its motion: voltages, temperatures, currents, states and inputs,
// with the units of its manual.
#include "system/families_motion.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

struct ToldNumber {
  const char* name;
  fieldbus::ObjectId id;
  std::uint64_t raw;  ///< in the drive
  const char* words;  ///< of read_object
  bool signal;        ///< among the `signals` of the profile
};
struct FamilyNumbersTold {
  FamilyMode tested;
  std::vector<ToldNumber> numbers;
};
void PrintTo(const FamilyNumbersTold& told, std::ostream* out) { *out << told.tested.family; }

std::string yamlOfAny(const FamilyMode& tested) {
  const std::string family = tested.family;
  return family == "sv660c"      ? sv660cJoint()
         : family == "damiao_dm" ? damiaoJoint()
                                 : familyJoint(tested);
}

/// The drive tells this number, whatever it would show by itself.
void tells(Scene& scene, const ToldNumber& told) {
  sim::ObjectDictionary& dictionary = scene.drive("joint").dictionary();
  dictionary.onRead(told.id, {});
  dictionary.find(told.id)->number = told.raw;
}

class FamilySignals : public testing::TestWithParam<FamilyNumbersTold> {};

TEST_P(FamilySignals, AreToldWithTheUnitsOfTheManual) {
  FamilyScene scene(yamlOfAny(GetParam().tested));
  for (const ToldNumber& told : GetParam().numbers) {
    tells(scene, told);
    const auto read = scene.call(bus::ReadObjectCommand{"joint", told.name});
    EXPECT_TRUE(read.success) << told.name << ": " << read.message;
    EXPECT_THAT(read.message, HasSubstr(told.words)) << told.name;
  }
}

TEST_P(FamilySignals, OfTheProfileAreAskedForByWhoeverLooks) {
  FamilyScene scene(yamlOfAny(GetParam().tested));
  for (const ToldNumber& told : GetParam().numbers) {
    tells(scene, told);
  }
  for (int i = 0; i < 4; ++i) {
    scene.axis("joint").look();
    scene.run(600ms);
  }
  const std::vector<drive::ShownSignal> shown = scene.axis("joint").signals(scene.now());
  for (const ToldNumber& told : GetParam().numbers) {
    const auto signal = std::find_if(shown.begin(), shown.end(), [&](const auto& one) {
      return one.object != nullptr && one.object->name == told.name;
    });
    EXPECT_EQ(signal != shown.end(), told.signal) << told.name;
    if (signal == shown.end()) continue;
    EXPECT_TRUE(signal->known) << told.name;
    EXPECT_EQ(signal->raw, told.raw) << told.name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, FamilySignals,
    testing::Values(
        FamilyNumbersTold{{kNimotionStepper, "4000", "csp"},
                          {{"bus_voltage", {0x200B, 8}, 27, "27 V", true},
                           {"drive_state", {0x200B, 1}, 2, " 2", true},
                           {"digital_outputs_seen", {0x200B, 4}, 1, " 1", true},
                           {"virtual_inputs_seen", {0x200B, 5}, 2, " 2", true},
                           {"motor_speed", {0x200B, 2}, 121, " 121", true},
                           {"motor_max_speed", {0x2000, 2}, 2000, " 2000", false},
                           {"powered_time", {0x200B, 6}, 10, "9000 s", false},
                           {"rated_voltage", {0x2000, 1}, 24, "24 V", false},
                           {"pwm_duty", {0x200B, 7}, 40, " 40", false}}},
        FamilyNumbersTold{{kId286Cnfa, "10000", "pp"},
                          {{"bus_voltage", {0x2065, 0}, 4710, "47.1 V", true},
                           {"motor_current_actual", {0x2064, 0}, 2800, "2.8 A", true},
                           {"alarm_code", {0x206C, 0}, 25, " 25", true},
                           {"run_state", {0x206D, 0}, 3, " 3", true},
                           {"hardware_version", {0x206E, 0}, 101, " 101", false},
                           {"1018:01", {0x1018, 1}, 0x286, " 86 02 00 00", false},
                           {"1018:02", {0x1018, 2}, 0xCFA0, " A0 CF 00 00", false},
                           {"software_version", {0x206F, 0}, 102, " 102", false}}},
        FamilyNumbersTold{{kMegmeetDm5, "8388608", "csp"},
                          {{"bus_voltage", {0x200B, 10}, 47, "47 V", true},
                           {"module_temperature", {0x200B, 32}, 412, "41.2 degC", true},
                           {"motor_load", {0x200B, 9}, 335, " 335", true},
                           {"drive_status", {0x200B, 12}, 5, " 5", true},
                           {"control_voltage", {0x200B, 11}, 46, "46 V", false}}},
        // H0b.12, .24, .26, .27, .63, .66, .67; 203Fh [L8413-8997, L14982]
        FamilyNumbersTold{{"sv660c", "100000", "ip"},
                          {{"dc_link_voltage", {0x200B, 0x1B}, 3105, "310.5 V", true},
                           {"phase_current", {0x200B, 0x19}, 27, "2.7 A", true},
                           {"module_temperature", {0x200B, 0x1C}, 48, "48 degC", true},
                           {"encoder_temperature", {0x200B, 0x43}, 0xFFF6, "-10 degC", true},
                           {"average_load", {0x200B, 0x0D}, 455, " 455", true},
                           {"brake_resistor_load", {0x200B, 0x44}, 120, " 120", true},
                           {"not_ready_reason", {0x200B, 0x40}, 3, " 3", true},
                           {"fault_codes", {0x203F, 0}, 0x06200620, "0x06200620", true}}},
        // The bits of 41.5, 36.25 and 2.5 as floats.
        FamilyNumbersTold{{"damiao_dm", "", "csp"},
                          {{"mosfet_temperature", {0x200A, 1}, 0x42260000, "41.5 degC", true},
                           {"motor_temperature", {0x200A, 2}, 0x42110000, "36.25 degC", true}}}),
    [](const auto& tested) { return std::string(tested.param.tested.family); });

/// Inputs as the drive has them, and how they are called.
struct NamedInput {
  FamilyMode tested;
  fieldbus::ObjectId object;
  std::uint32_t bits;
  const char* words;
};
void PrintTo(const NamedInput& input, std::ostream* out) { *out << input.words; }

class FamilyInputs : public testing::TestWithParam<NamedInput> {};

TEST_P(FamilyInputs, AreToldByTheirNames) {
  Scene scene(loadText(familyJoint(GetParam().tested)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  scene.drive("joint").dictionary().find(GetParam().object)->number = GetParam().bits;
  const auto read = scene.call(bus::ReadObjectCommand{"joint", "digital_inputs"});
  EXPECT_THAT(read.message, HasSubstr(GetParam().words)) << read.message;
  ASSERT_TRUE(
      scene.runUntil([&] { return scene.state("joint").digital_inputs == GetParam().bits; }, 2s));
  EXPECT_TRUE(scene.state("joint").digital_inputs_valid);
}

constexpr FamilyMode kInputsOfNimotion{"nimotion_stepper", "4000", "csp"},
    kInputsOfDm5{"megmeet_dm5", "8388608", "csp"};

INSTANTIATE_TEST_SUITE_P(
    All, FamilyInputs,
    testing::Values(NamedInput{kInputsOfNimotion, {0x200B, 3}, 0x01, "di0"},
                    NamedInput{kInputsOfNimotion, {0x200B, 3}, 0x16, "di1, di2, di4"},
                    NamedInput{kInputsOfNimotion, {0x200B, 3}, 0x08, "di3"},
                    NamedInput{kInputsOfDm5, {0x60FD, 0}, 0x00000001, "reverse limit"},
                    NamedInput{kInputsOfDm5, {0x60FD, 0}, 0x00000002, "forward limit"},
                    NamedInput{kInputsOfDm5, {0x60FD, 0}, 0x00000004, "home switch"},
                    NamedInput{kInputsOfDm5, {0x60FD, 0}, 0x000F0000, "di1, di2, di3, di4"},
                    NamedInput{kInputsOfDm5, {0x60FD, 0}, 0x01000000, "sto"},
                    NamedInput{kInputsOfDm5, {0x60FD, 0}, 0x02000000, "index pulse"},
                    NamedInput{kInputsOfDm5, {0x60FD, 0}, 0x0C000000, "probe 1, probe 2"}),
    [](const auto& tested) {
      return std::string(tested.param.tested.family) + "_" + std::to_string(tested.index);
    });

}  // namespace
}  // namespace cia402
