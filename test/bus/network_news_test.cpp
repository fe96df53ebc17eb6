// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What people are told of the axes, as it happens.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

AxisWords words(const RobotWorld& world, std::size_t axis) {
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  return snapshot.axes[axis].words;
}

/// The only event with these words.
Event eventWith(const RobotWorld& world, const std::string& text) {
  EXPECT_EQ(world.eventsWith(text), 1u) << world.allEvents();
  for (const Event& event : world.events) {
    if (event.text.str().find(text) != std::string::npos) return event;
  }
  return {};
}

struct Stream {
  const char* mode;
  bool brakes;
  const char* told;
};

class DriedUpStream : public testing::TestWithParam<Stream> {};

TEST_P(DriedUpStream, IsToldWithWhatBecomesOfTheAxisAndShownWhileItLasts) {
  config::RobotConfig config = test::testRobot();
  config.axes[0].mode = GetParam().mode;
  config.axes[0].brake_after_effort = GetParam().brakes;
  config.axes[0].command_timeout = 250ms;
  RobotWorld world(config);
  world.enable();
  EXPECT_TRUE(world.begin(SetpointCommand{0, 0.5})->empty());
  world.run(240ms);
  EXPECT_EQ(words(world, 0).stream.str(), "");
  world.run(30ms);
  EXPECT_EQ(words(world, 0).stream.str(), GetParam().told);
  EXPECT_EQ(words(world, 1).stream.str(), "");
  const Event event = eventWith(world, std::string("shoulder (node 1): ") + GetParam().told);
  EXPECT_EQ(event.severity, Event::Severity::warning);
  world.run(100ms);
  EXPECT_EQ(world.eventsWith(GetParam().told), 1u) << "once";
  EXPECT_TRUE(world.begin(SetpointCommand{0, 0.5})->empty());
  world.run(20ms);
  EXPECT_EQ(words(world, 0).stream.str(), "");
}

INSTANTIATE_TEST_SUITE_P(
    Of, DriedUpStream,
    testing::Values(Stream{"cyclic_velocity", true,
                           "its stream of velocities ended without a zero: nothing came for 0.25 s "
                           "(command_timeout), so it is ramped to rest"},
                    Stream{"cyclic_torque", false,
                           "its stream of efforts ended without a zero: nothing came for 0.25 s "
                           "(command_timeout), so it coasts (command_timeout_action: coast)"}),
    [](const auto& tested) { return std::string(tested.param.mode); });

struct NetworkNews : testing::Test {
  /// Drives that take a controlword by SDO are told to stop before they are configured.
  NetworkNews() { world.drives[0].objects[{0x6040, 0}] = {0, 0}; }
  RobotWorld world;
};

TEST_F(NetworkNews, ABootIsOneLineAndWhatItFoundIsShown) {
  world.boot();
  const Event well = eventWith(world, "shoulder (node 1): booted in 0.");
  EXPECT_THAT(well.text.str(), HasSubstr(" s: identified, configured and started"));
  EXPECT_EQ(well.severity, Event::Severity::info);
  EXPECT_THAT(words(world, 0).boot.str(), testing::MatchesRegex("booted in 0\\.[0-9]+ s"));
  const Event warned = eventWith(world, "elbow (node 2): booted in 0.");
  EXPECT_THAT(warned.text.str(), HasSubstr(" s: it works, but was not told to stop before"));
  EXPECT_EQ(warned.severity, Event::Severity::warning);
  EXPECT_THAT(words(world, 1).boot.str(),
              AllOf(HasSubstr("booted in 0."), HasSubstr(" s; was not told to stop before")));
}

TEST_F(NetworkNews, ALostDriveIsAnError) {
  world.boot();
  world.drives[0].silent = true;
  world.run(2s);
  EXPECT_EQ(eventWith(world, "shoulder (node 1): no heartbeat").severity, Event::Severity::error);
}

TEST(NetworkNewsOfAnOptionalDrive, AreAWarning) {
  config::RobotConfig config = test::testRobot();
  config.devices[0].boot.optional = true;
  RobotWorld world(config);
  world.boot();
  world.drives[0].silent = true;
  world.run(2s);
  const Event event = eventWith(world, "; it is optional, the others go on without it");
  EXPECT_THAT(event.text.str(), HasSubstr("shoulder (node 1)"));
  EXPECT_EQ(event.severity, Event::Severity::warning);
}

