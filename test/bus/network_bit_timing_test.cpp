// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Layer setting services of a robot: bit timing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/lss_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using fieldbus::Health;
using test::LssWorld;
using test::ready;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

struct NetworkBitTiming : testing::Test {
  NetworkBitTiming() {
    world.boot();
    world.run(100ms);
    world.sent.clear();
    timing.kbit_per_s = 500;
  }
  LssWorld world{0};
  LssBitTimingCommand timing;
};

TEST_F(NetworkBitTiming, IsSetInAllDrivesAndStoredWhereAsked) {
  const Answer set = world.call(timing);
  EXPECT_TRUE(set.success);
  EXPECT_THAT(set.message,
              HasSubstr("shoulder (node 1): set (not stored) 500 kbit/s; elbow (node 2): set (not "
                        "stored) 500 kbit/s; nothing has changed on the bus yet: the drives take "
                        "it when they are powered on again (stored) or by `activate`"));
  EXPECT_EQ(world.slaves[0].bit_timing, 2);  // CiA 305: index 2 of the table
  EXPECT_EQ(world.slaves[1].bit_timing, 2);
  EXPECT_EQ(world.asked(0x17), 0u);
  EXPECT_EQ(world.asked(0x15), 0u);
  timing.axis = "elbow";
  timing.store = true;
  timing.kbit_per_s = 125;
  EXPECT_THAT(world.call(timing).message, HasSubstr("elbow (node 2): stored 125 kbit/s"));
  EXPECT_EQ(world.asked(0x17), 1u);
  EXPECT_EQ(world.slaves[0].bit_timing, 2);
  EXPECT_EQ(world.slaves[1].bit_timing, 4);
  EXPECT_TRUE(world.call(ProcedureKind::enable).success);
}

TEST_F(NetworkBitTiming, IsRefusedWithTheReasonAndNothingIsSent) {
  const auto refused = [&] {
    const Answer answer = world.call(timing);
    EXPECT_FALSE(answer.success);
    return answer.message;
  };
  timing.kbit_per_s = 100;
  EXPECT_THAT(refused(), HasSubstr("there is no bit timing of 100 kbit/s; CiA 305 has 1000, 800"));
  timing.kbit_per_s = 500;
  timing.axis = "wrist";
  EXPECT_EQ(refused(), "there is no axis \"wrist\"");
  timing.axis = "elbow";
  timing.activate = true;
  EXPECT_THAT(refused(), HasSubstr("all drives must take a new bit rate at once"));
  timing.axis.clear();
  ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
  EXPECT_EQ(refused(), "refused: elbow (node 2) is not disabled; disable it first");
  world.drives[1].deaf_to_controlword = true;
  const auto disabling = world.begin(ProcedureKind::disable, "elbow");
  EXPECT_THAT(refused(), HasSubstr("elbow (node 2) is not disabled for good: disable runs ("));
  world.drives[1].deaf_to_controlword = false;
  ASSERT_TRUE(world.wait(disabling).success);
  world.drives[0].tpdo_bytes = 0;  // nobody knows any more
  world.run(500ms);
  EXPECT_EQ(refused(), "refused: shoulder (node 1) is not disabled; disable it first");
  EXPECT_TRUE(world.sentWithId(0x7E5).empty());
  timing.axis = "elbow";
  timing.activate = false;
  EXPECT_TRUE(world.call(timing).success) << "that of another axis is none of its business";
}

TEST_F(NetworkBitTiming, ActivatedNoAxisIsEnabledBeforeAllHaveSwitched) {
  timing.activate = true;
  timing.delay = 100ms;
  const auto setting = world.begin(timing);
  EXPECT_THAT(world.call(ProcedureKind::enable).message,
              HasSubstr("enable is refused: lss_set_bit_timing is at work (LSS: "));
  const Answer set = world.wait(setting);
  EXPECT_TRUE(set.success);
  EXPECT_THAT(set.message,
              AllOf(HasSubstr("elbow (node 2): set (not stored) 500 kbit/s; all devices switch in "
                              "100 ms and are silent as long again"),
                    HasSubstr("bitrate 500000"), Not(HasSubstr("nothing has changed"))));
  EXPECT_EQ(world.asked(0x15, 100, 0), 1u);
  EXPECT_EQ(world.slaves[0].activations, 1);
  EXPECT_EQ(world.slaves[1].activations, 1);
  world.run(199ms);
  EXPECT_THAT(world.call(ProcedureKind::enable).message,
              HasSubstr("all devices switch to another bit rate at this moment"));
  world.run(2ms);
  EXPECT_TRUE(world.call(ProcedureKind::enable).success);
}

