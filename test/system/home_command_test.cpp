// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Homing of several axes at once: what its motors do, also where it is cancelled.
#include "bus/jobs/home_command.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kSwitches[] =
    ", simulation: {initial_position: 0.0, lower_limit_switch: -2.0, upper_limit_switch: 2.0}";

std::string toSwitch(int method, int order, const std::string& more = {}) {
  return ", homing: {method: " + std::to_string(method) + ", order: " + std::to_string(order) +
         ", search_velocity: 0.8, zero_velocity: 0.1, acceleration: 4.0, offset: 0.5" + more + "}" +
         kSwitches;
}

/// Left searches downwards, then right upwards.
std::string oneByOne() { return genericPair(toSwitch(17, 0), toSwitch(18, 1)); }

struct HomingScene : Scene {
  explicit HomingScene(const std::string& yaml) : Scene(loadText(yaml)) {
    EXPECT_TRUE(boot()) << told();
  }
  std::shared_ptr<std::optional<bus::ProcedureReport>> home(
      const std::vector<std::string>& names = {}, const std::vector<int>& order = {}) {
    bus::HomeCommand command;
    command.plan = bus::homingPlan(loaded().robot, names, order).value();
    command.id = 1;
    return ask(command);
  }
  void cancel() { ASSERT_TRUE(call(bus::CancelHomeCommand{1}).success); }
  void expectStandsStill(const std::string& name) {
    forget();
    run(1s);
    EXPECT_LT(seen(name).travel(), 1e-3) << name;
    EXPECT_LT(seen(name).fastest, 0.01) << name;
  }
};

TEST(HomeCommand, MovesOneOrderAfterTheOther) {
  HomingScene scene(oneByOne());
  double together = 0.0;
  scene.watch([&] {
    together = std::max(
        together, std::min(std::abs(scene.velocity("left")), std::abs(scene.velocity("right"))));
  });
  const auto answer = scene.home();
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 30s));
  EXPECT_TRUE((*answer)->success) << (*answer)->message;
  EXPECT_LT(together, 0.01);
  EXPECT_NEAR(scene.position("left") + 2.0, scene.state("left").position - 0.5, 2e-3);
  EXPECT_NEAR(scene.position("right") - 2.0, scene.state("right").position - 0.5, 2e-3);
}

TEST(HomeCommand, MovesAxesOfOneOrderTogether) {
  HomingScene scene(oneByOne());
  const auto answer = scene.home({"pair"}, {3});
  ASSERT_TRUE(scene.runUntil(
      [&] { return scene.velocity("left") < -0.7 && scene.velocity("right") > 0.7; }, 5s));
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 30s));
  EXPECT_TRUE((*answer)->success) << (*answer)->message;
}

TEST(HomeCommand, CancelledInTheMiddleItsMotorsStandAndTheNextOnesNeverMove) {
  HomingScene scene(oneByOne());
  const auto answer = scene.home();
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("left") < -0.7; }, 5s));
  const double at = scene.position("left");
  scene.cancel();
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 3s));
  EXPECT_NEAR(scene.velocity("left"), 0.0, 0.01) << "it is answered at rest";
  EXPECT_GT(scene.position("left"), at - 0.2) << "0.8 rad/s at 4 rad/s² take 0.08 rad";
  EXPECT_TRUE((*answer)->stopped);
  EXPECT_FALSE((*answer)->success);
  EXPECT_THAT((*answer)->message,
              AllOf(HasSubstr("left (node 1): homing stopped: it was cancelled"),
                    HasSubstr("right: not started")));
  EXPECT_LT(scene.seen("right").travel(), 1e-3);
  scene.expectStandsStill("left");
  EXPECT_FALSE(scene.truth("right").power_stage_on);
  EXPECT_TRUE(scene.truth("left").power_stage_on) << "it is held";
  EXPECT_THAT(scene.setpoint("left", 0.0), HasSubstr("left (node 1): not homed; home it"));
}

TEST(HomeCommand, CancelledAtAnyMomentTheMotorStandsInTheModeFromBeforeAndHomesAgain) {
  for (const bool enabled : {false, true}) {
    for (Duration moment = 0ms; moment < 400ms; moment += 7ms) {
      const std::string when = std::to_string(toSeconds(moment)) + (enabled ? " s, enabled" : " s");
      HomingScene scene(oneByOne());
      if (enabled) {
        ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success);
      }
      const auto answer = scene.home({"left"});
      scene.run(moment);
      ASSERT_FALSE(answer->has_value()) << when;
      scene.cancel();
      ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 3s)) << when;
      EXPECT_TRUE((*answer)->stopped) << when << ": " << (*answer)->message;
      scene.run(200ms);  // a power stage that was being switched on goes off
      scene.expectStandsStill("left");
      EXPECT_TRUE(!enabled || scene.truth("left").power_stage_on) << when;
      const std::string obstacle = scene.axis("left").obstacle();
      EXPECT_EQ(obstacle, scene.truth("left").power_stage_on
                              ? "left is not homed: home"
                              : "left is not enabled (switch on disabled): enable")
          << when;
      const auto again = scene.home({"left"});
      ASSERT_TRUE(scene.runUntil([&] { return again->has_value(); }, 30s)) << when;
      EXPECT_TRUE((*again)->success) << when << ": " << (*again)->message;
    }
  }
}

