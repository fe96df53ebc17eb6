// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What 203Fh says of an error stands in its sentence, and parameters have the maker's names.
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Sv660cShown {
  const char* fault;  // of the simulated drive
  const char* code;   // 603Fh
  const char* shown;  // what the panel shows, and 203Fh [L14982-14984]
};

class Sv660cDetails : public testing::TestWithParam<Sv660cShown> {};

TEST_P(Sv660cDetails, StandInTheSentenceOfTheError) {
  Sv660cReady scene;
  scene.inject("joint", GetParam().fault);
  scene.run(500ms);
  const std::string text = scene.axis("joint").faultText();
  EXPECT_THAT(text, AllOf(HasSubstr(GetParam().code), HasSubstr(GetParam().shown)));
  EXPECT_THAT(scene.told(), HasSubstr(text)) << "people are told all of it";
}

INSTANTIATE_TEST_SUITE_P(
    Of, Sv660cDetails,
    testing::Values(
        Sv660cShown{"product_mismatch", "fault 0xFF00",
                    "; E120 drive and motor do not fit (fault_codes (203F:00) 0x01200120)"},
        Sv660cShown{"runaway", "fault 0xFF00",
                    "; E234 runaway (fault_codes (203F:00) 0x02340234): phases of the motor"},
        Sv660cShown{"phase_loss", "fault 0x3130",
                    "; E420 phase of the mains missing (fault_codes (203F:00) 0x04200420)"},
        Sv660cShown{"overspeed", "fault 0x7310", "; E500 over speed (fault_codes (203F:00) 0x0500"},
        Sv660cShown{"motor_overload", "fault 0x3230", "; E620 motor overload (fault_codes"},
        Sv660cShown{"locked_rotor", "fault 0x7121", "; E630 motor blocked (fault_codes"},
        Sv660cShown{"following_error", "fault 0x8611",
                    "; EB00 following error (fault_codes (203F:00) 0x0B000B00)"},
        Sv660cShown{"position_command", "fault 0xFF00",
                    "; EB01 position commands (fault_codes (203F:00) 0x0B010B01): they come too"},
        Sv660cShown{"home_offset", "fault 0xFF00",
                    "; EE09 home offset beyond the position limits (fault_codes"},
        Sv660cShown{"overload_warning", "warning 0x3230", "; E909 motor overload ahead (fault"},
        Sv660cShown{"forward_limit", "warning 0x8612", "; E950 forward position limit (fault"},
        Sv660cShown{"reverse_limit", "warning 0x8612", "; E952 reverse position limit (fault"},
        Sv660cShown{"phase_loss_warning", "warning 0x3130", "; E990 phase of the mains missing"}),
    [](const auto& tested) { return std::string(tested.param.fault); });

TEST(Sv660cDetail, ThatNobodyKnowsIsShownAsItIs) {
  Sv660cReady scene(sv660cJoint({}, "with: {faults: {odd: {code: 0xFF00, details: 0x27401740}}}"));
  scene.inject("joint", "odd");
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              HasSubstr("; E1740 (fault_codes (203F:00) 0x27401740); then clear_faults"));
}

// One code in 603Fh, two warnings.
TEST(Sv660cDetail, IsThatOfTheErrorThatStands) {
  Sv660cReady scene;
  scene.inject("joint", "forward_limit");
  scene.run(300ms);
  EXPECT_THAT(scene.axis("joint").faultText(), HasSubstr("E950 forward position"));
  scene.inject("joint", "reverse_limit");
  scene.run(300ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("E952 reverse"), Not(HasSubstr("E950 forward position"))));
  scene.inject("joint", "clear");
  scene.run(300ms);
  EXPECT_EQ(scene.axis("joint").faultText(), "");
  scene.inject("joint", "overspeed");
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(), AllOf(HasSubstr("E500"), Not(HasSubstr("E952"))));
}

TEST(Sv660cDetail, IsLeftOutWhereTheDriveDoesNotTellIt) {
  Sv660cReady scene(sv660cJoint({}, "with: {without: [0x203F]}"));
  scene.inject("joint", "overspeed");
  scene.run(500ms);
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("fault 0x7310"), Not(HasSubstr("203F"))));
  EXPECT_THAT(scene.told(), HasSubstr("fault 0x7310"));
}

// Hxx.yy: index 2000h + xx, sub-index yy + 1, xx hexadecimal, yy decimal [L16266-16274].
TEST(Sv660cParameterName, FindsItsObject) {
  Sv660cReady scene;
  struct Named {
    const char* name;
    const char* told;
  };
  for (const Named& c : {Named{"H02.00", "2002:01 H02.00 control_mode is 8 (0x0008): CANopen"},
                         Named{"h0e.13", "200E:0E H0E.13 sync_tolerance is 0 (0x0000): a quarter"},
                         Named{"H0A.40", "200A:29 H0A.40 software_limit_enable is 2"},
                         Named{"H00.31", "2000:20 H00.31 encoder_resolution is 8388608"},
                         Named{"H05.35 u16", "2005:24 H05.35 homing_time_limit is"},
                         Named{"H02.15", "2002:10 H02.15 is"},
                         Named{"H31.04", "2031:05 H31.04 output_levels is 0"}}) {
    const bus::ObjectAnswer read = sv660cRead(scene, c.name);
    EXPECT_TRUE(read.success) << read.message;
    EXPECT_THAT(read.message, HasSubstr(c.told));
  }
  EXPECT_THAT(sv660cRead(scene, "2002:01").message, HasSubstr("2002:01 H02.00 control_mode is 8"));
}

