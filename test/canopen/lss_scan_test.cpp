// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/scan.h"

#include "canopen/lss_fixture.h"

namespace cia402::canopen::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

using LssScan = LssFixture;
constexpr lss::Identity kStranger{0xFFFFFFFF, 0x80000001, 0x7FFFFFFE, 0x00000001};

TEST_F(LssScan, NobodyIsFoundWhereAllHaveNodeIds) {
  wire.add(parts(kServo), 3);
  LssScanTask task;
  ASSERT_TRUE(run(task));
  EXPECT_TRUE(task.found().empty());
  EXPECT_EQ(task.result(), "0 devices without a node-ID");
}

TEST_F(LssScan, OneDeviceIsFoundByItsBits) {
  wire.add(parts(kServo));
  LssScanTask task;
  ASSERT_TRUE(run(task));
  EXPECT_THAT(task.found(), UnorderedElementsAre(kServo));
  EXPECT_FALSE(task.incomplete());
  EXPECT_EQ(task.result(), "1 device without a node-ID");
  // Vendor 0x0000ABCD: bits 31..16 are 0, bit 15 is 1, bit 14 is 0.
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 1F 00 00"), 1u);
  EXPECT_EQ(sentCount("7E5 51 00 00 00 80 1F 00 00"), 0u) << "0 is asked for first";
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 0F 00 00"), 1u);
  EXPECT_EQ(sentCount("7E5 51 00 80 00 00 0F 00 00"), 1u);
  EXPECT_EQ(sentCount("7E5 51 00 80 00 00 0E 00 00"), 1u);
  EXPECT_EQ(sentCount("7E5 51 CD AB 00 00 00 00 01"), 1u) << "on to the product code";
  EXPECT_EQ(sentCount("7E5 51 39 30 00 00 00 03 00"), 1u) << "into the configuration state";
  EXPECT_FALSE(wire.slaves[0].configuration) << "left as it was";
  EXPECT_EQ(wire.slaves[0].node_id, 0xFF);
}

TEST_F(LssScan, SeveralDevicesAreFoundOneAfterTheOther) {
  wire.add(parts(kServo));
  wire.add(parts(kOther));
  wire.add(parts(kStranger));
  wire.add({1, 1, 1, 1}, 7);
  LssScanTask task;
  ASSERT_TRUE(run(task));
  EXPECT_THAT(task.found(), UnorderedElementsAre(kServo, kOther, kStranger));
  EXPECT_FALSE(task.incomplete());
}

TEST_F(LssScan, StepsAreToldInWords) {
  wire.add(parts(kServo));
  LssScanTask task;
  task.advance(master, wire.now);
  EXPECT_EQ(task.step(), "switching all devices to the waiting state");
  finish();
  task.advance(master, wire.now);
  EXPECT_EQ(task.step(), "asking whether there is a device without a node-ID");
  finish();
  task.advance(master, wire.now);
  EXPECT_EQ(task.step(), "scanning bit 31 of the vendor id of device 1");
  while (task.step().find("serial number of device 1") == std::string::npos) {
    finish();
    task.advance(master, wire.now);
  }
  while (task.step().find("selecting") == std::string::npos) {
    finish();
    ASSERT_EQ(task.advance(master, wire.now), LssTask::Status::running);
  }
  EXPECT_EQ(task.step(), "selecting the device with " + toString(kServo));
}

TEST_F(LssScan, DevicesThatAnswerTooLateAreNoInventedOnes) {
  wire.add(parts(kServo));
  wire.answer_time = 25ms;  // each answer comes in the window of the next question
  LssScanTask task;
  run(task);
  for (const lss::Identity& found : task.found()) EXPECT_EQ(found, kServo);
  EXPECT_TRUE(task.incomplete());
  EXPECT_THAT(task.error() + task.result(), HasSubstr("longer window"));
}

