// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/task.h"

#include "canopen/lss_fixture.h"

namespace cia402::canopen::test {
namespace {

using testing::HasSubstr;

class LssTaskTest : public LssFixture {
 protected:
  LssAssignTask assign(const lss::Identity& identity, NodeId node, bool store = false,
                       std::vector<NodeId> in_use = {}) {
    LssAssignTask::Options options;
    options.identity = identity;
    options.node_id = node;
    options.store = store;
    options.in_use = [in_use = std::move(in_use)] { return in_use; };
    return LssAssignTask(options, wire);
  }
};

TEST_F(LssTaskTest, AnUnconfiguredDeviceGetsItsNodeIdByItsIdentity) {
  LssSlave& right = wire.add(parts(kServo));
  LssSlave& other = wire.add(parts(kOther));
  auto task = assign(kServo, 5);
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_EQ(right.node_id, 5);
  EXPECT_FALSE(right.configuration);
  EXPECT_EQ(right.stored, 0xFF) << "nobody asked for it";
  EXPECT_EQ(other.node_id, 0xFF);
  EXPECT_TRUE(task.changed());
  EXPECT_EQ(task.result(),
            "the device got node-ID 5 (it had none), which it forgets without power");
  std::vector<std::string> lines;
  for (const can::Frame& f : wire.sent) lines.push_back(text(f));
  const std::string waiting = "7E5 04 00 00 00 00 00 00 00";
  EXPECT_THAT(lines, testing::ElementsAre(
                         waiting, waiting, waiting, waiting, "7E5 40 CD AB 00 00 00 00 00",
                         "7E5 41 17 01 0D 00 00 00 00", "7E5 42 02 00 01 00 00 00 00",
                         "7E5 43 39 30 00 00 00 00 00", "7E5 5A 00 00 00 00 00 00 00",
                         "7E5 5B 00 00 00 00 00 00 00", "7E5 5C 00 00 00 00 00 00 00",
                         "7E5 5D 00 00 00 00 00 00 00", "7E5 5E 00 00 00 00 00 00 00",
                         "7E5 11 05 00 00 00 00 00 00", waiting, waiting, waiting, "000 82 FF"))
      << "at last those that wait for a reset, and have no node-ID yet, get one";
}

TEST_F(LssTaskTest, AtTheStartNobodyIsResetForAllAreAfterwards) {
  wire.add(parts(kServo));
  LssAssignTask::Options options;
  options.identity = kServo;
  options.node_id = 5;
  options.reset = false;
  LssAssignTask task(options, wire);
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_EQ(text(wire.sent.back()), "7E5 04 00 00 00 00 00 00 00");
}

TEST_F(LssTaskTest, ALookCallsTheIdentityNoOftenerThanAsked) {
  wire.add(parts(kOther));
  LssAssignTask::Options options;
  options.identity = kServo;
  options.node_id = 5;
  options.attempts = 2;
  LssAssignTask task(options, wire);
  EXPECT_FALSE(run(task));
  EXPECT_TRUE(task.absent());
  EXPECT_EQ(sentCount("7E5 43 39 30 00 00 00 00 00"), 2u);
  EXPECT_EQ(sentCount("7E5 4C 00 00 00 00 00 00 00"), 0u) << "many slaves do not know it";
}

TEST_F(LssTaskTest, ANodeIdIsStoredWhereAsked) {
  LssSlave& slave = wire.add(parts(kServo));
  auto task = assign(kServo, 5, true);
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_EQ(slave.stored, 5);
  EXPECT_THAT(task.result(), HasSubstr("and stored it"));
}

TEST_F(LssTaskTest, ADeviceThatHasItsNodeIdIsLeftAlone) {
  LssSlave& slave = wire.add(parts(kServo), 5);
  auto task = assign(kServo, 5, true);
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_FALSE(task.changed());
  EXPECT_EQ(slave.stored, 0xFF) << "no write to a memory that wears out, at every start";
  EXPECT_FALSE(slave.configuration);
  EXPECT_EQ(task.result(), "the device has node-ID 5 already");
  EXPECT_EQ(text(wire.sent.back()), "000 82 FF") << "it may have got it, and wait for a reset";
}

TEST_F(LssTaskTest, ADeviceWithAnotherNodeIdIsResetToTakeTheNewOne) {
  wire.add(parts(kServo), 9);
  auto task = assign(kServo, 5);
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_EQ(text(wire.sent.back()), "000 82 09");
  EXPECT_THAT(task.result(), HasSubstr("(it had 9)"));
}

TEST_F(LssTaskTest, ANodeIdSharedWithADriveInOperationIsNotReset) {
  LssSlave& slave = wire.add(parts(kServo), 9);
  auto task = assign(kServo, 5, true, {2, 9});
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("has node-ID 9, which is that of a drive in operation"));
  EXPECT_EQ(slave.pending, 9);
  EXPECT_FALSE(slave.configuration);
  EXPECT_EQ(sentCount("000 82 09"), 0u);
}

TEST_F(LssTaskTest, ANodeIdThatAnotherHasByNowIsNotGiven) {
  LssSlave& slave = wire.add(parts(kServo));
  auto task = assign(kServo, 5, true, {2, 5});
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("node-ID 5 is that of a drive in operation by now"));
  EXPECT_EQ(slave.pending, 0xFF);
  EXPECT_FALSE(slave.configuration);
}