TEST(Sv660cParameterName, IsWrittenToAlsoFromTheRobotsFile) {
  Sv660cReady scene(
      sv660cWrites("{object: H08.02, value: 480}, {object: H08.09, raw: 1, "
                   "type: uint16}"));
  EXPECT_EQ(sv660cNumber(scene, 0x2008, 3), 480U) << "position_gain, 48.0 Hz";
  EXPECT_EQ(sv660cNumber(scene, 0x2008, 10), 1U);
  const bus::Answer written = sv660cWrite(scene, "H08.00", "250");
  EXPECT_TRUE(written.success) << written.message;
  EXPECT_THAT(written.message, HasSubstr("2008:01 H08.00 speed_gain"));
  EXPECT_EQ(sv660cNumber(scene, 0x2008, 1), 250U);
  const bus::Answer unnamed = sv660cWrite(scene, "H08.09", "0");
  EXPECT_TRUE(unnamed.success) << unnamed.message;
  EXPECT_EQ(sv660cNumber(scene, 0x2008, 10), 0U);
  const bus::Answer refused = sv660cWrite(scene, "H02.00", "1");
  EXPECT_FALSE(refused.success) << "while stopped only";
}

// As chapter 3 prints them: H00.10 0.01 kW [L1995], H01.25 0.01 [L2845], H03.51 0.01 ms [L4300],
// H06.03 with a sign [L5725], H12.21 0.1 s [L11056], H08.00 0.1 Hz [L6442].
TEST(Sv660cParameterName, IsReadAndWrittenAsTheManualPrintsIts) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  struct Row {
    const char *name, *read, *value;
    std::uint16_t index;
    std::uint8_t sub;
    std::uint64_t number;
  };
  for (const Row& row :
       {Row{"H00.10", "is 75 (0x004B), in the manual 0.75", "1.5", 0x2000, 0x0B, 150},
        Row{"H01.25", "is 100 (0x0064), in the manual 1.00", "0.05", 0x2001, 0x1A, 5},
        Row{"H03.51", "is 200 (0x00C8), in the manual 2.00", "2.57", 0x2003, 0x34, 257},
        Row{"H12.21", "is 50 (0x0032), in the manual 5.0", "70", 0x2012, 0x16, 70},
        Row{"H08.00", "is 400 (0x0190)", "25.0", 0x2008, 1, 250},
        Row{"H06.03", "is 200 (0x00C8)", "-5", 0x2006, 4, 0xFFFB},
        Row{"H12.20", "is 0 (0x0000)", "-1200", 0x2012, 0x15, 0xFB50}}) {
    EXPECT_THAT(sv660cRead(scene, row.name).message, HasSubstr(row.read)) << row.name;
    const bus::Answer written = sv660cWrite(scene, row.name, row.value);
    EXPECT_TRUE(written.success) << written.message;
    EXPECT_EQ(sv660cNumber(scene, row.index, row.sub), row.number) << row.name;
  }
  EXPECT_THAT(sv660cRead(scene, "H06.03").message, HasSubstr("is -5 ("));
  EXPECT_EQ(sv660cRead(scene, "H12.20").number, -1200.0);
  const bus::Answer fine = sv660cWrite(scene, "H12.21", "1.25");
  EXPECT_FALSE(fine.success);
  EXPECT_THAT(fine.message, HasSubstr("more than the 1 digits behind the point"));
  EXPECT_EQ(sv660cNumber(scene, 0x2012, 0x16), 70U);
}

// What is beyond the range [L6679], read-only [L2558] or for a motor at rest only [L9829, L1995].
TEST(Sv660cParameterName, ThatTheDriveDoesNotTakeIsRefusedInWords) {
  Sv660cReady scene;
  for (const auto& [name, value, told] :
       {std::tuple("H08.15", "120.01", "0x06090031"), std::tuple("H01.00", "1", "read-only"),
        std::tuple("H11.00", "2", "0x08000022"),
        std::tuple("H00.10", "0.80", "the axis is not disabled")}) {
    const bus::Answer refused = sv660cWrite(scene, name, value);
    EXPECT_FALSE(refused.success) << name;
    EXPECT_THAT(refused.message, HasSubstr(told)) << name;
  }
  EXPECT_EQ(sv660cNumber(scene, 0x2000, 0x0B), 75U);
}

// "Re-power" of chapter 3, also of those that have no name here.
TEST(Sv660cParameterName, ThatCountsOnceThePowerWasOffSaysSo) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(500ms);
  const std::string later = "it counts once the drive was switched off and on";
  for (const char* name : {"H00.00", "H00.37", "H01.67", "H03.00", "H05.23", "H0C.10"}) {
    const bus::ObjectAnswer read = sv660cRead(scene, name);
    const auto number = std::to_string(static_cast<long>(read.number));
    EXPECT_THAT(sv660cWrite(scene, name, number).message, HasSubstr(later)) << name;
    scene.run(500ms);
  }
  for (const char* name : {"H08.00", "H12.21", "H06.03"}) {
    const bus::ObjectAnswer read = sv660cRead(scene, name);
    const auto number = std::to_string(static_cast<long>(read.number));
    const bus::Answer written = sv660cWrite(scene, name, number);
    EXPECT_TRUE(written.success) << written.message;
    EXPECT_THAT(written.message, testing::Not(HasSubstr(later))) << name;
  }
}

TEST(Sv660cParameterName, ThatIsNoneIsRefusedInWords) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (const char* name : {"H32.00", "H0G.00", "H02", "H02.255", "P02.00"}) {
    const bus::ObjectAnswer read = sv660cRead(scene, name);
    EXPECT_FALSE(read.success) << name;
    EXPECT_THAT(read.message, HasSubstr("nor a parameter such as H02.00")) << name;
  }
}

}  // namespace
}  // namespace cia402
