// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Objects of the SV660C and the DM5 whose length their manuals leave open: each boot learns it.
#include "system/families_bus_scene.h"
#include "system/families_motion.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::Contains;
using testing::HasSubstr;

/// Rows of the simulated drive's dictionary, longer than its profile has them.
struct WiderObjects {
  const char* name;
  std::string rows;
};
void PrintTo(const WiderObjects& wider, std::ostream* out) { *out << wider.name; }

std::string widerName(const testing::TestParamInfo<WiderObjects>& tested) {
  return tested.param.name;
}

/// Homes, goes, and changes its mode; by its motor.
void expectServes(Scene& scene, const std::string& other_mode) {
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  const double from = scene.position("joint");
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(2s);
  EXPECT_NEAR(scene.position("joint"), from + 0.3, 1e-3) << scene.told();
  const bus::Answer switched = scene.procedure(ProcedureKind::set_mode, "joint", other_mode);
  ASSERT_TRUE(switched.success) << switched.message;
  EXPECT_EQ(scene.truth("joint").mode, 3);
  scene.stream("joint", 0.4, 400ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.4, 3e-3);
}

// Printed as registers of 16 bits, in the maps as 8 [L13799, L15155-15213, L15582, L15762, L15965].
const char* const kSv660cRows[] = {"[0x6060, 0, mode, int16, rw, r, 0, 0, 10]",
                                   "[0x6061, 0, mode_display, int16, ro, t, 0]",
                                   "[0x6098, 0, homing_method, int16, rw, r, 1, -3, 37]",
                                   "[0x607E, 0, polarity, uint16, rw, -, 0, 0, 128]",
                                   "[0x60C2, 1, period, uint16, rw, -, 1, 1, 20]",
                                   "[0x60C2, 2, exponent, int16, rw, -, -3]"};

std::string allRows(std::initializer_list<int> which) {
  std::string rows;
  for (const int row : which) rows += std::string(rows.empty() ? "" : ", ") + kSv660cRows[row];
  return rows;
}

class Sv660cWidths : public testing::TestWithParam<WiderObjects> {};