/// Velocity of the left motor when it is answered, rad/s.
/// @param act is done while it searches
double velocityAtTheAnswer(HomingScene& scene, const std::function<void()>& act) {
  const auto answer = scene.home();
  EXPECT_TRUE(scene.runUntil([&] { return scene.velocity("left") < -0.7; }, 5s));
  std::optional<double> velocity;
  scene.watch([&] {
    if (answer->has_value() && !velocity) velocity = scene.velocity("left");
  });
  act();
  EXPECT_TRUE(scene.runUntil([&] { return velocity.has_value(); }, 8s));
  EXPECT_TRUE((*answer)->stopped) << (*answer)->message;
  EXPECT_LT(scene.seen("right").travel(), 1e-3);
  return velocity.value_or(1e9);
}

TEST(HomeCommand, StoppedByAnotherCallItIsAnsweredAtRest) {
  for (const ProcedureKind by :
       {ProcedureKind::halt, ProcedureKind::quick_stop, ProcedureKind::disable}) {
    HomingScene scene(oneByOne());
    EXPECT_NEAR(velocityAtTheAnswer(scene, [&] { scene.begin(by, "left"); }), 0.0, 0.01)
        << toString(by);
  }
}

TEST(HomeCommand, CancelledItIsAnsweredAtRestThoughAFaultBrakesIt) {
  HomingScene scene(oneByOne());
  const auto cancelThenFault = [&] {
    scene.cancel();
    scene.run(20ms);
    EXPECT_LT(scene.velocity("left"), -0.4);
    scene.inject("left", "0x7305");
  };
  EXPECT_NEAR(velocityAtTheAnswer(scene, cancelThenFault), 0.0, 0.01);
}

TEST(HomeCommand, OneThatNeverFindsItsSwitchStopsByItselfAndKeepsLaterOrdersFromMoving) {
  HomingScene scene(
      genericPair(", homing: {method: 17, search_velocity: 0.8, acceleration: 4.0, timeout: 2.0}",
                  toSwitch(18, 1)));
  const auto answer = scene.home();
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 30s));
  EXPECT_FALSE((*answer)->success || (*answer)->stopped);
  EXPECT_THAT((*answer)->message, AllOf(HasSubstr("homing timed out after 2 s"),
                                        HasSubstr("right: not started, for another axis failed")));
  scene.run(1s);
  scene.expectStandsStill("left");
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_LT(scene.seen("right").travel(), 1e-3);
}

TEST(HomeCommand, AFaultOfOneLetsTheOtherOfItsOrderFindHome) {
  HomingScene scene(genericPair(toSwitch(17, 0), toSwitch(18, 0)));
  const auto answer = scene.home();
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("right") > 0.7; }, 5s));
  scene.inject("left", "0x7305");
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 30s));
  EXPECT_FALSE((*answer)->success || (*answer)->stopped);
  EXPECT_THAT((*answer)->message, HasSubstr("home done on 1 of 2 axes"));
  EXPECT_TRUE(scene.state("right").homed);
  EXPECT_FALSE(scene.state("left").homed);
  scene.expectStandsStill("left");
}

TEST(HomeCommand, TheZeroIsLostWithThePowerOfTheDriveAndMotionRefusedUntilItHomesAgain) {
  HomingScene scene(oneByOne());
  const auto answer = scene.home({"left"});
  ASSERT_TRUE(scene.runUntil([&] { return answer->has_value(); }, 30s));
  ASSERT_EQ(scene.setpoint("left", 0.5), "");
  scene.run(500ms);
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(
      scene.runUntil([&] { return scene.state("left").health != fieldbus::Health::ready; }, 2s));
  ASSERT_TRUE(
      scene.runUntil([&] { return scene.state("left").health == fieldbus::Health::ready; }, 10s));
  scene.run(200ms);
  EXPECT_FALSE(scene.state("left").homed);
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "right").success);
  scene.run(200ms);
  scene.forget();
  const std::string words = "left (node 1): not homed; home it before position motion";
  EXPECT_EQ(scene.setpoint("left", 0.6), words);
  EXPECT_THAT(scene.move({0.6, 0.5}, 3s).message, HasSubstr(words));
  scene.run(1s);
  expectNothingMoved(scene, "left");
  expectNothingMoved(scene, "right");
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "left").success);
  EXPECT_EQ(scene.setpoint("left", 0.6), "");
}

}  // namespace
}  // namespace cia402
