// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Layer setting services of a robot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"
#include "canopen/lss_slave.h"

namespace cia402::bus {
namespace {

using canopen::NodeHealth;
using canopen::test::LssSlave;
using drive::ProcedureKind;
using test::RobotWorld;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

constexpr canopen::lss::Identity kIdentities[] = {{0xABC, 7, 0x10002, 11}, {0xABC, 7, 0x10002, 22}};
constexpr const char* kShoulder =
    "vendor 0x00000ABC, product 0x00000007, revision 0x00010002, "
    "serial 11 (0x0000000B)";

config::RobotConfig byIdentity(std::size_t axes) {
  config::RobotConfig robot = test::testRobot();
  for (std::size_t i = 0; i < axes; ++i) {
    robot.axes[i].lss = drive::AxisLss();
    robot.axes[i].lss->identity = kIdentities[i];
  }
  return robot;
}

/// Shoulder and elbow with LSS; the first `unconfigured` of them come without a node-ID and are to
/// get it by their identity.
struct LssWorld : RobotWorld {
  explicit LssWorld(std::size_t unconfigured, const config::RobotConfig& config)
      : RobotWorld(config) {
    for (std::size_t i = 0; i < 2; ++i) {
      const canopen::lss::Identity& own = kIdentities[i];
      slaves[i].identity = {own.vendor_id, own.product_code, own.revision, own.serial};
      for (std::uint8_t part = 0; part < 4; ++part) {
        const std::uint32_t number = own.part(part);
        drives[i].objects[{0x1018, static_cast<std::uint8_t>(part + 1)}] = {
            static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8),
            static_cast<std::uint8_t>(number >> 16), static_cast<std::uint8_t>(number >> 24)};
      }
      if (i < unconfigured) {
        drives[i].silent = true;
      } else {
        slaves[i].node_id = slaves[i].pending = drives[i].node;
      }
    }
    bystanders = [this](const can::Frame& frame) { return hear(frame); };
  }
  explicit LssWorld(std::size_t unconfigured) : LssWorld(unconfigured, byIdentity(unconfigured)) {}

  /// Without power, and back without a node-ID.
  void takeAway(std::size_t axis) {
    drives[axis].silent = true;
    gone[axis] = true;
  }
  void bringBack(std::size_t axis) {
    slaves[axis].node_id = slaves[axis].pending = 0xFF;
    gone[axis] = false;
  }
  RobotSnapshot shown() const {
    RobotSnapshot snapshot;
    robot.fill(snapshot);
    return snapshot;
  }
  NodeHealth health(std::size_t axis) const { return robot.axes()[axis].state().health; }
  /// LSS requests that begin with these bytes.
  std::size_t asked(std::uint8_t command, int second = -1, int third = -1) const {
    std::size_t count = 0;
    for (const Sent& request : sentWithId(0x7E5)) {
      const auto& d = request.frame.data;
      count += d[0] == command && (second < 0 || d[1] == second) && (third < 0 || d[2] == third);
    }
    return count;
  }

  LssSlave slaves[2];
  bool gone[2] = {false, false};