TEST_F(LssScan, ALongerWindowFindsSlowDevices) {
  wire.add(parts(kServo));
  wire.answer_time = 25ms;
  master.setWindow(50ms);
  LssScanTask task;
  ASSERT_TRUE(run(task));
  EXPECT_THAT(task.found(), UnorderedElementsAre(kServo));
}

TEST_F(LssScan, TwoDevicesOfOneIdentityAreNotConfirmed) {
  wire.add(parts(kServo));
  wire.add(parts(kServo));
  LssScanTask task;
  EXPECT_FALSE(run(task));
  EXPECT_TRUE(task.found().empty());
  EXPECT_THAT(task.error(), HasSubstr("2 answers came"));
}

TEST_F(LssScan, ADeviceThatHasANodeIdIsNeverReportedAlthoughItAnswersFastscan) {
  wire.add(parts(kServo), 3).scanned_with_node_id = true;
  wire.add(parts(kOther));
  LssScanTask task;
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_THAT(task.found(), UnorderedElementsAre(kOther));
  EXPECT_FALSE(task.incomplete());
  EXPECT_THAT(task.result(), HasSubstr("1 device without a node-ID; vendor 0x0000ABCD"));
  EXPECT_THAT(task.result(), HasSubstr("serial 12345 (0x00003039) has node-ID 3"));
  EXPECT_FALSE(wire.slaves[0].configuration) << "left as it was";
}

TEST_F(LssScan, WhatDevicesOfAKindHaveInCommonIsScannedOnce) {
  for (std::uint32_t i = 0; i < 4; ++i) wire.add({0x0000ABCD, 0x000D0117, 0x00010002, 1000 + i});
  LssScanTask task;
  ASSERT_TRUE(run(task));
  EXPECT_EQ(task.found().size(), 4u);
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 1F 00 00"), 1u) << "bit 31 of the vendor id";
  EXPECT_EQ(sentCount("7E5 51 CD AB 00 00 00 00 01"), 7u)
      << "once scanned; then asked for as a whole, twice for each further one: for the last "
         "device, "
         "and as that is not there any more, for one of its kind";
  EXPECT_EQ(sentCount("7E5 51 E8 03 00 00 00 03 00"), 3u)
      << "serial 1000: told that it was found, then asked twice whether there is another one";
}

/// Slaves that mishandle fastscan, and a good one beside them that has the higher number.
class MishandledScan : public LssFixture {
 protected:
  MishandledScan() : bad(wire.add(parts(kServo))) {}
  /// @return how long it took with the usual window.
  Duration scan(LssScanTask& scanning) {
    const Time start = wire.now;
    (void)run(scanning);
    EXPECT_TRUE(scanning.incomplete());
    return wire.now - start;
  }
  LssSlave& bad;
  LssScanTask task;
};

TEST_F(MishandledScan, ADeviceThatIsFoundAgainAndAgainCostsLittleMoreThanOneScan) {
  bad.never_found = true;
  EXPECT_LE(scan(task), 5s);
  EXPECT_THAT(task.found(), UnorderedElementsAre(kServo));
  EXPECT_THAT(task.result(), HasSubstr("goes on answering after it was found"));
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 80 00 00"), 7u)
      << "is there anybody? At first, once it is found, and each of five times that it is found "
         "again";
}

TEST_F(MishandledScan, ADeviceThatSaysYesToEverythingIsNobody) {
  bad.says_yes = true;
  EXPECT_LE(scan(task), 5s);
  EXPECT_TRUE(task.found().empty());
  EXPECT_THAT(task.error(), HasSubstr("does not follow CiA 305"));
}

TEST_F(MishandledScan, ADeviceThatIsDeafToANumberIsGivenUpWhereItFallsSilent) {
  for (int part = 0; part < 4; ++part) {
    bad.deaf_part = part;
    LssScanTask each;
    EXPECT_LE(scan(each), 5s) << part;
    EXPECT_TRUE(each.found().empty());
    EXPECT_THAT(each.error(), HasSubstr("nobody answers any more")) << part;
    EXPECT_THAT(each.error(), HasSubstr("lss_assign")) << part;
  }
}