TEST_F(LssTaskTest, WhoIsInOperationIsAskedWhenTheDeviceHasToldItsNodeId) {
  LssSlave& slave = wire.add(parts(kServo), 9);
  std::vector<NodeId> in_use;
  LssAssignTask::Options options;
  options.identity = kServo;
  options.node_id = 5;
  options.in_use = [&in_use] { return in_use; };
  LssAssignTask task(options, wire);
  task.advance(master, wire.now);
  in_use = {9};
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("has node-ID 9, which is that of a drive in operation"));
  EXPECT_EQ(slave.pending, 9);
}

TEST_F(LssTaskTest, AnAbsentDeviceIsToldWithItsIdentity) {
  wire.add(parts(kOther));
  auto task = assign(kServo, 5);
  EXPECT_FALSE(run(task));
  EXPECT_TRUE(task.absent());
  EXPECT_THAT(task.error(), HasSubstr("serial 12345"));
  EXPECT_THAT(task.error(), HasSubstr("nobody answered within 0.1 s, asked 5 times"));
  EXPECT_THAT(task.error(), HasSubstr("check power"));
}

TEST_F(LssTaskTest, TwoDevicesOfOneIdentityGetNothing) {
  LssSlave& one = wire.add(parts(kServo));
  LssSlave& two = wire.add(parts(kServo));
  auto task = assign(kServo, 5);
  EXPECT_FALSE(run(task));
  EXPECT_FALSE(task.absent());
  EXPECT_THAT(task.error(), HasSubstr("2 answers came where one device was asked"));
  EXPECT_EQ(one.pending, 0xFF);
  EXPECT_EQ(two.pending, 0xFF);
}

TEST_F(LssTaskTest, ADeviceStuckInTheConfigurationStateIsNoticedBeforeAnythingIsConfigured) {
  LssSlave& slave = wire.add(parts(kServo));
  LssSlave& stuck = wire.add(parts(kOther));
  auto task = assign(kServo, 5);
  while (task.step().find("inquiring its serial") == std::string::npos) {
    task.advance(master, wire.now);
    step();
  }
  stuck.configuration = true;
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("answers came where one device was asked"));
  EXPECT_EQ(slave.pending, 0xFF);
  EXPECT_EQ(stuck.pending, 0xFF);
}

TEST_F(LssTaskTest, ADeviceThatTellsAnotherIdentityIsNotConfigured) {
  LssSlave& slave = wire.add(parts(kServo));
  auto task = assign(kServo, 5);
  while (task.step().find("inquiring its revision") == std::string::npos) {
    task.advance(master, wire.now);
    step();
  }
  slave.identity[3] = 99;
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("inquiring its serial number"));
  EXPECT_THAT(task.error(), HasSubstr("serial 99"));
  EXPECT_EQ(slave.pending, 0xFF);
}

TEST_F(LssTaskTest, RefusalsAreToldInWordsAndTheDeviceIsReleased) {
  LssSlave& slave = wire.add(parts(kServo));
  slave.configure_error = 1;
  auto task = assign(kServo, 5);
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("setting its node-ID to 5: the device refused with error 1 "
                                      "(node-ID out of range)"));
  EXPECT_FALSE(slave.configuration);
  slave.configure_error = 0;
  slave.store_error = 1;
  auto again = assign(kServo, 5, true);
  EXPECT_FALSE(run(again));
  EXPECT_THAT(again.error(), HasSubstr("cannot store its LSS settings"));
  EXPECT_THAT(again.error(), HasSubstr("store: false"));
}

TEST_F(LssTaskTest, BitTimingIsSetInOneDevice) {
  LssSlave& slave = wire.add(parts(kServo), 3);
  LssSlave& other = wire.add(parts(kOther), 4);
  LssBitTimingTask task(kServo, 250, true);
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_EQ(slave.bit_timing, 3);
  EXPECT_EQ(other.bit_timing, -1);
  EXPECT_EQ(sentCount("7E5 13 00 03 00 00 00 00 00"), 1u);
  EXPECT_EQ(sentCount("7E5 17 00 00 00 00 00 00 00"), 1u);
  EXPECT_EQ(task.result(), "stored 250 kbit/s");
  EXPECT_FALSE(slave.configuration);
}

