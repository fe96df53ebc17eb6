// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// set_mode of axes that move: refused, or they are stopped for it (set_mode_in_motion). What is
// said of a motion is read from the simulated motor.
#include "system/field_profile.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr char kStops[] = ", modes: [pp, vl, pv, ip, csp, csv, cst], set_mode_in_motion: stop";

/// The motor of `left` from now on: once it gets slower it gets slower only, does not turn back,
/// and brakes no harder than it may.
class Braking {
 public:
  explicit Braking(Scene& scene) : scene_(scene), slowest_(scene.velocity("left")) {
    begin_ = slowest_;
    speeds_.assign(kOver + 1, slowest_);
    scene.watch([this] { look(); });
  }
  ~Braking() { scene_.watch(nullptr); }
  Braking(const Braking&) = delete;
  Braking& operator=(const Braking&) = delete;

  double risen = 0.0;    ///< above the slowest before
  double turned = 0.0;   ///< speed the other way
  double hardest = 0.0;  ///< rad/s^2, over 20 ms
  double begin() const { return begin_; }

 private:
  static constexpr std::size_t kOver = 20;  // ms

  void look() {
    const double speed = scene_.velocity("left");
    risen = std::max(risen, speed - slowest_);
    turned = std::max(turned, -speed);
    slowest_ = std::min(slowest_, speed);
    speeds_.push_back(speed);
    hardest = std::max(hardest, (speeds_[speeds_.size() - 1 - kOver] - speed) / 0.020);
  }

  Scene& scene_;
  double slowest_, begin_ = 0.0;
  std::vector<double> speeds_;
};

struct Change {
  const char* from;
  double value;  // streamed before
  const char* to;
};

class SetModeInMotion : public testing::TestWithParam<Change> {};

// 4 rad/s^2 in all modes; a motor follows its targets with a lag.
TEST_P(SetModeInMotion, StopsTheMotorSmoothlyThenHoldsItInTheNewMode) {
  const Change& change = GetParam();
  ReadyScene scene(genericPair(kStops, kStops), change.from);
  scene.stream("left", change.value, 600ms);
  ASSERT_GT(scene.velocity("left"), 0.3);
  Braking braking(scene);
  const bus::Answer answer = scene.procedure(ProcedureKind::set_mode, "left", change.to);
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("it was stopped for that"));
  scene.run(200ms);
  EXPECT_LT(braking.risen, 0.02) << "from " << braking.begin() << " rad/s";
  EXPECT_LT(braking.turned, 0.02);
  EXPECT_LT(braking.hardest, 4.0 * 1.25);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3);
  EXPECT_EQ(scene.state("left").mode->name, drive::canonicalModeName(change.to));
  EXPECT_TRUE(scene.state("left").ready_for_motion) << scene.axis("left").motionRefusal();
  scene.forget();
  scene.run(1s);
  EXPECT_LT(scene.seen("left").travel(), 1e-3) << "it holds";
  EXPECT_EQ(scene.state("right").mode->name, drive::canonicalModeName(change.from));
}

INSTANTIATE_TEST_SUITE_P(Modes, SetModeInMotion,
                         testing::Values(Change{"csp", 2.4, "csv"}, Change{"csv", 1.2, "csp"},
                                         Change{"csv", 1.2, "pv"}, Change{"pp", 2.4, "csv"},
                                         Change{"pv", 1.2, "csp"}, Change{"vl", 1.2, "pp"},
                                         Change{"ip", 2.4, "pv"}, Change{"csv", 1.2, "csv"}),
                         [](const auto& tested) {
                           return std::string(tested.param.from) + "_to_" + tested.param.to;
                         });

TEST(SetModeOfAMovingAxis, IsRefusedUnlessItIsToStopAndTellsTheKey) {
  ReadyScene scene(genericPair(", modes: [csv]"), "csp");
  scene.stream("left", 2.4, 600ms);
  const double speed = scene.velocity("left");
  const bus::Answer answer = scene.procedure(ProcedureKind::set_mode, "left", "csv");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("refused in motion"), HasSubstr("set_mode_in_motion: stop")));
  scene.run(100ms);
  EXPECT_NEAR(scene.velocity("left"), speed, 0.05) << "it goes on";
}

TEST(SetModeOfAMovingAxis, GoesByDisablingWhereTheDriveDemandsIt) {
  ReadyScene scene(fieldPair("mode_change: {when: disabled}", "", kStops), "csv");
  scene.stream("left", 1.2, 600ms);
  Braking braking(scene);
  const bus::Answer answer = scene.procedure(ProcedureKind::set_mode, "left", "csp");
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_LT(braking.risen, 0.02);
  EXPECT_LT(braking.hardest, 4.0 * 1.25);
  EXPECT_TRUE(scene.state("left").ready_for_motion) << scene.axis("left").motionRefusal();
}