TEST_F(MishandledScan, ADeviceThatFallsSilentAtABitIsTakenUpThereAndGivenUpAfterTheThirdTime) {
  bad.deaf_part = 2;  // revision 0x00010002
  bad.deaf_bit = 20;
  scan(task);
  EXPECT_THAT(task.error(), HasSubstr("scanning bit 20 of the revision number of device 1"));
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 80 00 00"), 3u) << "is there anybody?";
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 1F 02 02"), 1u) << "bit 31 is known by then";
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 15 02 02"), 1u) << "bit 21, too";
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 14 02 02"), 18u) << "0, six times each time";
  EXPECT_EQ(sentCount("7E5 51 00 00 10 00 14 02 02"), 18u) << "1, as often";
}

TEST_F(MishandledScan, ADeviceThatIsDeafFromTheBeginningIsAskedAsOften) {
  bad.deaf_part = 0;
  scan(task);
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 1F 00 00"), 18u);
  EXPECT_EQ(sentCount("7E5 51 00 00 00 80 1F 00 00"), 18u);
}

TEST_F(MishandledScan, ADeviceThatIsScannedAgainBitByBitIsFoundOnce) {
  bad.never_found = bad.mute_moves = true;
  scan(task);
  EXPECT_THAT(task.found(), UnorderedElementsAre(kServo));
}

TEST_F(LssScan, NobodyIsLeftWhenSixQuestionsInARowWereInVain) {
  wire.add(parts(kServo));
  wire.add(parts(kOther));
  LssScanTask task;
  while (task.step() != "asking for the same vendor id") {
    ASSERT_EQ(task.advance(master, wire.now), LssTask::Status::running);
    finish();
  }
  const std::size_t before = sentCount("7E5 51 00 00 00 00 80 00 00");
  wire.slaves.pop_back();  // switched off
  ASSERT_TRUE(run(task));
  EXPECT_THAT(task.found(), UnorderedElementsAre(kServo));
  EXPECT_EQ(sentCount("7E5 51 00 00 00 00 80 00 00"), before + 6);
}

TEST_F(LssScan, FindsAsManyDevicesAsABusCanHaveAndNoMore) {
  for (std::uint32_t i = 0; i < 128; ++i) wire.add({0x0000ABCD, 0x000D0117, 0x00010002, i});
  LssScanTask task;
  ASSERT_TRUE(run(task)) << task.error();
  EXPECT_EQ(task.found().size(), 127u);
}

void expectTruth(const LssScanTask& task, const LssWire& wire, unsigned seed) {
  for (const lss::Identity& found : task.found()) {
    const bool exists =
        std::any_of(wire.slaves.begin(), wire.slaves.end(),
                    [&](const LssSlave& slave) { return slave.identity == parts(found); });
    EXPECT_TRUE(exists) << "seed " << seed << ": " << toString(found);
    EXPECT_EQ(std::count(task.found().begin(), task.found().end(), found), 1) << "seed " << seed;
  }
  if (task.found().size() < wire.slaves.size()) {
    EXPECT_TRUE(task.incomplete()) << "seed " << seed << ": one is missing, and nobody says so";
    EXPECT_NE(task.error() + task.result(), "");
  }
  for (const LssSlave& slave : wire.slaves) EXPECT_EQ(slave.pending, 0xFF);
}

TEST_F(LssScan, UnderLossIdentitiesAreRightOrMissingWithAReason) {
  int complete = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    wire.slaves.clear();
    wire.random.seed(seed);
    wire.loss = seed % 2 == 0 ? 0.1 : 0.01;
    wire.duplicates = seed % 3 == 0 ? wire.loss : 0.0;
    wire.add(parts(kServo));
    wire.add(parts(kOther));
    wire.add(parts(kStranger));
    LssScanTask task;
    run(task);
    complete += task.found().size() == 3;
    expectTruth(task, wire, seed);
  }
  EXPECT_GT(complete, 50);
}

}  // namespace
}  // namespace cia402::canopen::test