TEST_F(LssTaskTest, ARefusedBitTimingIsNotStored) {
  LssSlave& slave = wire.add(parts(kServo), 3);
  slave.timing_error = 1;
  LssBitTimingTask task(kServo, 10, true);
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("error 1 (bit timing not supported)"));
  EXPECT_EQ(sentCount("7E5 17 00 00 00 00 00 00 00"), 0u);
}

TEST_F(LssTaskTest, ActivationReachesAllDevicesOnce) {
  LssSlave& one = wire.add(parts(kServo), 3);
  LssSlave& two = wire.add(parts(kOther), 4);
  LssActivateTask task(500);
  ASSERT_TRUE(run(task));
  EXPECT_EQ(one.activations, 1);
  EXPECT_EQ(two.activations, 1);
  EXPECT_EQ(text(wire.sent.back()), "7E5 15 F4 01 00 00 00 00 00");
}

TEST_F(LssTaskTest, EachStepIsToldInWords) {
  wire.add(parts(kServo));
  auto task = assign(kServo, 5, true);
  std::vector<std::string> steps;
  LssTask::Status status = LssTask::Status::running;
  while (status == LssTask::Status::running) {
    status = task.advance(master, wire.now);
    if (steps.empty() || steps.back() != task.step()) steps.push_back(task.step());
    finish();
  }
  EXPECT_THAT(steps, testing::ElementsAre("switching all devices to the waiting state",
                                          "selecting the device with " + toString(kServo),
                                          "inquiring its vendor id", "inquiring its product code",
                                          "inquiring its revision number",
                                          "inquiring its serial number", "inquiring its node-ID",
                                          "setting its node-ID to 5", "storing its node-ID",
                                          "leaving the configuration state", "done"));
}

TEST_F(LssTaskTest, ASelectionWaitsForTheAnswerToWhatItAsked) {
  wire.add(parts(kServo));
  LssSelection selection(kServo);
  EXPECT_EQ(selection.advance(master, wire.now), LssSelection::Status::running);
  const std::size_t sent = wire.sent.size();
  EXPECT_EQ(selection.advance(master, wire.now), LssSelection::Status::running);
  EXPECT_EQ(selection.step(), "switching all devices to the waiting state");
  EXPECT_EQ(wire.sent.size(), sent);
}

/// A device that falls silent once it has told its node-ID.
class VanishingDevice : public LssTaskTest {
 protected:
  VanishingDevice() { wire.add(parts(kServo), 3); }
  bool runUntilItVanishes(LssTask& task) {
    while (task.step() != "inquiring its node-ID") {
      task.advance(master, wire.now);
      step();
    }
    finish();
    wire.slaves.clear();
    return run(task);
  }
};

TEST_F(VanishingDevice, WasNotGivenANodeId) {
  auto task = assign(kServo, 5);
  EXPECT_FALSE(runUntilItVanishes(task));
  EXPECT_THAT(task.error(), HasSubstr("while setting its node-ID to 5: nobody answered"));
}

TEST_F(VanishingDevice, WasNotGivenABitTiming) {
  LssBitTimingTask task(kServo, 250, true);
  EXPECT_FALSE(runUntilItVanishes(task));
  EXPECT_THAT(task.error(), HasSubstr("while setting the bit timing: nobody answered"));
  EXPECT_EQ(sentCount("7E5 17 00 00 00 00 00 00 00"), 0u) << "nothing to store";
}

TEST_F(LssTaskTest, ABitTimingForADeviceThatIsNotThereIsNoneThatWasSet) {
  wire.add(parts(kOther));
  LssBitTimingTask task(kServo, 250, false);
  EXPECT_FALSE(run(task));
  EXPECT_THAT(task.error(), HasSubstr("serial 12345"));
  EXPECT_THAT(task.error(), HasSubstr("nobody answered"));
}

/// Every second of these frames or so is lost; whatever is said at the end must be true.
TEST_F(LssTaskTest, UnderLossADeviceGetsItsNodeIdOrAReason) {
  int assigned = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    wire.slaves.clear();
    wire.random.seed(seed);
    wire.loss = seed % 2 == 0 ? 0.1 : 0.01;
    wire.duplicates = wire.loss;
    LssSlave& right = wire.add(parts(kServo));
    LssSlave& other = wire.add(parts(kOther));
    auto task = assign(kServo, 5, true);
    const bool ok = run(task);
    assigned += ok;
    EXPECT_EQ(other.node_id, 0xFF) << seed;
    EXPECT_EQ(other.pending, 0xFF) << seed;
    EXPECT_TRUE(ok ? right.pending == 5 : !task.error().empty()) << seed;
  }
  EXPECT_GT(assigned, 270);
}

}  // namespace
}  // namespace cia402::canopen::test