 private:
  std::optional<can::Frame> hear(const can::Frame& frame) {
    std::optional<can::Frame> answer;
    for (std::size_t i = 0; i < 2; ++i) {
      if (gone[i]) continue;
      if (frame.id == 0x7E5) {
        std::array<std::uint8_t, 7> d{};
        const std::uint8_t cs = slaves[i].hear(frame, d);
        if (cs != 0) answer = can::Frame(0x7E4, {cs, d[0], d[1], d[2], d[3], d[4], d[5], d[6]});
      }
      drives[i].silent = slaves[i].node_id != drives[i].node;
    }
    return answer;
  }
};

bool ready(LssWorld& world) {
  return world.runUntil(
      [&] { return world.health(0) == NodeHealth::ready && world.health(1) == NodeHealth::ready; });
}

TEST(RobotLss, GivesNodeIdsOneAfterTheOtherAndBootsTheDrivesThen) {
  LssWorld world(2);
  world.robot.start(world.now);
  world.run(1ms);
  EXPECT_THAT(world.shown().axes[0].words.step.str(), HasSubstr("LSS: switching all devices"));
  EXPECT_EQ(world.shown().axes[1].words.step.str(), "LSS: waiting for its turn");
  EXPECT_THAT(world.begin(ProcedureKind::enable)->front().message,
              HasSubstr("refused: the drives are being given their node-IDs (LSS: switching all"));
  ASSERT_TRUE(world.runUntil([&] { return world.slaves[0].node_id == 1; }));
  world.run(25ms);
  EXPECT_THAT(world.shown().axes[1].words.step.str(), HasSubstr("LSS: switching all devices"));
  EXPECT_TRUE(world.sentWithId(0x000).empty()) << "all are reset afterwards";
  ASSERT_TRUE(ready(world)) << world.allEvents();
  EXPECT_EQ(world.slaves[1].node_id, 2);
  EXPECT_EQ(world.eventsWith("shoulder (node 1): LSS: the device got node-ID 1 (it had none)"), 1u);
  EXPECT_EQ(world.eventsWith("elbow (node 2): LSS: the device got node-ID 2 (it had none)"), 1u);
  EXPECT_EQ(world.sentWithId(0x000).front().frame, can::Frame(0x000, {0x82, 0x00}));
  EXPECT_EQ(world.shown().axes[0].words.problem.str(), "");
}

TEST(RobotLss, ADriveThatIsNotThereIsToldOnceAndLookedForEveryFiveSeconds) {
  LssWorld world(1);
  world.takeAway(0);
  world.robot.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == NodeHealth::ready; }));
  const std::string problem =
      std::string("shoulder (node 1): LSS: while selecting the device with ") + kShoulder +
      ": nobody answered";
  EXPECT_EQ(world.eventsWith(problem), 1u) << world.allEvents();
  EXPECT_EQ(world.asked(0x43, 11), 5u) << "times, at the start";
  ASSERT_TRUE(world.runUntil([&] { return canopen::isAway(world.health(0)); }));
  ASSERT_TRUE(world.runUntil([&] { return world.asked(0x43, 11) > 5; }));
  world.run(1s);
  world.sent.clear();
  const std::size_t told = world.events.size();
  world.run(20s);
  EXPECT_EQ(world.asked(0x43, 11), 8u) << "twice at each look";
  EXPECT_EQ(world.events.size(), told) << world.allEvents();
  EXPECT_THAT(world.shown().axes[0].words.problem.str(), HasSubstr("LSS: while selecting"));

  const Answer recovered = world.call(ProcedureKind::recover, "shoulder");
  EXPECT_FALSE(recovered.success);
  EXPECT_EQ(world.eventsWith(problem), 1u) << "the same as before";

  world.bringBack(0);
  world.sent.clear();
  ASSERT_TRUE(ready(world)) << world.allEvents();
  EXPECT_EQ(world.eventsWith("shoulder (node 1): LSS: the device got node-ID 1"), 1u);
  EXPECT_EQ(world.asked(0x43, 11), 1u);
  world.run(1s);
  EXPECT_EQ(world.shown().axes[0].words.problem.str(), "");
}

TEST(RobotLss, ANodeIdIsStoredWhereTheConfigurationSaysSo) {
  config::RobotConfig config = byIdentity(2);
  config.axes[1].lss->store = true;
  LssWorld world(2, config);
  world.robot.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  EXPECT_EQ(world.slaves[0].stored, 0xFF);
  EXPECT_EQ(world.slaves[1].stored, 2);
}

TEST(RobotLss, AnAxisThatIsNotLookedForShowsWhatItDoesItself) {
  LssWorld world(1);
  world.takeAway(0);
  world.robot.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == NodeHealth::ready; }));
  ASSERT_TRUE(world.runUntil([&] { return canopen::isAway(world.health(0)); }));
  world.drives[1].deaf_to_controlword = true;
  bool enabling = false;
  ASSERT_TRUE(world.runUntil([&] {
    if (!world.axis(1).procedure().running) (void)world.begin(ProcedureKind::enable, "elbow");
    const RobotSnapshot shot = world.shown();
    const bool looks = shot.axes[0].words.step.str().rfind("LSS: ", 0) == 0;
    enabling |= !shot.axes[1].words.step.empty();
    EXPECT_NE(shot.axes[1].words.step.str().rfind("LSS: ", 0), 0u);
    return looks && enabling;
  }));
  world.run(200ms);
  EXPECT_NE(world.shown().axes[1].words.step.str().rfind("LSS: ", 0), 0u);
}