// Half a second after the boot, and as long as a TPDO may fail to come: ten cycles of 4 ms.
TEST_F(NetworkNews, FeedbackThatIsMissingIsAProblemOnceItHadTheTimeToCome) {
  world.drives[1].tpdo_bytes = 0;
  world.network.start(world.now);
  ASSERT_TRUE(
      world.runUntil([&] { return world.axis(1).state().health == fieldbus::Health::ready; }));
  world.run(530ms);
  EXPECT_EQ(words(world, 1).problem.str(), "");
  world.run(200ms);
  EXPECT_THAT(words(world, 1).problem.str(), HasSubstr("elbow (node 2): its state is unknown"));
  EXPECT_EQ(eventWith(world, "elbow (node 2): its state is unknown").severity,
            Event::Severity::error);
  world.drives[1].tpdo_bytes = 7;
  world.run(200ms);
  EXPECT_EQ(words(world, 1).problem.str(), "");
  world.drives[1].tpdo_bytes = 0;
  world.run(530ms);
  EXPECT_EQ(words(world, 1).problem.str(), "") << "so it is when it fails to come again";
  world.run(200ms);
  EXPECT_NE(words(world, 1).problem.str(), "");
}

TEST_F(NetworkNews, StepsOfProceduresAreShownWhileTheyRun) {
  world.boot();
  world.run(200ms);
  EXPECT_EQ(words(world, 1).step.str(), "");
  EXPECT_EQ(words(world, 1).waiting_for.str(), "");
  world.drives[1].deaf_to_controlword = true;
  const auto enabling = world.begin(ProcedureKind::enable, "elbow");
  world.run(200ms);
  EXPECT_EQ(words(world, 1).step.str(), world.axis(1).procedure().step);
  EXPECT_NE(words(world, 1).step.str(), "");
  EXPECT_EQ(words(world, 1).waiting_for.str(), world.axis(1).procedure().waiting_for);
  EXPECT_NE(words(world, 1).waiting_for.str(), "");
  EXPECT_EQ(words(world, 0).waiting_for.str(), "");
  world.drives[1].deaf_to_controlword = false;
  ASSERT_TRUE(world.wait(enabling).success);
  world.run(200ms);
  EXPECT_EQ(words(world, 1).waiting_for.str(), "");
}

TEST_F(NetworkNews, ABootIsToldWithTheTimeThatItTook) {
  const Time begun = world.now;
  world.boot();
  const Event event = eventWith(world, "shoulder (node 1): booted in ");
  const long hundredths = std::lround(100 * toSeconds(event.stamp - begun));
  ASSERT_GT(hundredths, 1);
  ASSERT_LT(hundredths, 100);
  const std::string digits = std::to_string(100 + hundredths).substr(1);
  EXPECT_THAT(event.text.str(), HasSubstr("booted in 0." + digits + " s")) << hundredths;
}

TEST_F(NetworkNews, AThirdBootUpMessageWithinOneBootIsTold) {
  world.drives[0].sdo_silent = true;
  world.network.start(world.now);
  world.run(320ms);  // it is asked in vain whether its motor turns
  const auto bootUp = [&] {
    world.network.receive(can::Frame(0x701, {0x00}), world.now, world.now);
  };
  bootUp();
  EXPECT_EQ(world.eventsWith("boots up again and again"), 0u);
  bootUp();
  EXPECT_EQ(world.eventsWith("shoulder (node 1): boots up again and again"), 1u)
      << world.allEvents();
}

// Factory settings may be loaded in a boot, and take a reset.
TEST_F(NetworkNews, ASecondBootUpMessageWithinALaterBootIsNotTold) {
  world.boot();
  world.drives[0].sdo_silent = true;
  const auto reset = world.begin(NmtServiceCommand{"shoulder", "reset_node"});
  world.run(20ms);
  ASSERT_EQ(world.node(0).bootUps(), 2u);
  world.network.receive(can::Frame(0x701, {0x00}), world.now, world.now);
  EXPECT_EQ(world.eventsWith("boots up again and again"), 0u) << world.allEvents();
}

TEST_F(NetworkNews, BootUpMessagesOfSeveralBootsAreNotAddedUp) {
  world.boot();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(world.call(NmtServiceCommand{"shoulder", "reset_node"}).success);
  }
  EXPECT_EQ(world.node(0).bootUps(), 4u);
  EXPECT_EQ(world.eventsWith("boots up again and again"), 0u) << world.allEvents();
}

TEST_F(NetworkNews, AnEmergencyWithoutACodeIsCountedAndToldOfItsDrive) {
  world.boot();
  world.network.receive(can::Frame(0x082, {0x11}), world.now, world.now);
  EXPECT_EQ(world.eventsWith("elbow (node 2): an emergency frame of 1 byte has no error code"), 1u)
      << world.allEvents();
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  EXPECT_EQ(snapshot.axes[0].emergencies.malformed, 0u);
  EXPECT_EQ(snapshot.axes[1].emergencies.malformed, 1u);
}

}  // namespace
}  // namespace cia402::bus
