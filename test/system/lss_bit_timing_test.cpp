// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Another bit rate for the drives of whole robots.
#include "system/lss_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::HasSubstr;

TEST(BitTiming, IsSetInDisabledDrivesAndWhatFollowsIsSaid) {
  Scene scene(loadText(genericPair(", simulation: {serial: 111}", ", simulation: {serial: 222}")));
  ASSERT_TRUE(scene.boot());
  bus::LssBitTimingCommand timing;
  timing.kbit_per_s = 250;
  timing.store = true;
  const auto set = call(scene, timing);
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_THAT(set.message, HasSubstr("left (node 1): stored 250 kbit/s; right (node 2): stored 250 "
                                     "kbit/s; nothing has changed on the bus yet"));
  scene.run(1s);
  EXPECT_TRUE(allReady(scene.robot()));
  timing.kbit_per_s = 100;
  EXPECT_THAT(call(scene, timing).message, HasSubstr("no bit timing of 100 kbit/s"));
  timing.kbit_per_s = 250;
  timing.axis = "left";
  timing.activate = true;
  EXPECT_THAT(call(scene, timing).message,
              HasSubstr("all drives must take a new bit rate at once"));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  timing.axis.clear();
  EXPECT_THAT(call(scene, timing).message, HasSubstr("left (node 1) is not disabled"));
}

TEST(BitTiming, ActivationSwitchesAllDrivesAndSaysThatTheBusMustFollow) {
  Scene scene(loadText(genericPair(", simulation: {serial: 111}", ", simulation: {serial: 222}")));
  ASSERT_TRUE(scene.boot());
  bus::LssBitTimingCommand timing;
  timing.kbit_per_s = 500;
  timing.activate = true;
  timing.delay = 100ms;
  const auto set = call(scene, timing);
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_THAT(set.message, HasSubstr("all devices switch in 100 ms"));
  EXPECT_THAT(set.message, HasSubstr("bitrate 500000"));
  scene.run(3s);
  EXPECT_EQ(scene.state("left").health, Health::lost);
  EXPECT_EQ(scene.state("right").health, Health::lost);
}

/// Bit timing for all, to be activated, on drives that are disabled.
class BitTimingActivation : public testing::Test {
 protected:
  BitTimingActivation()
      : scene(loadText(genericPair(", simulation: {serial: 111}", ", simulation: {serial: 222}"))) {
    timing.kbit_per_s = 500;
    timing.activate = true;
    timing.delay = 200ms;
    scene.world().bus().setMonitor([this](const can::Frame& frame, Time) {
      taken += frame.id == 0x7E4 && frame.data[0] == 0x13 ? 1U : 0U;
      // The switch of all devices to the configuration state, and what they shall do there.
      const bool all = frame.data[0] == 0x04 && frame.data[1] == 1;
      activations += frame.id == 0x7E5 && (all || frame.data[0] == 0x15) ? 1U : 0U;
    });
  }
  /// Enables it as no command could.
  void enable(const std::string& name) {
    drive::ProcedureRequest request;
    request.kind = ProcedureKind::enable;
    ASSERT_TRUE(scene.axis(name).start(request, scene.now()));
  }
  void expectNotActivated(const bus::Answer& answer, const std::string& why) {
    EXPECT_FALSE(answer.success);
    EXPECT_THAT(answer.message,
                HasSubstr("left (node 1): set (not stored) 500 kbit/s; right (node 2): set (not "
                          "stored) 500 kbit/s; not activated: " +
                          why));
    EXPECT_THAT(answer.message, HasSubstr("the drives hold the new bit timing and take it with the "
                                          "next `activate`: disable the axis and call it again"));
    EXPECT_EQ(activations, 0u);
    scene.run(2s);
    EXPECT_TRUE(allReady(scene.robot())) << scene.told();
  }
  Scene scene;
  bus::LssBitTimingCommand timing;
  unsigned taken = 0, activations = 0;
};

TEST_F(BitTimingActivation, IsNotSentWhereAnAxisIsEnabledByThen) {
  ASSERT_TRUE(scene.boot());
  const auto answer = ask(scene, timing);
  ask(scene, bus::LssScanCommand{100ms});  // has its turn before the activation
  ASSERT_TRUE(scene.runUntil([&] { return taken == 2; }, 10s));
  enable("right");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("right").ready_for_motion; }, 1s));
  ASSERT_FALSE(answer->has_value());
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 60s));
  expectNotActivated(**answer, "right (node 2) is not disabled");
  // Once it is disabled, the drives can be told after all, or anything else can be done.
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << "nothing hinders it any more";
}

TEST_F(BitTimingActivation, IsNotSentWhereAnAxisIsJustBeingEnabled) {
  ASSERT_TRUE(scene.boot());
  const auto answer = ask(scene, timing);
  ASSERT_TRUE(scene.runUntil([&] { return taken == 2; }, 10s));
  scene.run(15ms);
  ASSERT_FALSE(answer->has_value());
  enable("left");
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 10s));
  expectNotActivated(**answer, "left (node 1) is not disabled for good: enable runs (");
}

TEST_F(BitTimingActivation, ADriveThatIsEnabledWhenItsTurnComesIsNotGivenAnotherBitTiming) {
  ASSERT_TRUE(scene.boot());
  const auto answer = ask(scene, timing);
  scene.run(30ms);
  enable("right");
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 20s));
  EXPECT_FALSE((*answer)->success);
  EXPECT_THAT((*answer)->message, HasSubstr("right (node 2): refused: right (node 2) is not"));
  EXPECT_EQ(taken, 1u);
  EXPECT_EQ(activations, 0u);
}

TEST_F(BitTimingActivation, NoAxisIsEnabledUntilAllDevicesHaveSwitched) {
  ASSERT_TRUE(scene.boot());
  const auto answer = ask(scene, timing);
  for (const ProcedureKind kind :
       {ProcedureKind::enable, ProcedureKind::home, ProcedureKind::recover}) {
    const auto refused = scene.procedure(kind, "left");
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, HasSubstr(std::string(toString(kind)) +
                                           " is refused: lss_set_bit_timing is at work (LSS: "));
  }
  ASSERT_FALSE(answer->has_value());
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 20s));
  EXPECT_TRUE((*answer)->success) << (*answer)->message;
  scene.run(100ms);
  EXPECT_THAT(scene.procedure(ProcedureKind::enable, "left").message,
              HasSubstr("all devices switch to another bit rate at this moment"));
  scene.run(2s);
  EXPECT_THAT(scene.procedure(ProcedureKind::enable, "left").message, HasSubstr("is lost"));
}

TEST_F(BitTimingActivation, AJobThatIsRefusedOrFailsHindersNobody) {
  ASSERT_TRUE(scene.boot());
  timing.kbit_per_s = 100;
  EXPECT_FALSE(call(scene, timing).success);
  timing.kbit_per_s = 500;
  scene.drive("right").device().behaviour().lss_bit_timing = false;
  EXPECT_THAT(call(scene, timing).message, HasSubstr("not all drives took it"));
  EXPECT_EQ(activations, 0u);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success);
}

TEST_F(BitTimingActivation, IsRefusedWhileAnAxisIsBeingEnabled) {
  ASSERT_TRUE(scene.boot());
  const auto enabling = scene.begin(ProcedureKind::enable, "left");
  EXPECT_THAT(call(scene, timing).message,
              HasSubstr("refused: left (node 1) is not disabled for good: enable runs ("));
}

}  // namespace
}  // namespace cia402
