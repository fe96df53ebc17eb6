// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Offsets of cyclic modes (60B0h to 60B2h): what the driver sends in them, what that does to the
// motor, and that none is left behind. The distance between set-point and joint is the motor's.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

// The rated torque, 0.64 N m, gives the simulated motor 300 turns/s^2; of the joint, behind a gear
// of 100, 64 N m give 6 pi rad/s^2.
constexpr double kInertia = 64.0 / (6.0 * 3.14159265358979);

constexpr fieldbus::ObjectId kOffsets[] = {{0x60B0, 0}, {0x60B1, 0}, {0x60B2, 0}};

std::uint64_t offset(Scene& scene, fieldbus::ObjectId object) {
  return scene.drive("left").dictionary().find(object)->number;
}

/// @param options of `feed_forward` of the left joint; the right one has none
std::string twoJoints(const std::string& options, const std::string& more = {}) {
  const std::string slow = ", simulation: {time_constant: 0.02}";
  return genericPair(", feed_forward: {" + options + "}" + slow + more, slow);
}

/// How far the motors were behind their demands at most, on the same way, in rad of the joints
/// (60F4h of the simulated drive; its demand is what the drive makes of the set-points, without
/// delays).
struct Lag {
  double left = 0.0, right = 0.0;
};

Lag lagOf(Scene& scene) {
  Lag lag;
  scene.watch([&] {
    const auto away = [&](const char* joint) {
      const auto counts = scene.drive(joint).dictionary().find({0x60F4, 0})->number;
      return std::fabs(static_cast<std::int32_t>(counts)) * 6.283185307 / (131072.0 * 100.0);
    };
    lag.left = std::max(lag.left, away("left"));
    lag.right = std::max(lag.right, away("right"));
  });
  EXPECT_TRUE(scene.move({1.2, 1.2}, 2s).success);
  scene.run(4s);
  scene.watch([] {});
  return lag;
}

TEST(FeedForward, OfTheVelocityBringsTheMotorCloserToItsSetPoints) {
  Scene scene(loadText(twoJoints("velocity: 1.0")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  const Lag lag = lagOf(scene);
  EXPECT_GT(lag.right, 0.017) << "the lag of 20 ms at 0.9 rad/s";
  EXPECT_LT(lag.left, 0.4 * lag.right);
  for (const char* joint : {"left", "right"}) {
    EXPECT_NEAR(scene.position(joint), 1.2, 1e-5) << joint;
    EXPECT_NEAR(scene.velocity(joint), 0.0, 1e-6) << joint;
  }
  for (const fieldbus::ObjectId object : kOffsets) EXPECT_EQ(offset(scene, object), 0U);
}

TEST(FeedForward, OfTheAccelerationDoesMore) {
  Scene with(loadText(twoJoints("velocity: 1.0, inertia: " + std::to_string(kInertia))));
  ASSERT_TRUE(with.boot()) << with.told();
  ASSERT_TRUE(with.procedure(ProcedureKind::enable).success) << with.told();
  Scene without(loadText(twoJoints("velocity: 1.0")));
  ASSERT_TRUE(without.boot()) << without.told();
  ASSERT_TRUE(without.procedure(ProcedureKind::enable).success) << without.told();
  EXPECT_LT(lagOf(with).left, 0.8 * lagOf(without).left);
  EXPECT_NEAR(with.position("left"), 1.2, 1e-5);
}

TEST(FeedForward, EndsWithEachStop) {
  for (const ProcedureKind stop :
       {ProcedureKind::quick_stop, ProcedureKind::halt, ProcedureKind::disable}) {
    Scene scene(loadText(twoJoints("velocity: 1.0, inertia: 1.0")));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    ASSERT_TRUE(scene.move({1.2, 1.2}, 2s).success);
    scene.run(900ms);
    ASSERT_NE(offset(scene, {0x60B1, 0}), 0U) << toString(stop);
    ASSERT_GT(scene.velocity("left"), 0.5);
    ASSERT_TRUE(scene.procedure(stop).success) << scene.told();
    scene.run(1s);
    for (const fieldbus::ObjectId object : kOffsets) {
      EXPECT_EQ(offset(scene, object), 0U) << toString(stop) << " " << toString(object);
    }
    EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-6) << toString(stop);
    scene.forget();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    scene.run(1s);
    EXPECT_LT(scene.seen("left").travel(), 1e-4) << toString(stop);
  }
}

TEST(FeedForward, OfACyclicVelocityIsItsAcceleration) {
  Scene scene(loadText(twoJoints("inertia: " + std::to_string(kInertia), ", mode: csv")));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  std::int64_t highest = 0;
  scene.watch([&] {
    const auto raw = static_cast<std::int16_t>(offset(scene, {0x60B2, 0}));
    highest = std::max<std::int64_t>(highest, raw);
  });
  ASSERT_EQ(scene.setpoint("left", 0.5), "");
  scene.run(150ms);
  // 4 rad/s^2 of 6 pi rad/s^2, in per mille of the rated torque.
  EXPECT_NEAR(static_cast<double>(highest), 1000.0 * 4.0 / (6.0 * 3.14159265), 3.0);
}

/// What a drive holds in its offsets from an earlier time, or from its memory.
TEST(Offsets, ThatStandInTheDriveMoveNothing) {
  for (const char* mode : {"csp", "csv"}) {
    Scene scene(loadText(genericPair(", mode: " + std::string(mode))));
    const auto hold = [&](std::uint16_t index, std::uint64_t number) {
      auto* entry = scene.drive("left").dictionary().find({index, 0});
      entry->number = entry->initial_number = number;  // a reset brings it back
    };
    hold(0x60B0, 300000);   // 0.14 rad
    hold(0x60B1, 1000000);  // 0.48 rad/s
    hold(0x60B2, 300);
    ASSERT_TRUE(scene.boot()) << scene.told();
    scene.forget();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    scene.run(1s);
    EXPECT_LT(scene.seen("left").travel(), 1e-4) << mode;
  }
}

/// The simulated drive obeys them: what the driver must not leave there.
TEST(Offsets, MoveTheMotorOfTheSimulatedDrive) {
  for (const unsigned index : {0x60B0U, 0x60B1U}) {
    Scene scene(loadText(genericPair()));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    scene.forget();
    scene.drive("left").dictionary().find({static_cast<std::uint16_t>(index), 0})->number = 300000;
    scene.run(500ms);
    EXPECT_GT(scene.seen("left").travel(), 5e-4) << std::hex << index;
  }
}

}  // namespace
}  // namespace cia402
