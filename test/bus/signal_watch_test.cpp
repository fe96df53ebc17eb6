// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Values that a profile names to be shown, from the drive to whoever looks.
#include "bus/signal_watch.h"

#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using test::RobotWorld;
using namespace std::chrono_literals;

/// The shoulder's profile shows 2200h, a temperature that no TPDO brings.
config::RobotConfig withSignal() {
  config::RobotConfig robot = test::testRobot();
  drive::DriveProfile profile = *robot.axes[0].profile;
  drive::ObjectSpec temperature;
  temperature.name = "drive_temperature";
  temperature.id = {0x2200, 0};
  temperature.type = fieldbus::DataType::int16;
  profile.objects.push_back(temperature);
  profile.signals = {"drive_temperature"};
  robot.axes[0].profile = std::make_shared<const drive::DriveProfile>(profile);
  return robot;
}

NetworkSnapshot shown(RobotWorld& world) {
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  return snapshot;
}

TEST(SignalWatch, ShowsWhatTheDriveAnswersToALook) {
  RobotWorld world(withSignal());
  world.drives[0].objects[{0x2200, 0}] = {45, 0};
  world.boot();
  world.run(1s);
  EXPECT_TRUE(shown(world).axes[0].signals.empty()) << "nobody has looked";
  world.network.cycle().look();
  world.run(500ms);
  const NetworkSnapshot snapshot = shown(world);
  ASSERT_EQ(snapshot.axes[0].signals.size(), 1u);
  EXPECT_TRUE(snapshot.axes[0].signals[0].known);
  EXPECT_EQ(snapshot.axes[0].signals[0].raw, 45u);
  EXPECT_EQ(snapshot.axes[0].signals[0].object->name, "drive_temperature");
  EXPECT_TRUE(snapshot.axes[1].signals.empty()) << "its profile names none";
}

TEST(SignalWatch, AnotherLookShowsWhatItIsByThen) {
  RobotWorld world(withSignal());
  world.drives[0].objects[{0x2200, 0}] = {45, 0};
  world.boot();
  world.network.cycle().look();
  world.run(500ms);
  world.drives[0].objects[{0x2200, 0}] = {60, 0};
  world.network.cycle().look();
  world.run(500ms);
  EXPECT_EQ(shown(world).axes[0].signals[0].raw, 60u);
}

TEST(SignalWatch, WhatTheDriveDoesNotAnswerIsUnknown) {
  RobotWorld world(withSignal());
  world.boot();
  world.network.cycle().look();
  world.run(500ms);
  ASSERT_EQ(shown(world).axes[0].signals.size(), 1u);
  EXPECT_FALSE(shown(world).axes[0].signals[0].known) << "2200h does not exist: 0x06020000";
}

}  // namespace
}  // namespace cia402::bus
