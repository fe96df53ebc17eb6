// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What keeps an SV660C from being switched on, and its inputs in words.
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Sv660cObstacle {
  const char* name;    // of the simulated drive
  const char* told;    // by the statusword, or by the time that has passed
  const char* reason;  // H0b.63 [L8949-8967]
};

class Sv660cNotReady : public testing::TestWithParam<Sv660cObstacle> {};

TEST_P(Sv660cNotReady, IsToldWithItsReasonAndNothingIsEnabled) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.inject("joint", GetParam().name);
  scene.run(100ms);
  scene.forget();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message,
              AllOf(HasSubstr("joint (node 1)"), HasSubstr(GetParam().told),
                    HasSubstr("not_ready_reason (200B:40) is " + std::string(GetParam().reason))));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(scene.seen("joint").travel(), 0.0);
  scene.inject("joint", "clear");
  scene.run(100ms);
  const bus::Answer again = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(again.success) << again.message;
}

INSTANTIATE_TEST_SUITE_P(
    While, Sv660cNotReady,
    testing::Values(
        Sv660cObstacle{"main_power_lost",
                       "is not enabled: statusword (6041:00) is 0x0240, of which 0x0010 is 0x0000, "
                       "the main supply is missing",
                       "2: main supply input"},
        Sv660cObstacle{"sto", "a safety input (STO) is open", "7: another reason"},
        Sv660cObstacle{"not_remote",
                       "statusword (6041:00) is 0x0050, of which 0x0200 is 0x0000, the drive does "
                       "not listen to its controlword",
                       "7: another reason"},
        Sv660cObstacle{"soft_start", "enabling timed out: the drive has been in switch on disabled",
                       "4: soft start failed"},
        Sv660cObstacle{"encoder_not_ready", "enabling timed out",
                       "5: the encoder is not initialised yet"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Sv660cReadiness, SaysNothingOfAReasonThatThereIsNot) {
  Scene scene(
      loadText(sv660cJoint({}, sv660cDelivered("[0x2002, 1, control_mode, uint16, rw, -, 1]"))));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, Not(HasSubstr("not_ready_reason")));
}

// The motor coasts: by the safety function, or for want of power.
TEST(Sv660cReadiness, ThatGoesInMotionIsTold) {
  for (const char* obstacle : {"sto", "main_power_lost"}) {
    Sv660cReady scene;
    ASSERT_EQ(scene.setpoint("joint", 2.0), "");
    scene.run(700ms);
    ASSERT_GT(scene.velocity("joint"), 0.5);
    scene.inject("joint", obstacle);
    scene.run(2s);
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
    EXPECT_THAT(scene.told(), HasSubstr("the drive left operation enabled by itself"));
    scene.inject("joint", "clear");
    scene.run(1s);
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << "until somebody says so";
    const bus::Answer recovered = scene.procedure(ProcedureKind::recover, "joint");
    EXPECT_TRUE(recovered.success) << recovered.message;
  }
}

// Bits 27 to 29 of 60FDh [L16153-16194].
TEST(Sv660cInputs, TellTheSafetyFunction) {
  Scene scene(loadText(sv660cJoint()));
  ASSERT_TRUE(scene.boot()) << scene.told();
  EXPECT_THAT(sv660cRead(scene, "digital_inputs").message, Not(HasSubstr("sto")));
  scene.inject("joint", "sto");
  scene.run(100ms);
  EXPECT_THAT(sv660cRead(scene, "digital_inputs").message,
              HasSubstr("(0x38000000): edm, sto1, sto2"));
}

// Bits 16 to 23 are DI1 to DI8, 30 is the index pulse [L16153-16194].
TEST(Sv660cInputs, AreEachToldByItsName) {
  Scene scene(loadText(sv660cJoint({}, "initial_position: 0.0")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const std::pair<unsigned, const char*> named[] = {
      {16, "di1"}, {17, "di2"}, {18, "di3"},  {19, "di4"},  {20, "di5"}, {21, "di6"},
      {22, "di7"}, {23, "di8"}, {27, "sto1"}, {28, "sto2"}, {29, "edm"}, {30, "index pulse"}};
  for (const auto& [bit, name] : named) {
    scene.drive("joint").setInput(bit, true, scene.now());
    const bus::ObjectAnswer read = sv660cRead(scene, "digital_inputs");
    EXPECT_TRUE(read.success) << read.message;
    EXPECT_EQ(read.number, static_cast<double>(1U << bit)) << name;
    EXPECT_THAT(read.message, testing::EndsWith("): " + std::string(name)));
    scene.drive("joint").setInput(bit, false, scene.now());
  }
}

}  // namespace
}  // namespace cia402
