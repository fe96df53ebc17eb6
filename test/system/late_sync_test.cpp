// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that minds late SYNCs and RPDOs, and a driver that is late: it is the driver's fault, and
// no reason to stop an axis that goes on.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class LateSync : public testing::Test {
 protected:
  LateSync() : scene(loadText(damiaoJoint() + "groups: {one: {joints: [joint]}}\n")) {}
  void begin() {
    scene.world().bus().setMonitor([this](const can::Frame& frame, Time now) {
      if (frame.id == 0x080) last_sync = now;
    });
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    scene.run(100ms);
    scene.watch([this] {
      left += scene.truth("joint").power_stage_on ? 0U : 1U;
      blamed += scene.axis("joint").faultText().empty() ? 0U : 1U;
    });
  }
  /// The next SYNC leaves so late.
  void delaySync(Duration late) {
    const Time seen = last_sync;
    while (last_sync == seen) scene.robot().run(100us);
    scene.robot().freeze(last_sync + 4ms + late - scene.now());
  }
  unsigned reported(std::uint16_t code) {
    unsigned count = 0;
    for (const bus::EmergencyEvent& event : scene.robot().emergencies()) {
      count += event.emergency.code == code ? 1U : 0U;
    }
    return count;
  }

  Scene scene;
  Time last_sync{};
  unsigned left = 0, blamed = 0;  // ms without power, ms in which the axis had a problem
};

TEST_F(LateSync, OfTheDriverIsToldAsItsOwnFaultAndTheAxisGoesOn) {
  begin();
  const double from = scene.position("joint");
  bus::TrajectoryCommand trajectory;
  trajectory.group = "one";
  trajectory.joints = {"joint"};
  trajectory.points = {{{from + 0.5}, {0.0}, {}, 2s}};
  (void)ask(scene, trajectory);
  for (int i = 0; i < 5; ++i) {
    scene.run(200ms);
    delaySync(5ms);
  }
  scene.run(2s);
  EXPECT_EQ(reported(0x8201), 5U);
  EXPECT_THAT(scene.told(),
              HasSubstr("joint (node 4): emergency: 0x8201 SYNC time-out: the cause is that this "
                        "program sent SYNC 5"));
  EXPECT_THAT(scene.told(), Not(HasSubstr("then recover the axis")));
  EXPECT_EQ(left, 0U) << scene.told();
  EXPECT_EQ(blamed, 0U) << scene.told();
  EXPECT_TRUE(scene.state("joint").ready_for_motion);
  EXPECT_NEAR(scene.position("joint"), from + 0.5, 2e-3);
}

TEST_F(LateSync, AndLateRpdosOfTheDriverDoNotMakeItStopTheAxis) {
  begin();
  delaySync(130ms);
  scene.run(1s);
  EXPECT_GE(reported(0x8250), 1U) << "else the drive did not mind";
  EXPECT_EQ(left, 0U) << scene.told();
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
  const double from = scene.position("joint");
  EXPECT_TRUE(scene.move({from - 0.3}, 2s).success);
  scene.run(2500ms);
  EXPECT_NEAR(scene.position("joint"), from - 0.3, 2e-3);
}

TEST_F(LateSync, ThatGotLostOnTheBusIsNotTheDriversFault) {
  begin();
  sim::FaultRule rule;
  rule.id = 0x080;
  scene.world().bus().faults().add(rule);
  scene.run(200ms);
  EXPECT_EQ(reported(0x8201), 1U);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("emergency: 0x8201 SYNC time-out: no SYNC for 1.5"),
                                  Not(HasSubstr("this program"))));
}

TEST_F(LateSync, ThatReallyStopsTheDriveIsToldAsTheCauseOfThat) {
  begin();
  delaySync(5ms);
  scene.inject("joint", "0x8201");
  scene.run(500ms);
  EXPECT_FALSE(scene.state("joint").ready_for_motion);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("the drive left operation enabled by itself"),
                                  HasSubstr("fault 0x8201 SYNC time-out"),
                                  HasSubstr("the cause is that this program sent SYNC 5")));
}

}  // namespace
}  // namespace cia402