TEST_F(NetworkBitTiming, ADelayIsOneMillisecondAtLeastAndWhatTheFrameHoldsAtMost) {
  timing.activate = true;
  timing.delay = 0ms;
  EXPECT_THAT(world.call(timing).message, HasSubstr("switch in 1 ms"));
  EXPECT_EQ(world.asked(0x15, 1, 0), 1u);
  timing.delay = 100s;
  EXPECT_THAT(world.call(timing).message, HasSubstr("switch in 65535 ms"));
  EXPECT_EQ(world.asked(0x15, 0xFF, 0xFF), 1u);
}

TEST_F(NetworkBitTiming, IsNotActivatedWhereADriveDoesNotTakeIt) {
  world.slaves[0].timing_error = 1;
  timing.activate = true;
  const Answer failed = world.call(timing);
  EXPECT_FALSE(failed.success);
  EXPECT_THAT(failed.message,
              AllOf(HasSubstr("shoulder (node 1): while setting the bit timing: the device refused "
                              "with error 1 (bit timing not supported); elbow (node 2): set"),
                    HasSubstr("not all drives took it, none was told to activate it")));
  EXPECT_EQ(world.asked(0x15), 0u);
  EXPECT_TRUE(world.call(ProcedureKind::enable).success) << "the job is over";
}

TEST_F(NetworkBitTiming, IsNeitherSetNorActivatedWhereAnAxisIsEnabledByThen) {
  timing.store = true;
  const auto setting = world.begin(timing);
  ASSERT_TRUE(world.call(ProcedureKind::enable, "elbow").success);
  const Answer set = world.wait(setting);
  EXPECT_FALSE(set.success);
  EXPECT_THAT(set.message, AllOf(HasSubstr("shoulder (node 1): stored 500 kbit/s"),
                                 HasSubstr("elbow (node 2): refused: elbow (node 2) is not "
                                           "disabled")));
  EXPECT_EQ(world.slaves[1].bit_timing, -1);
  ASSERT_TRUE(world.call(ProcedureKind::disable).success);
  timing.activate = true;
  for (const bool store : {true, false}) {
    timing.store = store;
    world.slaves[1].bit_timing = -1;
    const auto activating = world.begin(timing);
    ASSERT_TRUE(world.runUntil([&] { return world.slaves[1].bit_timing == 2; }));
    drive::ProcedureRequest enable;
    enable.kind = ProcedureKind::enable;
    ASSERT_TRUE(world.axis(0).start(enable, world.now));  // by itself
    const Answer activated = world.wait(activating);
    EXPECT_FALSE(activated.success);
    EXPECT_THAT(activated.message, HasSubstr("not activated: shoulder (node 1) is not disabled"));
    EXPECT_EQ(activated.message.find("or when they are powered on again") != std::string::npos,
              store);
    ASSERT_TRUE(world.call(ProcedureKind::disable).success);
  }
  EXPECT_EQ(world.asked(0x15), 0u);
}

TEST(NetworkBitTimingByIdentity, IsSetInTheDriveThatTheConfigurationNames) {
  LssWorld world(2);
  world.drives[0].objects[{0x1018, 4}] = {99, 0, 0, 0};  // what it tells besides
  world.network.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.run(100ms);
  LssBitTimingCommand timing;
  timing.kbit_per_s = 250;
  const Answer set = world.call(timing);
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_EQ(world.slaves[0].bit_timing, 3);
  EXPECT_EQ(world.slaves[1].bit_timing, 3);
}

TEST(NetworkBitTimingOfAStranger, IsRefusedWhileItsIdentityIsNotKnown) {
  LssWorld world(0);
  world.takeAway(1);
  world.network.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == Health::ready; }));
  LssBitTimingCommand timing;
  timing.kbit_per_s = 500;
  EXPECT_THAT(world.call(timing).message,
              HasSubstr("refused: the identity of elbow (node 2) is not known"));
}

}  // namespace
}  // namespace cia402::bus