TEST(RobotLss, RecoverAloneBeginsWithTheNodeId) {
  LssWorld world(1);
  world.robot.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.takeAway(0);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == NodeHealth::lost; }));
  ASSERT_TRUE(world.runUntil([&] { return world.asked(0x43) == 3; })) << "a look";
  world.bringBack(0);
  world.run(1s);
  world.sent.clear();
  EXPECT_FALSE(world.call(ProcedureKind::disable, "shoulder").success);
  EXPECT_FALSE(world.call(ProcedureKind::enable, "shoulder").success);
  EXPECT_EQ(world.asked(0x43), 0u);
  EXPECT_TRUE(world.call(ProcedureKind::recover, "elbow").success);
  EXPECT_EQ(world.asked(0x43), 0u) << "it is there";
  const Time called = world.now;
  const auto recovering = world.begin(ProcedureKind::recover, "shoulder");
  LssBitTimingCommand timing;
  timing.kbit_per_s = 500;
  timing.activate = true;
  EXPECT_TRUE(world.call(ProcedureKind::disable, "elbow").success);
  EXPECT_THAT(world.call(timing).message, HasSubstr("refused: recover waits for its turn"));
  const Answer recovered = world.wait(recovering);
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_EQ(world.asked(0x43), 1u);
  EXPECT_LT(world.now - called, 2s) << "not by the next look";
  EXPECT_TRUE(world.drives[0].enabled());
}

TEST(RobotLss, AScanTellsWhoseDeviceItIsAndWaitsForTheWindow) {
  LssWorld world(1);
  world.takeAway(0);
  world.robot.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == NodeHealth::ready; }));
  ASSERT_TRUE(world.runUntil([&] { return canopen::isAway(world.health(0)); }));
  ASSERT_TRUE(world.runUntil([&] { return world.asked(0x43, 11) > 5; }));
  world.run(1s);
  world.bringBack(0);
  world.sent.clear();
  LssScanCommand command;
  command.window = 10ms;
  const Answer scan = world.call(command);
  EXPECT_TRUE(scan.success) << scan.message;
  EXPECT_EQ(scan.devices, std::vector<canopen::lss::Identity>{kIdentities[0]});
  EXPECT_EQ(scan.device_axes, std::vector<std::string>{"shoulder"});
  EXPECT_THAT(scan.message, HasSubstr(std::string("1 device without a node-ID")));
  EXPECT_THAT(scan.message, HasSubstr(std::string(kShoulder) + " is that of shoulder"));
  const auto requests = world.sentWithId(0x7E5);
  const auto first = std::find_if(requests.begin(), requests.end(),
                                  [](const auto& sent) { return sent.frame.data[0] == 0x51; });
  ASSERT_NE(first, requests.end());
  EXPECT_EQ((first + 1)->time - first->time, 10ms);

  world.bringBack(0);
  world.slaves[0].identity[3] = 33;
  const Answer other = world.call(command);
  EXPECT_TRUE(other.success) << other.message;
  EXPECT_EQ(other.device_axes, std::vector<std::string>{""});
  EXPECT_THAT(other.message, Not(HasSubstr("is that of")));
  world.bringBack(0);
  world.slaves[0].deaf_part = 3;
  EXPECT_FALSE(world.call(command).success) << "there is one that it cannot name";
}

TEST(RobotLss, NothingIsScannedOrAssignedWhileAnAxisMayMove) {
  LssWorld world(0);
  world.enable();
  LssAssignCommand assign;
  assign.node_id = 9;
  for (const Answer& refused : {world.call(LssScanCommand{}), world.call(assign)}) {
    EXPECT_FALSE(refused.success);
    EXPECT_EQ(refused.message, "refused: shoulder (node 1) may be in motion; stop it first");
  }
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  EXPECT_EQ(world.call(LssScanCommand{}).message, "refused: the group arm is in motion");
  world.run(500ms);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  EXPECT_EQ(world.call(LssScanCommand{}).message, "refused: the group arm is in motion");
  world.run(1s);
  ASSERT_TRUE(world.call(ProcedureKind::disable).success);
  EXPECT_TRUE(world.call(LssScanCommand{}).success);
  world.drives[1].tpdo_bytes = 0;  // nobody knows any more
  world.run(500ms);
  EXPECT_EQ(world.call(LssScanCommand{}).message,
            "refused: elbow (node 2) may be in motion; stop it first");
  world.takeAway(1);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == NodeHealth::lost; }));
  EXPECT_TRUE(world.call(LssScanCommand{}).success) << "it is not there";
}

