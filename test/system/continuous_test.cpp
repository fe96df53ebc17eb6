// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A joint that turns without end, on a drive whose 32 bits wrap every two turns of it: nothing that
// is told or commanded has a step there.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

/// 2^24 counts * 128 = 2^31 counts a turn: 6064h wraps at +-6.283 rad.
std::string table(double at, const std::string& more = {}) {
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "axes:\n"
         "  table: {node_id: 1, drive: generic_cia402, type: continuous,\n"
         "    counts_per_turn: 16777216, gear_ratio: 128.0, mode: cyclic_position,\n"
         "    write: [{object: following_error_window, value: 0.1}],\n"
         "    limits: {velocity: 1.5, acceleration: 3.0, jerk: 30.0}" +
         more + ", simulation: {initial_position: " + std::to_string(at) +
         "}}\n"
         "groups: {all: {joints: [table]}}\n";
}

class Continuous : public testing::TestWithParam<int> {
 protected:
  void begin(const std::string& more = {}) {
    scene.emplace(loadText(table(GetParam() * 6.0, more)));
    ASSERT_TRUE(scene->boot()) << scene->told();
    ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
    last_ = scene->state("table").position;
    first_ = last_ - scene->position("table");
    overflows = 0;
    counted_ = counts();
    speed_ = scene->velocity("table");
    scene->watch([this] { look(); });
  }
  std::int32_t counts() {  // 6064h, as the drive has it
    return static_cast<std::int32_t>(scene->drive("table").dictionary().find({0x6064, 0})->number);
  }
  void look() {
    const std::int32_t counted = counts();
    if (std::abs(double(counted) - double(counted_)) > 2147483648.0) ++overflows;
    counted_ = counted;
    const double speed = scene->velocity("table");
    hardest = std::max(hardest, std::abs(speed - speed_) / 0.001);
    speed_ = speed;
    const double told = scene->state("table").position;
    largest_step = std::max(largest_step, std::abs(told - last_));
    off = std::max(off, std::abs(told - first_ - scene->position("table")));
    last_ = told;
  }
  double sign() const { return GetParam(); }

  std::optional<Scene> scene;
  double largest_step = 0.0, off = 0.0;  // of what is told: between looks; from the truth
  double hardest = 0.0;                  // of the motor, rad/s^2
  int overflows = 0;                     // of the drive's counter

 private:
  double last_ = 0.0, first_ = 0.0, speed_ = 0.0;
  std::int32_t counted_ = 0;
};

// Feedback is at most two cycles old, and one cycle more for the wire.
constexpr double kStep = 1.5 * 0.004 * 1.05, kOld = 1.5 * 0.012;
// 3 rad/s^2 in steps of a cycle, each of which the motor may have done within a millisecond.
constexpr double kHardest = 3.0 * 0.004 / 0.001;

TEST_P(Continuous, AStreamOfPositionsCrossesTheWrapThereAndBack) {
  begin();
  for (const double goal : {7.5, 5.0, 14.0, -7.0}) {
    ASSERT_EQ(scene->setpoint("table", sign() * goal), "");
    scene->run(16s);
    EXPECT_NEAR(scene->position("table"), sign() * goal, 1e-3) << scene->told();
  }
  EXPECT_LE(largest_step, kStep);
  EXPECT_LE(off, kOld);
  EXPECT_LE(scene->seen("table").fastest, 1.5 * 1.01);
}

TEST_P(Continuous, ATrajectoryCrossesTheWrapThereAndBack) {
  begin();
  ASSERT_TRUE(scene->move({sign() * 8.0}, 3s).success);
  scene->run(4s);
  EXPECT_NEAR(scene->position("table"), sign() * 8.0, 1e-3) << scene->told();
  ASSERT_TRUE(scene->move({sign() * 5.5}, 3s).success);
  scene->run(4s);
  EXPECT_NEAR(scene->position("table"), sign() * 5.5, 1e-3) << scene->told();
  EXPECT_LE(largest_step, kStep);
  EXPECT_LE(off, kOld);
}