TEST_P(Sv660cWidths, AreLearntAndUsedInWritesAndMaps) {
  const std::string& rows = GetParam().rows;
  TracedScene scene(sv660cJoint(", mode: ip, homing: {method: 35}",
                                rows.empty() ? "" : sv660cDelivered(rows), "0.004", "[ip, pv]"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  const bool mode = rows.find("0x6060") != std::string::npos;
  const bool method = rows.find("0x6098") != std::string::npos;
  const bool display = rows.find("0x6061") != std::string::npos;
  for (std::uint8_t i = 1; i <= numberIn(scene, 0x1A00); ++i) {
    const std::uint64_t entry = numberIn(scene, 0x1A00, i);
    if (entry >> 16U == 0x6061) {
      EXPECT_EQ(entry & 0xFFU, display ? 16U : 8U);
    }
  }
  ASSERT_NO_FATAL_FAILURE(expectServes(scene, "pv"));
  EXPECT_EQ(numberIn(scene, 0x60C2, 1), 4U) << "ms";
  EXPECT_THAT(scene.lines,
              Contains(method ? "601 2B 98 60 00 23 00 00 00" : "601 2F 98 60 00 23 00 00 00"));
  const bus::ObjectAnswer shown = scene.call(bus::ReadObjectCommand{"joint", "mode_of_operation"});
  EXPECT_EQ(shown.number, 3.0) << shown.message << mode;
  const bus::ObjectAnswer period =
      scene.call(bus::ReadObjectCommand{"joint", "interpolation_period_exponent"});
  EXPECT_EQ(period.number, -3.0) << period.message;
}

INSTANTIATE_TEST_SUITE_P(Of, Sv660cWidths,
                         testing::Values(WiderObjects{"OneByteEach", ""},
                                         WiderObjects{"Mode", allRows({0})},
                                         WiderObjects{"ModeDisplay", allRows({1})},
                                         WiderObjects{"HomingMethod", allRows({2})},
                                         WiderObjects{"Polarity", allRows({3})},
                                         WiderObjects{"Period", allRows({4, 5})},
                                         WiderObjects{"TwoBytesEach", allRows({0, 1, 2, 3, 4, 5})}),
                         widerName);

/// Every object of 2000h to 2FFFh that has 16 bits in the simulated drive, with 32.
std::string dm5RowsOf32Bits() {
  const YAML::Node file =
      YAML::LoadFile(test::configFolder() + "/simulated_drives/megmeet_dm5.yaml");
  std::string rows;
  for (const YAML::Node& row : file["dictionary"]) {
    if (!row.IsSequence() || row[0].as<int>() < 0x2000 || row[0].as<int>() > 0x2FFF) continue;
    const auto type = row[3].as<std::string>();
    if (type != "uint16" && type != "int16") continue;
    rows += rows.empty() ? "[" : ", [";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string cell =
          i == 3 ? type.substr(0, type.size() - 2) + "32" : row[i].as<std::string>();
      rows += (i == 0 ? "" : ", ") + cell;
    }
    rows += "]";
  }
  return rows;
}

class Dm5Widths : public testing::TestWithParam<WiderObjects> {};

constexpr FamilyMode kDm5OfOpenWidths{"megmeet_dm5", "8388608", "csp"};

TEST_P(Dm5Widths, AreLearntAndUsedInWritesChecksAndMaps) {
  const std::string& rows = GetParam().rows;
  TracedScene scene(familyJointWith(
      kDm5OfOpenWidths, "[csp, pv, pt]",
      ", homing: {method: 17, search_velocity: 0.4, zero_velocity: 0.05, acceleration: 2.0}, "
      "write: [{object: di1_function, raw: 36}, {object: brake_on_delay, value: 0.1}], "
      "simulation: {lower_limit_switch: -0.2, with: {dictionary: [" +
          rows + "]}}"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  const double at_switch = -0.2;
  ASSERT_NO_FATAL_FAILURE(expectServes(scene, "pv"));
  EXPECT_GT(scene.position("joint"), at_switch + 0.25);
  EXPECT_EQ(numberIn(scene, 0x2002, 1), 7U) << "adjusted";
  EXPECT_EQ(numberIn(scene, 0x2003, 1), 36U);
  EXPECT_EQ(numberIn(scene, 0x2002, 11), 100U) << "ms";
  scene.drive("joint").dictionary().find({0x200B, 32})->number = 0xFFFFFFECU;  // of 16 bits or 32
  for (const auto& [name, number] :
       {std::pair("mode_of_operation", 3.0), std::pair("homing_method", 17.0),
        std::pair("motor_rated_torque", 127.0), std::pair("di4_function", 35.0),
        std::pair("module_temperature", -20.0), std::pair("torque_slope", 1000.0)}) {
    const bus::ObjectAnswer read = scene.call(bus::ReadObjectCommand{"joint", name});
    EXPECT_TRUE(read.success) << read.message;
    EXPECT_EQ(read.number, number) << read.message;
  }
  // By index, of which no name tells a length.
  const auto written = scene.call(bus::WriteObjectCommand{"joint", "2008:06", "750"});
  EXPECT_TRUE(written.success) << written.message;
  EXPECT_EQ(numberIn(scene, 0x2008, 6), 750U);
  scene.stream("joint", 0.0, 500ms);
  const auto switched = scene.procedure(ProcedureKind::set_mode, "joint", "pt");
  EXPECT_TRUE(switched.success) << switched.message;
  scene.stream("joint", 4.0, 500ms);
  EXPECT_GT(scene.velocity("joint"), 0.1);
}

INSTANTIATE_TEST_SUITE_P(
    Of, Dm5Widths,
    testing::Values(
        WiderObjects{"AsTheProfileHasThem", ""},
        WiderObjects{"ModesOf16Bits",
                     "[0x6060, 0, mode, int16, rw, r, 0], [0x6061, 0, display, int16, ro, t, 0], "
                     "[0x6098, 0, method, int16, rw, r, 0]"},
        WiderObjects{"TorqueSlopeOf32Bits", "[0x6087, 0, torque_slope, uint32, rw, r, 1000]"},
        WiderObjects{"TouchProbeFunctionWithoutSign",
                     "[0x60B8, 0, touch_probe_function, uint16, rw, r, 0]"},
        WiderObjects{"MakersObjectsOf32Bits", dm5RowsOf32Bits()}),
    widerName);

// Longer than any reading of the manual has it.
TEST(Sv660cWidth, ThatNoManualHasIsRefusedInWords) {
  Scene scene(loadText(
      sv660cJoint({}, sv660cDelivered("[0x6098, 0, homing_method, int32, rw, r, 1, -3, 37]"))));
  EXPECT_FALSE(scene.boot(10s));
  EXPECT_THAT(scene.told(), HasSubstr("6098:00 homing_method has 4 bytes in the drive, and not 1 "
                                      "to 2 as its profile allows"));
}

}  // namespace
}  // namespace cia402