TEST(RobotLss, AssignsNodeIdsThatNobodyHas) {
  LssWorld world(0);
  world.boot();
  LssAssignCommand assign;
  assign.identity = {0xABC, 7, 0x10002, 33};
  const std::pair<int, const char*> refused[] = {
      {-1, "node-ID -1 is not in 1..127"},   {0, "node-ID 0 is not in 1..127"},
      {128, "node-ID 128 is not in 1..127"}, {257, "node-ID 257 is not in 1..127"},
      {127, "is the master's own"},          {1, "is that of a drive in operation"},
      {2, "is that of a drive in operation"}};
  world.sent.clear();
  for (const auto& [id, why] : refused) {
    assign.node_id = id;
    const Answer answer = world.call(assign);
    EXPECT_FALSE(answer.success) << id;
    EXPECT_THAT(answer.message, AllOf(HasSubstr("refused: node-ID "), HasSubstr(why)));
  }
  EXPECT_TRUE(world.sentWithId(0x7E5).empty());
  world.takeAway(1);
  ASSERT_TRUE(world.runUntil([&] { return world.health(1) == NodeHealth::lost; }));
  world.slaves[1].identity[3] = 33;  // another device in its place
  world.bringBack(1);
  for (const int id : {3, 126}) {
    assign.node_id = id;
    assign.store = id == 126;
    const Answer answer = world.call(assign);
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_THAT(answer.message,
                HasSubstr("serial 33 (0x00000021): the device got node-ID " + std::to_string(id)));
    EXPECT_EQ(world.slaves[1].pending, id);
    EXPECT_EQ(world.slaves[1].stored, id == 126 ? 126 : 0xFF);
  }
  assign.identity.serial = 44;
  const Answer absent = world.call(assign);
  EXPECT_FALSE(absent.success);
  EXPECT_THAT(absent.message, AllOf(HasSubstr("serial 44"), HasSubstr("nobody answered")));
}

TEST(RobotLss, TheNodeIdOfADriveThatWasNeverHeardIsFree) {
  LssWorld world(0);
  world.takeAway(1);
  world.robot.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == NodeHealth::ready; }));
  ASSERT_EQ(world.health(1), NodeHealth::booting);
  world.slaves[1].identity[3] = 33;
  world.bringBack(1);
  LssAssignCommand assign;
  assign.identity = {0xABC, 7, 0x10002, 33};
  assign.node_id = 2;
  const Answer assigned = world.call(assign);
  EXPECT_TRUE(assigned.success) << assigned.message;
  EXPECT_TRUE(ready(world)) << world.allEvents();
}

// --- Bit timing ----------------------------------------------------------------------------------

struct RobotBitTiming : testing::Test {
  RobotBitTiming() {
    world.boot();
    world.run(100ms);
    world.sent.clear();
    timing.kbit_per_s = 500;
  }
  LssWorld world{0};
  LssBitTimingCommand timing;
};

TEST_F(RobotBitTiming, IsSetInAllDrivesAndStoredWhereAsked) {
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

TEST_F(RobotBitTiming, IsRefusedWithTheReasonAndNothingIsSent) {
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

TEST_F(RobotBitTiming, ActivatedNoAxisIsEnabledBeforeAllHaveSwitched) {
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

TEST_F(RobotBitTiming, ADelayIsOneMillisecondAtLeastAndWhatTheFrameHoldsAtMost) {
  timing.activate = true;
  timing.delay = 0ms;
  EXPECT_THAT(world.call(timing).message, HasSubstr("switch in 1 ms"));
  EXPECT_EQ(world.asked(0x15, 1, 0), 1u);
  timing.delay = 100s;
  EXPECT_THAT(world.call(timing).message, HasSubstr("switch in 65535 ms"));
  EXPECT_EQ(world.asked(0x15, 0xFF, 0xFF), 1u);
}

TEST_F(RobotBitTiming, IsNotActivatedWhereADriveDoesNotTakeIt) {
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

TEST_F(RobotBitTiming, IsNeitherSetNorActivatedWhereAnAxisIsEnabledByThen) {
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

TEST(RobotBitTimingByIdentity, IsSetInTheDriveThatTheConfigurationNames) {
  LssWorld world(2);
  world.drives[0].objects[{0x1018, 4}] = {99, 0, 0, 0};  // what it tells besides
  world.robot.start(world.now);
  ASSERT_TRUE(ready(world)) << world.allEvents();
  world.run(100ms);
  LssBitTimingCommand timing;
  timing.kbit_per_s = 250;
  const Answer set = world.call(timing);
  EXPECT_TRUE(set.success) << set.message;
  EXPECT_EQ(world.slaves[0].bit_timing, 3);
  EXPECT_EQ(world.slaves[1].bit_timing, 3);
}

TEST(RobotBitTimingOfAStranger, IsRefusedWhileItsIdentityIsNotKnown) {
  LssWorld world(0);
  world.takeAway(1);
  world.robot.start(world.now);
  ASSERT_TRUE(world.runUntil([&] { return world.health(0) == NodeHealth::ready; }));
  LssBitTimingCommand timing;
  timing.kbit_per_s = 500;
  EXPECT_THAT(world.call(timing).message,
              HasSubstr("refused: the identity of elbow (node 2) is not known"));
}

}  // namespace
}  // namespace cia402::bus