TEST_P(Continuous, AStreamOfPositionsCrossesThreeOverflowsThereAndBack) {
  begin();
  for (const double goal : {36.0, 6.0}) {  // it overflows at 6.28, 18.85 and 31.42 rad
    overflows = 0;
    ASSERT_EQ(scene->setpoint("table", sign() * goal), "");
    scene->run(24s);
    EXPECT_EQ(overflows, 3);
    EXPECT_NEAR(scene->position("table"), sign() * goal, 1e-3) << scene->told();
    EXPECT_NEAR(scene->state("table").position, sign() * goal, 1e-3);
  }
  EXPECT_LE(largest_step, kStep);
  EXPECT_LE(off, kOld);
  EXPECT_LE(hardest, kHardest);
}

TEST_P(Continuous, AVelocityCrossesThreeOverflowsThereAndBack) {
  for (const char* const mode : {"cyclic_velocity", "profile_velocity"}) {
    SCOPED_TRACE(mode);
    begin(std::string(", modes: [") + mode + "]");
    ASSERT_TRUE(scene->procedure(ProcedureKind::set_mode, "table", mode).success);
    scene->stream("table", sign() * 1.4, 20s);
    EXPECT_EQ(overflows, 3);
    EXPECT_GT(std::abs(scene->state("table").position), 6.0 + 20.0);
    scene->run(1s);
    // The mode is changed far from where the drive says that it stands: nothing moves.
    scene->forget();
    ASSERT_TRUE(scene->procedure(ProcedureKind::set_mode, "table", "cyclic_position").success);
    scene->run(200ms);
    EXPECT_LT(scene->seen("table").travel(), 1e-4);
    const double goal = scene->state("table").position - sign() * 1.0;
    ASSERT_EQ(scene->setpoint("table", goal), "");
    scene->run(3s);
    EXPECT_NEAR(scene->state("table").position, goal, 1e-3);
    ASSERT_TRUE(scene->procedure(ProcedureKind::set_mode, "table", mode).success);
    overflows = 0;
    scene->stream("table", -sign() * 1.4, 20s);
    scene->run(1s);
    EXPECT_EQ(overflows, 3);
    EXPECT_LE(largest_step, kStep);
    EXPECT_LE(off, kOld);
    EXPECT_LE(hardest, kHardest);
    EXPECT_LE(scene->seen("table").fastest, 1.5 * 1.01);
  }
}

TEST_P(Continuous, AGoalOfTheDriveCrossesTheWrapThereAndBack) {
  begin(", modes: [profile_position]");
  ASSERT_TRUE(scene->procedure(ProcedureKind::set_mode, "table", "profile_position").success);
  for (const double goal : {7.5, 5.0, 10.0, 14.0, 8.0, 2.0}) {
    const double way = goal - std::abs(scene->position("table"));
    const double from = scene->position("table");
    scene->forget();
    ASSERT_EQ(scene->setpoint("table", sign() * goal), "");
    scene->run(6s);
    EXPECT_NEAR(scene->position("table"), sign() * goal, 1e-3) << scene->told();
    EXPECT_NEAR(scene->state("table").position, sign() * goal, 1e-3);
    EXPECT_TRUE(scene->state("table").target_reached);
    EXPECT_LT(scene->seen("table").travel(), std::abs(way) + 0.01)
        << "straight there from " << from;
  }
  EXPECT_LE(largest_step, kStep);
  EXPECT_LE(off, kOld);
}

TEST_P(Continuous, ADeclaredPositionHoldsOverTheWrap) {
  begin();
  ASSERT_EQ(scene->setpoint("table", sign() * 7.0), "");
  scene->run(3s);
  drive::ProcedureRequest request;
  request.kind = ProcedureKind::set_position;
  request.position = 0.5;
  ASSERT_TRUE(call(*scene, bus::ProcedureCommand{"table", request}).success);
  EXPECT_NEAR(scene->state("table").position, 0.5, 1e-3);
  ASSERT_EQ(scene->setpoint("table", 0.5 - sign() * 1.5), "");
  scene->run(3s);
  EXPECT_NEAR(scene->position("table"), sign() * 5.5, 1e-3);
  EXPECT_NEAR(scene->state("table").position, 0.5 - sign() * 1.5, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(BothWays, Continuous, testing::Values(1, -1),
                         [](const auto& tested) { return tested.param > 0 ? "Up" : "Down"; });

}  // namespace
}  // namespace cia402
