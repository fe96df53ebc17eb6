// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "sim/bus_recorder.h"

namespace cia402::sim {
namespace {

using can::BusState;
using can::Frame;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Frame kNmtStart(0x000, {1, 0});  // 68 bits, see bit_timing_test.cpp

class BusTest : public ::testing::Test {
 protected:
  Bus bus{1e6};
  BusRecorder master, drive, other;
  Port& master_port{bus.attach(master, "master")};
  Port& drive_port{bus.attach(drive, "drive")};
  Port& other_port{bus.attach(other, "other")};
};

TEST(Bus, RefusesABitRateThatIsNotPositive) {
  EXPECT_THROW(Bus(0), std::invalid_argument);
  EXPECT_THROW(Bus(-1), std::invalid_argument);
}

TEST_F(BusTest, DeliversToEveryOtherPortAtTheEndOfTheLastBit) {
  ASSERT_TRUE(master_port.send(kSync, atUs(100)));
  EXPECT_EQ(bus.nextEvent(), atUs(148));

  bus.advance(atNs(147'999));
  EXPECT_THAT(drive.frames, IsEmpty());
  bus.advance(atUs(148));
  ASSERT_EQ(drive.frames.size(), 1u);
  ASSERT_EQ(other.frames.size(), 1u);
  EXPECT_EQ(drive.frames[0].frame, kSync);
  EXPECT_EQ(drive.frames[0].time, atUs(148));
  EXPECT_THAT(master.frames, IsEmpty());
  ASSERT_EQ(master.sent.size(), 1u);
  EXPECT_EQ(master.sent[0].time, atUs(148));
  EXPECT_EQ(bus.nextEvent(), kNever);
}

TEST_F(BusTest, SeparatesFramesBackToBackByTheIntermissionOnly) {
  master_port.send(kSync, atUs(0));
  drive_port.send(kHeartbeat, atUs(10));
  bus.advance(atUs(1000));
  ASSERT_EQ(other.frames.size(), 2u);
  EXPECT_EQ(other.frames[0].time, atUs(48));
  EXPECT_EQ(other.frames[1].time, atUs(51 + 55));
}

TEST(BusTiming, FollowsTheBitRateToTheNanosecond) {
  const struct {
    double bitrate;
    std::int64_t first_end, second_end;  // 48 bits; 51 + 55 bits
  } cases[] = {{1e6, 48'000, 106'000},
               {800e3, 60'000, 132'500},
               {500e3, 96'000, 212'000},
               {125e3, 384'000, 848'000},
               {1e6 / 12, 576'000, 1'272'000}};
  for (const auto& c : cases) {
    Bus bus(c.bitrate);
    BusRecorder a, b;
    Port& port = bus.attach(a, "a");
    bus.attach(b, "b");
    port.send(kHeartbeat, atNs(0));
    port.send(kSync, atNs(0));
    bus.advance(atUs(10'000));
    ASSERT_EQ(b.frames.size(), 2u);
    EXPECT_EQ(b.frames[0].time, atNs(c.first_end)) << c.bitrate;
    EXPECT_EQ(b.frames[1].time, atNs(c.second_end)) << c.bitrate;
  }
}

TEST_F(BusTest, GivesTheBusToTheLowestIdentifierPendingWhenItFallsIdle) {
  drive_port.send(kHeartbeat, atUs(0));  // starts at once, ends at 55, idle at 58
  other_port.send(Frame(0x182, {1}), atUs(5));
  master_port.send(Frame(0x201, {1}), atUs(10));
  drive_port.send(Frame(0x181, {1}), atUs(57));
  master_port.send(kNmtStart, atUs(59));  // too late for the arbitration at 58
  BusRecorder listener;
  bus.attach(listener, "listener");
  bus.advance(atUs(10'000));
  EXPECT_THAT(listener.ids(), ElementsAre(0x701, 0x181, 0x000, 0x182, 0x201));
}

TEST_F(BusTest, LetsAFrameSentAtTheVeryMomentTheBusFallsIdleTakePartInArbitration) {
  drive_port.send(kHeartbeat, atUs(0));
  other_port.send(Frame(0x182, {1}), atUs(5));
  bus.advance(atUs(58));
  master_port.send(kNmtStart, atUs(58));
  bus.advance(atUs(1000));
  EXPECT_THAT(other.ids(), ElementsAre(0x701, 0x000));
  EXPECT_THAT(drive.ids(), ElementsAre(0x000, 0x182));
}

TEST_F(BusTest, PrefersDataToRemoteAndStandardToExtendedFramesOfTheSameBase) {
  Frame extended_remote(0x181U << 18, {});
  extended_remote.extended = extended_remote.remote = true;
  Frame extended(0x181U << 18, {});
  extended.extended = true;
  Frame later_extended((0x181U << 18) + 1, {});
  later_extended.extended = true;
  Frame remote(0x181, {});
  remote.remote = true;
  const Frame data(0x181, {});
  const Frame next(0x182, {});
  for (const Frame& frame : {next, later_extended, extended_remote, extended, remote, data}) {
    ASSERT_TRUE(master_port.send(frame, atUs(0)));
  }
  bus.advance(atUs(10'000));
  ASSERT_EQ(drive.frames.size(), 6u);
  EXPECT_EQ(drive.frames[0].frame, data);
  EXPECT_EQ(drive.frames[1].frame, remote);
  EXPECT_EQ(drive.frames[2].frame, extended);
  EXPECT_EQ(drive.frames[3].frame, extended_remote);
  EXPECT_EQ(drive.frames[4].frame, later_extended);
  EXPECT_EQ(drive.frames[5].frame, next);
}

TEST_F(BusTest, KeepsTheOrderOfFramesOfOneIdentifier) {
  for (std::uint8_t i = 0; i < 5; ++i) master_port.send(Frame(0x601, {i}), atUs(0));
  bus.advance(atUs(10'000));
  ASSERT_EQ(drive.frames.size(), 5u);
  for (std::uint8_t i = 0; i < 5; ++i) EXPECT_EQ(drive.frames[i].frame.data[0], i);
}

TEST_F(BusTest, RefusesAndCountsWhatDoesNotFitIntoTheQueue) {
  BusRecorder small;
  Port& port = bus.attach(small, "small", 2);
  EXPECT_TRUE(port.send(Frame(1, {}), atUs(0)));
  EXPECT_TRUE(port.send(Frame(2, {}), atUs(0)));
  EXPECT_FALSE(port.send(Frame(3, {}), atUs(0)));
  EXPECT_EQ(port.counters().dropped, 1u);
  bus.advance(atUs(10'000));
  EXPECT_THAT(drive.ids(), ElementsAre(1, 2));
}

TEST_F(BusTest, RefusesFramesThatHaveNoFormOnTheWire) {
  Frame error(0x40, {});
  error.error = true;
  Frame too_long(0x181, {});
  too_long.size = 9;
  EXPECT_FALSE(master_port.send(Frame(0x800, {}), atUs(0)));
  EXPECT_FALSE(master_port.send(error, atUs(0)));
  EXPECT_FALSE(master_port.send(too_long, atUs(0)));
  EXPECT_EQ(master_port.counters().dropped, 3u);
  EXPECT_EQ(bus.nextEvent(), kNever);
}

TEST_F(BusTest, SendsWithoutATimeAtTheTimeOfTheBus) {
  bus.setTime(atUs(500));
  master_port.send(kSync);
  bus.setTime(atUs(400));  // never backwards
  EXPECT_EQ(bus.now(), atUs(500));
  bus.advance(atUs(1000));
  EXPECT_EQ(drive.frames.at(0).time, atUs(548));
}

// Answers at once, from within the callback.
struct Answerer : Listener {
  Port* port = nullptr;
  void onFrame(const Frame& frame, Time) override {
    if (frame.id == 0x080) port->send(Frame(0x181, {}));
  }
};

TEST_F(BusTest, LetsAListenerAnswerAtTheEndOfTheFrameItHears) {
  Answerer answerer;
  answerer.port = &bus.attach(answerer, "answerer");
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(200));
  ASSERT_EQ(master.frames.size(), 1u);
  // SYNC occupies the bus until 51 us. 0 00110000001 000 0000 CRC: see the reference length below.
  EXPECT_GE(master.frames[0].time, atUs(51 + 44));
  EXPECT_LE(master.frames[0].time, atUs(51 + 52));
}

TEST_F(BusTest, TellsTheLoadSinceStartAndOfTheLastSecond) {
  bus.advance(atUs(0));
  for (int ms = 0; ms < 1500; ++ms) {
    bus.advance(atUs(ms * 1000));
    master_port.send(kSync, atUs(ms * 1000));
  }
  bus.advance(atUs(1'500'000));
  EXPECT_DOUBLE_EQ(bus.load(), 0.051);
  EXPECT_DOUBLE_EQ(bus.recentLoad(), 0.051);
  bus.advance(atUs(2'000'000));
  EXPECT_DOUBLE_EQ(bus.load(), 0.051 * 0.75);
  EXPECT_DOUBLE_EQ(bus.recentLoad(), 0.051 * 0.5);
  bus.advance(atUs(3'000'000));
  EXPECT_DOUBLE_EQ(bus.recentLoad(), 0.0);
  master_port.send(kSync, atUs(3'000'000));
  bus.advance(atUs(3'050'000));  // counts once its tenth of a second is full
  EXPECT_DOUBLE_EQ(bus.recentLoad(), 0.0);
  bus.advance(atUs(3'100'000));
  EXPECT_DOUBLE_EQ(bus.recentLoad(), 0.000051);
  EXPECT_EQ(bus.traffic().frames, 1501u);
  EXPECT_EQ(bus.traffic().busy_bits, 1501u * 51u);
}

TEST_F(BusTest, CountsTheLoadFromTheFirstTimeItIsGiven) {
  const Time boot = atNs(86'400'000'000'000);
  bus.setTime(boot);
  master_port.send(kSync, boot);
  bus.advance(boot + std::chrono::microseconds(510));
  EXPECT_DOUBLE_EQ(bus.load(), 0.1);
  EXPECT_DOUBLE_EQ(bus.recentLoad(), 0.1);
}

TEST_F(BusTest, ShowsTheMonitorEveryFrameBeforeThePorts) {
  std::vector<std::uint32_t> seen;
  bus.setMonitor([&](const Frame& frame, Time time) {
    seen.push_back(frame.id);
    EXPECT_EQ(drive.frames.size() + other.frames.size() + 2, seen.size() * 2);
    EXPECT_EQ(time, bus.now());
  });
  master_port.send(kSync, atUs(0));
  master_port.send(kHeartbeat, atUs(0));
  bus.advance(atUs(1000));
  EXPECT_THAT(seen, ElementsAre(0x080, 0x701));
}

TEST_F(BusTest, HoldsTheFramesOfAPulledCableAndSendsThemStaleAfterwards) {
  drive_port.setAttached(false);
  EXPECT_TRUE(drive_port.send(kHeartbeat, atUs(0)));
  EXPECT_EQ(drive_port.state(), BusState::error_passive);
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(1000));
  EXPECT_THAT(drive.frames, IsEmpty());
  EXPECT_THAT(master.frames, IsEmpty());

  drive_port.setAttached(true);
  bus.advance(atUs(2000));
  ASSERT_EQ(master.frames.size(), 1u);
  EXPECT_EQ(master.frames[0].time, atUs(1000 + 55));
  EXPECT_EQ(drive_port.state(), BusState::error_warning);  // TEC 128 less one
  EXPECT_THAT(drive.states, ElementsAre(BusState::error_passive, BusState::error_warning));
}

TEST_F(BusTest, DoesNotGiveAFrameToAPortThatJoinedInItsMiddle) {
  drive_port.setAttached(false);
  master_port.send(kSync, atUs(0));
  bus.advance(atUs(20));
  drive_port.setAttached(true);
  bus.advance(atUs(100));
  EXPECT_THAT(drive.frames, IsEmpty());
  EXPECT_EQ(other.frames.size(), 1u);
}

TEST_F(BusTest, ForgetsQueueAndErrorCountersWithoutPower) {
  drive_port.setAttached(false);
  drive_port.send(kHeartbeat, atUs(0));
  drive_port.setPowered(false);
  EXPECT_EQ(drive_port.state(), BusState::down);
  EXPECT_EQ(drive_port.counters().dropped, 1u);
  EXPECT_FALSE(drive_port.send(kHeartbeat, atUs(1)));
  drive_port.setAttached(true);
  bus.advance(atUs(100));
  master_port.send(kSync, atUs(100));
  bus.advance(atUs(500));
  EXPECT_THAT(drive.frames, IsEmpty());
  EXPECT_THAT(master.frames, IsEmpty());

  drive_port.setPowered(true);
  EXPECT_EQ(drive_port.state(), BusState::error_active);
  EXPECT_EQ(drive_port.transmitErrors(), 0u);
  master_port.send(kSync, atUs(500));
  bus.advance(atUs(1000));
  EXPECT_EQ(drive.frames.size(), 1u);
}

TEST_F(BusTest, CutsAFrameShortWhoseSenderLosesItsPower) {
  drive_port.send(kHeartbeat, atUs(0));
  bus.advance(atUs(20));
  drive_port.setPowered(false);
  master_port.send(kSync, atUs(20));
  bus.advance(atUs(1000));
  EXPECT_THAT(master.frames, IsEmpty());
  EXPECT_EQ(drive_port.counters().dropped, 1u);
  EXPECT_EQ(master_port.receiveErrors(), 1u);
  // 20 good bits, error flags 12, delimiter 8, intermission 3, then SYNC.
  EXPECT_EQ(other.frames.at(0).time, atUs(20 + 23 + 48));
  EXPECT_EQ(bus.traffic().error_frames, 1u);
}

TEST_F(BusTest, RepeatsAFrameCutShortByAPulledCableOnceTheCableIsBack) {
  drive_port.send(kHeartbeat, atUs(0));
  bus.advance(atUs(20));
  drive_port.setAttached(false);
  bus.advance(atUs(1000));
  EXPECT_THAT(master.frames, IsEmpty());
  drive_port.setAttached(true);
  bus.advance(atUs(2000));
  EXPECT_THAT(master.ids(), ElementsAre(0x701));
}

TEST(BusAcknowledge, MissingMakesALoneNodeErrorPassiveButNeverBusOff) {
  Bus bus(1e6);
  BusRecorder alone;
  Port& port = bus.attach(alone, "alone");
  port.send(kSync, atUs(0));
  // One attempt: SOF to ACK slot 40 of 51 bits, error flag 6, delimiter 8, intermission 3.
  bus.advance(atUs(15 * 57 + 56));
  EXPECT_EQ(port.transmitErrors(), 128u);
  EXPECT_EQ(port.counters().failed_attempts, 16u);
  EXPECT_EQ(port.state(), BusState::error_passive);
  bus.advance(atUs(100'000));
  EXPECT_EQ(port.transmitErrors(), 128u);
  EXPECT_EQ(port.counters().sent, 0u);
  // From then on 8 bits of suspended transmission follow each attempt: the next one starts at
  // 16 * 57 + 8 = 920 us and ends 54 us later, the others each 65 us after that.
  EXPECT_EQ(port.counters().failed_attempts, 16u + 1u + (100'000u - 974u) / 65u);
}

TEST(BusAcknowledge, MayComeFromAnAnalyser) {
  Bus bus(1e6);
  BusRecorder alone;
  Port& port = bus.attach(alone, "alone");
  bus.setAnalyser(true);
  port.send(kSync, atUs(0));
  bus.advance(atUs(48));
  EXPECT_EQ(port.counters().sent, 1u);
  EXPECT_EQ(port.state(), BusState::error_active);
}

TEST(BusAcknowledge, LetsTheFrameThroughOnceAnotherNodeAppears) {
  Bus bus(1e6);
  BusRecorder master, drive;
  Port& port = bus.attach(master, "master");
  Port& late = bus.attach(drive, "drive");
  late.setPowered(false);
  port.send(kSync, atUs(0));
  bus.advance(atUs(5000));
  late.setPowered(true);
  bus.advance(atUs(6000));
  EXPECT_EQ(drive.frames.size(), 1u);
  EXPECT_EQ(port.counters().sent, 1u);
}

}  // namespace
}  // namespace cia402::sim
