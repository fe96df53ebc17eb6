// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/bus_recorder.h"

namespace cia402::sim {
namespace {

using can::BusState;
using can::Frame;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

FaultRule rule(FaultKind kind, std::uint32_t id, unsigned count) {
  FaultRule rule;
  rule.kind = kind;
  rule.id = id;
  rule.count = count;
  return rule;
}

class BusFaultsTest : public ::testing::Test {
 protected:
  Bus bus{1e6, 7};
  BusRecorder master, drive, other;
  Port& master_port{bus.attach(master, "master")};
  Port& drive_port{bus.attach(drive, "drive")};
  Port& other_port{bus.attach(other, "other")};
};

TEST(BusFaultsGenerator, MapsTheStandardGeneratorToTheSameNumbersEverywhere) {
  // The 10000th output of std::mt19937_64 with the default seed 5489 is 9981545732273789042 (C++17
  // [rand.predef]); its upper 53 bits over 2^53 are that over 2^64.
  BusFaults faults(5489);
  double number = 0;
  for (int i = 0; i < 10'000; ++i) number = faults.uniform();
  EXPECT_NEAR(number, 9981545732273789042.0 / 18446744073709551616.0, 1e-15);
}

TEST_F(BusFaultsTest, ALostFrameCountsAsSentAndIsGoneForAll) {
  bus.faults().add(rule(FaultKind::lose, 0x080, 2));
  for (int i = 0; i < 3; ++i) master_port.send(kSync, atUs(0));
  master_port.send(kHeartbeat, atUs(0));
  bus.advance(atUs(1000));
  EXPECT_THAT(drive.ids(), ElementsAre(0x080, 0x701));
  EXPECT_THAT(other.ids(), ElementsAre(0x080, 0x701));
  EXPECT_EQ(master_port.counters().sent, 4u);
  EXPECT_EQ(drive_port.counters().lost, 2u);
  EXPECT_EQ(bus.traffic().frames, 4u);
}

TEST_F(BusFaultsTest, ALossMayHitOneReceiver) {
  FaultRule only_drive = rule(FaultKind::lose, 0x080, 1);
  only_drive.receiver = "drive";
  bus.faults().add(only_drive);
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(1000));
  EXPECT_THAT(drive.frames, IsEmpty());
  EXPECT_EQ(other.frames.size(), 1u);
}

TEST_F(BusFaultsTest, AMaskHitsAFamilyOfIdentifiers) {
  FaultRule emergencies = rule(FaultKind::lose, 0x080, 9);
  emergencies.mask = 0x780;
  bus.faults().add(emergencies);
  for (std::uint32_t id : {0x081U, 0x0FFU, 0x100U}) master_port.send(Frame(id, {}), atUs(0));
  bus.advance(atUs(1000));
  EXPECT_THAT(drive.ids(), ElementsAre(0x100));
}

TEST_F(BusFaultsTest, ADuplicatedFrameIsOnTheWireTwiceAndConfirmedOnce) {
  bus.faults().add(rule(FaultKind::duplicate, 0x080, 1));
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(1000));
  ASSERT_EQ(drive.frames.size(), 2u);
  EXPECT_EQ(drive.frames[1].time, atUs(51 + 48));
  ASSERT_EQ(master.sent.size(), 1u);
  EXPECT_EQ(master.sent[0].time, atUs(51 + 48));
}

TEST_F(BusFaultsTest, ACertainDuplicateIsStillTwoFramesOnly) {
  FaultRates rates;
  rates.duplicate = 1;
  bus.faults().setRates(rates);
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(10'000));
  EXPECT_EQ(drive.frames.size(), 2u);
}

TEST_F(BusFaultsTest, ADelayedFrameLeavesLateButInTheOrderOfItsIdentifier) {
  FaultRule late = rule(FaultKind::delay, 0x601, 1);
  late.delay = std::chrono::milliseconds(1);
  bus.faults().add(late);
  master_port.send(Frame(0x601, {1}), atUs(0));
  master_port.send(Frame(0x601, {2}), atUs(0));
  master_port.send(kHeartbeat, atUs(0));
  bus.advance(atUs(900));
  EXPECT_THAT(drive.ids(), ElementsAre(0x701));
  bus.advance(atUs(2000));
  ASSERT_THAT(drive.ids(), ElementsAre(0x701, 0x601, 0x601));
  EXPECT_GT(drive.frames[1].time, atUs(1044));
  EXPECT_LT(drive.frames[1].time, atUs(1063));
  EXPECT_EQ(drive.frames[1].frame.data[0], 1);
}

TEST_F(BusFaultsTest, ARandomDelayStaysBelowItsBound) {
  FaultRates rates;
  rates.delay = 1;
  rates.longest_delay = std::chrono::milliseconds(1);
  bus.faults().setRates(rates);
  Time latest{};
  for (int i = 0; i < 200; ++i) {
    master_port.send(kSync, atUs(i * 10'000));
    bus.advance(atUs((i + 1) * 10'000));
    const Duration delay = drive.frames.back().time - atUs(i * 10'000 + 48);
    ASSERT_GE(delay, Duration::zero());
    ASSERT_LT(delay, std::chrono::milliseconds(1));
    latest = std::max(latest, Time(delay));
  }
  EXPECT_GT(latest, atUs(900));
}

TEST_F(BusFaultsTest, ACorruptedFrameIsRepeatedAndBothSidesCountTheError) {
  std::vector<can::Frame> errors;
  bus.setMonitor([&](const Frame& frame, Time) {
    if (frame.error) errors.push_back(frame);
  });
  bus.faults().add(rule(FaultKind::corrupt, 0x080, 1));
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(30));  // the error frame cannot be over yet: 1 + 20 bits at least
  bus.advance(atUs(1000));
  ASSERT_EQ(drive.frames.size(), 1u);
  // The disturbed bit is one of the first 48; error frame and intermission are 23 bits.
  EXPECT_GE(drive.frames[0].time, atUs(1 + 23 + 48));
  EXPECT_LE(drive.frames[0].time, atUs(48 + 23 + 48));
  EXPECT_EQ(master_port.transmitErrors(), 7u);  // + 8 - 1
  EXPECT_EQ(drive_port.receiveErrors(), 0u);    // + 1 - 1
  EXPECT_EQ(master_port.counters().failed_attempts, 1u);
  EXPECT_EQ(bus.traffic().error_frames, 1u);
  EXPECT_EQ(errors.size(), 1u);
}

TEST_F(BusFaultsTest, ARepeatedFrameStaysAheadOfTheNextOfItsIdentifier) {
  bus.faults().add(rule(FaultKind::corrupt, 0x601, 1));
  master_port.send(Frame(0x601, {1}), atUs(0));
  master_port.send(Frame(0x601, {2}), atUs(0));
  bus.advance(atUs(1000));
  ASSERT_EQ(drive.frames.size(), 2u);
  EXPECT_EQ(drive.frames[0].frame.data[0], 1);
  EXPECT_EQ(drive.frames[1].frame.data[0], 2);
}

TEST_F(BusFaultsTest, ThirtyTwoFailedAttemptsInARowAreBusOff) {
  bus.faults().add(rule(FaultKind::corrupt, 0x080, 31));
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(31 * (48 + 23)));
  EXPECT_EQ(master_port.counters().failed_attempts, 31u);
  // 31 * 8 = 248, or 247 once the good attempt has followed.
  EXPECT_GE(master_port.transmitErrors(), 247u);
  EXPECT_EQ(master_port.state(), BusState::error_passive);

  bus.faults().add(rule(FaultKind::corrupt, 0x081, 32));
  Port& drive_sender = drive_port;
  drive_sender.send(Frame(0x081, {}), atUs(10'000));
  drive_sender.send(kHeartbeat, atUs(10'000));
  bus.advance(atUs(30'000));
  EXPECT_EQ(drive_port.counters().failed_attempts, 32u);
  EXPECT_EQ(drive_port.state(), BusState::bus_off);
  EXPECT_EQ(drive_port.transmitErrors(), 256u);
  EXPECT_EQ(drive_port.counters().bus_off_events, 1u);
  EXPECT_EQ(drive_port.counters().dropped, 2u);  // the frame in vain and the one behind it
  EXPECT_THAT(drive.states,
              ElementsAre(BusState::error_warning, BusState::error_passive, BusState::bus_off));
  EXPECT_FALSE(drive_port.send(kHeartbeat, atUs(30'000)));
}

TEST_F(BusFaultsTest, ReceiversOfManyBrokenFramesBecomeErrorPassiveNeverBusOff) {
  bus.faults().add(rule(FaultKind::corrupt, 0x080, 10'000));
  for (int i = 0; i < 10; ++i) {  // 32 broken frames each, then the sender is bus-off
    master_port.send(kSync, atUs(i * 10'000));
    bus.advance(atUs((i + 1) * 10'000));
    master_port.setPowered(false);
    master_port.setPowered(true);
  }
  EXPECT_EQ(other_port.receiveErrors(), 128u);
  EXPECT_EQ(other_port.state(), BusState::error_passive);
  bus.faults().clear();
  master_port.send(kSync, bus.now());
  bus.advance(bus.now() + std::chrono::milliseconds(1));
  EXPECT_EQ(other_port.receiveErrors(), 119u);
  EXPECT_EQ(other_port.state(), BusState::error_warning);
  EXPECT_THAT(other.states, ElementsAre(BusState::error_warning, BusState::error_passive,
                                        BusState::error_warning));
}

TEST_F(BusFaultsTest, AnErrorPassiveSenderLeavesEightBitsToTheOthers) {
  bus.faults().add(rule(FaultKind::corrupt, 0x080, 17));
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(10'000));
  ASSERT_EQ(master_port.state(), BusState::error_passive);
  master.frames.clear();
  other.frames.clear();
  master_port.send(kSync, atUs(10'000));
  master_port.send(kSync, atUs(10'000));
  bus.advance(atUs(20'000));
  ASSERT_EQ(other.frames.size(), 2u);
  EXPECT_EQ(other.frames[1].time - other.frames[0].time, std::chrono::microseconds(51 + 8));

  other.frames.clear();
  master_port.send(kSync, atUs(20'000));
  master_port.send(kSync, atUs(20'000));
  drive_port.send(kHeartbeat, atUs(20'010));  // the worse identifier goes first
  bus.advance(atUs(30'000));
  EXPECT_THAT(other.ids(), ElementsAre(0x080, 0x701, 0x080));
}

TEST_F(BusFaultsTest, AForcedBusOffRecoversAfter128TimesElevenRecessiveBits) {
  bus.advance(atUs(1000));
  drive_port.send(kHeartbeat, atUs(1000));
  drive_port.forceBusOff();
  EXPECT_EQ(drive_port.state(), BusState::bus_off);
  bus.advance(atUs(5000));
  EXPECT_THAT(master.frames, IsEmpty());

  drive_port.requestRecovery();
  EXPECT_EQ(bus.nextEvent(), atUs(5000 + 1408));
  bus.advance(atUs(5000 + 1407));
  EXPECT_EQ(drive_port.state(), BusState::bus_off);
  bus.advance(atUs(5000 + 1408));
  EXPECT_EQ(drive_port.state(), BusState::error_active);
  EXPECT_EQ(drive_port.transmitErrors(), 0u);
  EXPECT_TRUE(drive_port.send(kHeartbeat, atUs(7000)));
  bus.advance(atUs(8000));
  EXPECT_THAT(master.ids(), ElementsAre(0x701));
}

TEST_F(BusFaultsTest, TrafficSlowsTheRecoveryFromBusOff) {
  bus.advance(atUs(0));
  drive_port.forceBusOff();
  drive_port.requestRecovery();
  // Idle until 105 us: 9 sequences. SYNC until 156 us: one. Then 118 more from there.
  master_port.send(kSync, atUs(105));
  bus.advance(atUs(200));
  EXPECT_EQ(bus.nextEvent(), atUs(156 + 118 * 11));
  bus.advance(atUs(156 + 118 * 11));
  EXPECT_EQ(drive_port.state(), BusState::error_active);
}

TEST_F(BusFaultsTest, ABusOffPortHearsNothing) {
  drive_port.forceBusOff();
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(1000));
  EXPECT_THAT(drive.frames, IsEmpty());
  EXPECT_EQ(other.frames.size(), 1u);
}

std::vector<BusRecorder::Event> noisyRun(std::uint64_t seed) {
  Bus bus(500e3, seed);
  BusRecorder a, b;
  Port& pa = bus.attach(a, "a");
  Port& pb = bus.attach(b, "b");
  FaultRates rates;
  rates.loss = 0.05;
  rates.duplicate = 0.05;
  rates.corrupt = 0.05;
  rates.delay = 0.2;
  rates.longest_delay = std::chrono::microseconds(500);
  bus.faults().setRates(rates);
  for (int i = 0; i < 1000; ++i) {
    pa.send(Frame(0x200U + static_cast<std::uint32_t>(i % 8), {static_cast<std::uint8_t>(i)}),
            atUs(i * 500));
    pb.send(kHeartbeat, atUs(i * 500 + 3));
    bus.advance(atUs(i * 500 + 400));
  }
  bus.advance(atUs(2'000'000));
  EXPECT_GT(pb.counters().lost, 20u);
  EXPECT_GT(pa.counters().failed_attempts, 20u);
  EXPECT_EQ(pa.counters().dropped, 0u);
  EXPECT_EQ(pa.counters().sent, 1000u);  // nothing vanishes but what was lost on purpose
  return b.frames;
}

TEST(BusFaultsSeed, RepeatsARunToTheNanosecond) {
  const auto first = noisyRun(42);
  const auto second = noisyRun(42);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].frame, second[i].frame);
    ASSERT_EQ(first[i].time, second[i].time);
  }
}

TEST(BusFaultsSeed, MakesAnotherRunOfAnotherSeed) {
  const auto first = noisyRun(42);
  const auto second = noisyRun(43);
  bool equal = first.size() == second.size();
  for (std::size_t i = 0; equal && i < first.size(); ++i) equal = first[i].time == second[i].time;
  EXPECT_FALSE(equal);
}

}  // namespace
}  // namespace cia402::sim