TEST(SetModeOfAMovingAxis, EndsTheHaltBeforeWhereThatIsInTheWayOfTheMode) {
  ReadyScene scene(
      fieldPair("mode_change: {while_halted: false}", "quirks: {halt_blocks_mode: true}", kStops),
      "pv");
  scene.stream("left", 1.2, 600ms);
  Braking braking(scene);
  const bus::Answer answer = scene.procedure(ProcedureKind::set_mode, "left", "csp");
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_LT(braking.risen, 0.02);
  EXPECT_TRUE(scene.state("left").ready_for_motion) << scene.axis("left").motionRefusal();
}

TEST(SetModeOfAMovingAxis, OfEffortsIsBrakedByWhatTheirModeHas) {
  ReadyScene scene(genericPair(kStops, kStops), "cst");
  scene.stream("left", 20.0, 200ms);
  ASSERT_GT(scene.velocity("left"), 0.05);
  Braking braking(scene);
  const bus::Answer answer = scene.procedure(ProcedureKind::set_mode, "left", "csp");
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_TRUE(scene.state("left").ready_for_motion) << scene.axis("left").motionRefusal();
  scene.forget();
  scene.run(1s);
  EXPECT_LT(scene.seen("left").travel(), 1e-3);
}

TEST(SetModeOfAMovingAxis, IsLeftHaltedByAHaltMeanwhile) {
  ReadyScene scene(genericPair(kStops, kStops), "csv");
  scene.stream("left", 1.4, 600ms);
  const auto changed = scene.begin(ProcedureKind::set_mode, "left", "csp");
  scene.run(50ms);
  ASSERT_FALSE(changed->has_value());
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "left").success);
  ASSERT_TRUE(changed->has_value());
  EXPECT_FALSE((*changed)->success);
  EXPECT_TRUE(scene.state("left").halted);
  EXPECT_EQ(scene.state("left").mode->name, "cyclic_velocity");
}

TEST(SetModeOfAMovingAxis, DoesNotReleaseAHaltThatSomebodyAskedFor) {
  ReadyScene scene(genericPair(kStops, kStops), "csv");
  scene.stream("left", 1.4, 600ms);
  const auto halted = scene.begin(ProcedureKind::halt, "left");
  scene.run(50ms);
  ASSERT_FALSE(halted->has_value());
  scene.run(2s);
  ASSERT_TRUE(halted->has_value() && (*halted)->success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "left", "csp").success);
  EXPECT_TRUE(scene.state("left").halted);
}

/// Of the group `pair`, or, without a group, of the bus.
class SetModeOfMovingAxes : public testing::TestWithParam<bool> {
 protected:
  static bus::Answer setMode(Scene& scene, const std::string& mode) {
    bus::ProcedureCommand command;
    command.request.kind = ProcedureKind::set_mode;
    command.request.mode = mode;
    if (GetParam()) command.group = "pair";
    return scene.call(command);
  }
};

TEST_P(SetModeOfMovingAxes, StopsAllOfThem) {
  ReadyScene scene(genericPair(kStops, kStops), "csp");
  ASSERT_TRUE(scene.move({2.0, -1.0}, 3s).success);
  scene.run(1500ms);
  ASSERT_GT(scene.velocity("left"), 0.5);
  Braking braking(scene);
  const bus::Answer answer = setMode(scene, "csv");
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_LT(braking.risen, 0.02);
  EXPECT_LT(braking.hardest, 4.0 * 1.25);
  scene.run(200ms);
  scene.forget();
  scene.run(500ms);
  for (const char* const axis : {"left", "right"}) {
    EXPECT_EQ(scene.state(axis).mode->name, "cyclic_velocity") << axis;
    EXPECT_TRUE(scene.state(axis).ready_for_motion) << axis;
    EXPECT_LT(scene.seen(axis).travel(), 1e-3) << axis;
  }
}

TEST_P(SetModeOfMovingAxes, StopsNoneWhereOneRefuses) {
  ReadyScene scene(genericPair(kStops, ", modes: [csv]"), "csp");
  ASSERT_TRUE(scene.move({2.0, -1.0}, 3s).success);
  scene.run(1500ms);
  const double speed = scene.velocity("left");
  ASSERT_GT(speed, 0.5);
  const bus::Answer answer = setMode(scene, "csv");
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("done on 0 of 2 axes"));
  scene.run(100ms);
  EXPECT_GT(scene.velocity("left"), speed - 0.1);
  scene.run(2500ms);
  EXPECT_NEAR(scene.position("left"), 2.0, 1e-3) << scene.told();
  EXPECT_NEAR(scene.position("right"), -1.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Of, SetModeOfMovingAxes, testing::Bool(), [](const auto& tested) {
  return std::string(tested.param ? "AGroup" : "TheBus");
});

}  // namespace
}  // namespace cia402
