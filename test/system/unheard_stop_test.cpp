// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Stops of whose end nothing is heard: none is answered with success while the motor turns.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

/// Calls of stops, and what the motor did when each was answered.
class StopCalls {
 public:
  explicit StopCalls(Scene& scene) : scene_(scene) {}
  void call(ProcedureKind kind, const std::string& axis) {
    drive::ProcedureRequest request;
    request.kind = kind;
    const auto reply = [this, kind, axis](const bus::Answer& answer) {
      --waiting_;
      const double speed = std::abs(scene_.velocity(axis));
      if (!answer.success || speed < 0.02) return;
      wrong_ += std::string(toString(kind)) + " done at " + std::to_string(speed) +
                " rad/s: " + answer.message + "\n";
    };
    ++waiting_;
    scene_.robot().network().execute(bus::Command(bus::ProcedureCommand{axis, request}, reply),
                                     scene_.now());
  }
  /// What was told that is not true of the motor, once all calls are answered.
  std::string wrong() {
    const bool answered = scene_.runUntil([&] { return waiting_ == 0; }, 15s);
    return answered ? wrong_ : "no answer";
  }

 private:
  Scene& scene_;
  int waiting_ = 0;
  std::string wrong_;
};

struct CutMotion {
  const char* name;
  std::string yaml;
  const char* mode;
  double set_point;
  friend std::ostream& operator<<(std::ostream& out, const CutMotion& motion) {
    return out << motion.name;
  }
};

class OnACutBus : public testing::TestWithParam<CutMotion> {};

TEST_P(OnACutBus, AHaltAfterAQuickStopIsNotCalledDoneInMotion) {
  for (const Duration cut : {0ms, 1ms, 3ms, 8ms, 40ms}) {
    for (const Duration halt : {0ms, 2ms, 30ms, 60ms, 200ms}) {
      ReadyScene scene(GetParam().yaml, GetParam().mode);
      const std::string axis = scene.loaded().robot.axes[0].name;
      scene.stream(axis, GetParam().set_point, 400ms);
      ASSERT_GT(std::abs(scene.velocity(axis)), 0.5);
      StopCalls calls(scene);
      calls.call(ProcedureKind::quick_stop, axis);
      scene.run(cut);
      scene.robot().port().setAttached(false);  // the driver's end of the cable
      scene.run(halt);
      calls.call(ProcedureKind::halt, axis);
      EXPECT_EQ(calls.wrong(), "") << toSeconds(cut) << " s, " << toSeconds(halt) << " s";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    In, OnACutBus,
    testing::Values(CutMotion{"generic_csp", genericPair(), "cyclic_position", 2.0},
                    CutMotion{"generic_csv", genericPair(), "cyclic_velocity", 1.5},
                    CutMotion{"generic_pp", genericPair(), "profile_position", 2.0},
                    CutMotion{"damiao_csp", damiaoJoint(), "cyclic_position", -1.9},
                    CutMotion{"damiao_csv", damiaoJoint(), "cyclic_velocity", -1.5},
                    CutMotion{"damiao_pp", damiaoJoint(), "profile_position", -1.9}),
    [](const auto& tested) { return tested.param.name; });

/// Position and velocity come by a TPDO of their own, which can fail to come alone.
class WithoutPower : public testing::TestWithParam<ProcedureKind> {
 protected:
  struct Apart : ReadyScene {
    Apart()
        : ReadyScene(genericPair(", modes: [csp, csv], "
                                 "pdos: {rpdo1: [controlword, mode_of_operation, target_position], "
                                 "rpdo2: [target_velocity], tpdo1: [statusword, mode_display], "
                                 "tpdo2: [position_actual, velocity_actual]}"),
                     "cyclic_velocity") {}
    void loseItsPosition() {
      sim::FaultRule rule;
      rule.id = 0x281;
      rule.count = 1000000;
      world().bus().faults().add(rule);
    }
  };
};

TEST_P(WithoutPower, AnAxisThatCoastsUnheardIsNotSaidToStand) {
  for (const Duration lost : {0ms, 10ms}) {
    for (const Duration stop : {0ms, 10ms, 38ms, 44ms, 60ms}) {  // stale: after 40 ms
      Apart scene;
      scene.stream("left", 1.2, 1s);
      ASSERT_NEAR(scene.velocity("left"), 1.2, 0.02);
      scene.inject("left", "overcurrent");
      scene.run(lost);
      scene.loseItsPosition();
      scene.run(stop);
      StopCalls calls(scene);
      calls.call(GetParam(), "left");
      EXPECT_EQ(calls.wrong(), "") << toSeconds(lost) << " s, " << toSeconds(stop) << " s";
    }
  }
}

TEST_P(WithoutPower, AnAxisThatIsHeardNoMoreIsSaidToBeUnknownWhereItMayCoast) {
  Apart scene;
  scene.stream("left", 1.2, 1s);
  scene.inject("left", "overcurrent");
  scene.loseItsPosition();
  scene.run(60ms);
  const bus::Answer answer = scene.procedure(GetParam(), "left");
  EXPECT_FALSE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("nothing tells whether it stands: TPDO 2 (COB-ID 0x281)"));
}

TEST_P(WithoutPower, AnAxisThatStoodWhenItWasHeardLastStands) {
  Apart scene;
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable, "left").success);
  scene.run(500ms);
  scene.loseItsPosition();
  scene.run(100ms);
  ASSERT_FALSE(scene.state("left").feedback_valid);
  const bus::Answer answer = scene.procedure(GetParam(), "left");
  EXPECT_TRUE(answer.success) << answer.message;
}

INSTANTIATE_TEST_SUITE_P(Stop, WithoutPower,
                         testing::Values(ProcedureKind::disable, ProcedureKind::halt,
                                         ProcedureKind::quick_stop),
                         [](const auto& stop) { return std::string(toString(stop.param)); });

}  // namespace
}  // namespace cia402
