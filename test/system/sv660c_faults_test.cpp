// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Faults and warnings of the SV660C in words, and how they end.
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;

struct MovingSv660c : Scene {
  MovingSv660c() : Scene(loadText(sv660cJoint())) {
    EXPECT_TRUE(boot()) << told();
    const auto enabled = procedure(ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message;
    EXPECT_EQ(setpoint("joint", 2.0), "");
    run(600ms);
    EXPECT_GT(velocity("joint"), 0.3);
  }
};

struct Sv660cFaultText {
  const char* name;  // of the simulated drive
  const char* code;  // 603Fh
  const char* text;  // what people read
  bool resettable;
};

class Sv660cFault : public testing::TestWithParam<Sv660cFaultText> {};

TEST_P(Sv660cFault, IsToldInWordsAndResetWhereItCanBe) {
  const Sv660cFaultText& fault = GetParam();
  MovingSv660c scene;
  scene.inject("joint", fault.name);
  scene.run(2s);
  EXPECT_EQ(scene.state("joint").state, State::fault);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  EXPECT_THAT(
      scene.axis("joint").faultText(),
      AllOf(HasSubstr("joint (node 1): fault " + std::string(fault.code)), HasSubstr(fault.text)));
  scene.inject("joint", "clear");
  scene.forget();
  const auto recovered = scene.procedure(ProcedureKind::recover, "joint");
  EXPECT_EQ(recovered.success, fault.resettable) << recovered.message;
  scene.run(500ms);
  EXPECT_EQ(scene.truth("joint").power_stage_on, fault.resettable);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(
    Any, Sv660cFault,
    testing::Values(
        Sv660cFaultText{"overcurrent", "0x2310", "check load, motor cable and winding", true},
        Sv660cFaultText{"overvoltage", "0x3210", "check brake resistor", true},
        Sv660cFaultText{"undervoltage", "0x3220", "check supply and fuses", true},
        Sv660cFaultText{"phase_loss", "0x3130", "E420", true},
        Sv660cFaultText{"overspeed", "0x7310", "E500", true},
        Sv660cFaultText{"motor_overload", "0x3230", "E620", true},
        Sv660cFaultText{"locked_rotor", "0x7121", "E630", true},
        Sv660cFaultText{"overtemperature", "0x4310", "check the fan", true},
        Sv660cFaultText{"brake_chopper", "0x7112", "larger resistor", true},
        Sv660cFaultText{"encoder", "0x7305", "check the encoder cable", true},
        Sv660cFaultText{"following_error", "0x8611", "EB00", true},
        Sv660cFaultText{"sync_error", "0x8700", "SYNC", true},
        Sv660cFaultText{"runaway", "0xFF00", "234 runaway", true},
        Sv660cFaultText{"position_command", "0xFF00", "B01 position commands", true},
        Sv660cFaultText{"product_mismatch", "0xFF00", "120 drive and motor do not fit", false},
        Sv660cFaultText{"parameter", "0x5530", "restore the factory settings", false}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Sv660cFaults, ABlockedRotorIsAFollowingError) {
  MovingSv660c scene;
  scene.inject("joint", "blocked_rotor");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").state == State::fault; }, 2s))
      << scene.told();
  EXPECT_THAT(scene.axis("joint").faultText(),
              AllOf(HasSubstr("0x8611"), HasSubstr("following_error_window")));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
}

// E909: class 3, the drive runs on [L3556-3574]; bit 7 of the controlword takes it back [L560].
TEST(Sv660cWarnings, AreToldAndStopNothing) {
  MovingSv660c scene;
  scene.inject("joint", "overload_warning");
  scene.run(3s);
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
  EXPECT_TRUE(scene.state("joint").warning);
  EXPECT_NEAR(scene.position("joint"), 2.0, 1e-4);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("0x3230"), HasSubstr("E909")));
  scene.inject("joint", "clear");
  scene.run(100ms);
  EXPECT_FALSE(scene.state("joint").warning);
}

// Bit 7 takes warnings back, too [L560]; nothing stops by that.
TEST(Sv660cWarnings, AreTakenBackWhileItRuns) {
  MovingSv660c scene;
  scene.inject("joint", "overload_warning");
  scene.run(100ms);
  ASSERT_TRUE(scene.state("joint").warning);
  const auto cleared = scene.procedure(ProcedureKind::clear_faults, "joint");
  EXPECT_TRUE(cleared.success) << cleared.message;
  EXPECT_THAT(cleared.message, AllOf(HasSubstr("the warning is taken back"), HasSubstr("E909")));
  EXPECT_GT(scene.velocity("joint"), 0.3) << "it has not stopped";
  EXPECT_FALSE(scene.truth("joint").statusword & 0x0080);
  scene.run(3s);
  EXPECT_FALSE(scene.state("joint").warning);
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
  EXPECT_NEAR(scene.position("joint"), 2.0, 1e-4);
}

// Its cause stays: the drive warns again.
TEST(Sv660cWarnings, WhoseCauseStaysAreToldToStay) {
  Scene scene(loadText(
      sv660cJoint({}, "with: {faults: {hot: {code: 0x4310, warning: true, persists_for: 60}}}")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.inject("joint", "hot");
  scene.run(100ms);
  const auto cleared = scene.procedure(ProcedureKind::clear_faults, "joint");
  EXPECT_FALSE(cleared.success);
  EXPECT_THAT(cleared.message, AllOf(HasSubstr("the warning stays"), HasSubstr("0x4310")));
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
}

}  // namespace
}  // namespace cia402
