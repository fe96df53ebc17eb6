// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/flight_recorder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using Kind = RecordingTrigger::Kind;
using testing::HasSubstr;

constexpr Time kStart{100s};

class NoSink : public can::Sink {
 public:
  bool send(const can::Frame&) override { return takes; }
  bool takes = true;
};

class NoEvents : public EventSink {
 public:
  void onEvent(const Event&) override {}
};

/// A recorder whose robot does not run.
class Recorder : public testing::Test {
 protected:
  static config::RobotConfig configuration() {
    config::RobotConfig robot = test::testRobot();
    robot.recorder.keep = 5;
    return robot;
  }
  static EmergencyEvent emergency(std::size_t axis, std::uint16_t code, Time stamp) {
    EmergencyEvent event;
    event.axis = axis;
    event.emergency.code = code;
    event.emergency.stamp = stamp;
    return event;
  }
  std::vector<RecordingTrigger> triggers() {
    std::vector<RecordingTrigger> all;
    RecordingTrigger trigger;
    while (recorder.nextTrigger(trigger)) all.push_back(trigger);
    return all;
  }

  NoSink sink;
  NoEvents events;
  config::RobotConfig config = configuration();
  FlightRecorder recorder{config, sink};
  Network network{config, test::masterOf(config), recorder, events};
};

TEST_F(Recorder, HasRoomForTheMostFramesOfItsTimeAndOneSecond) {
  EXPECT_EQ(recorder.frameCapacity(), 234043U);  // 11 s * 10^6 bit/s / 47 bits = 234042.6
  EXPECT_GT(recorder.memory(), 234043U * 24U);
  EXPECT_LT(recorder.memory(), 7'000'000U);
}

TEST_F(Recorder, KeepsWhatTheInterfaceTook) {
  recorder.watch(network);
  network.start(kStart);  // heartbeat and NMT
  const std::size_t sent = recorder.copy(kStart).frames.size();
  ASSERT_GT(sent, 0U);
  EXPECT_EQ(recorder.copy(kStart).frames.front().direction(), can::Direction::transmitted);
  sink.takes = false;
  EXPECT_FALSE(recorder.send(can::Frame(0x201, {0x0F, 0x00})));
  EXPECT_EQ(recorder.copy(kStart).frames.size(), sent) << "was not sent";
}

TEST_F(Recorder, FramesAreSortedAndThoseOfBeforeAreLeftOut) {
  recorder.received(can::Frame(0x181, {1}), kStart - 10s - 1ms);
  recorder.received(can::Frame(0x182, {1}), kStart - 10s);
  recorder.received(can::Frame(0x184, {1}), kStart - 1s);
  recorder.received(can::Frame(0x183, {1}), kStart - 2s);
  recorder.received(can::Frame(0x185, {1}), kStart + 1ms);
  std::vector<unsigned> ids;
  for (const auto& record : recorder.copy(kStart).frames) ids.push_back(record.frame().id);
  EXPECT_EQ(ids, (std::vector<unsigned>{0x182, 0x183, 0x184}));
}

TEST_F(Recorder, AnEmergencyIsATriggerAndAnErrorResetIsNone) {
  recorder.onEmergency(emergency(1, 0x0000, kStart));
  EXPECT_FALSE(recorder.triggered());
  recorder.onEmergency(emergency(1, 0x8611, kStart));
  EXPECT_TRUE(recorder.triggered());
  EXPECT_FALSE(recorder.triggered()) << "told once";
  const auto found = triggers();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Kind::emergency);
  EXPECT_EQ(found[0].axis, 1U);
  EXPECT_EQ(found[0].code, 0x8611);
  EXPECT_EQ(found[0].stamp, kStart);
}

TEST_F(Recorder, BusOffAndALostInterfaceAreTriggers) {
  recorder.onInterface(can::BusState::missing, kStart);
  recorder.onInterface(can::BusState::error_active, kStart);
  recorder.onInterface(can::BusState::error_passive, kStart);
  EXPECT_TRUE(triggers().empty()) << "not there yet, or passing";
  recorder.onInterface(can::BusState::bus_off, kStart);
  recorder.onInterface(can::BusState::bus_off, kStart);
  recorder.onInterface(can::BusState::down, kStart + 100ms);
  const auto found = triggers();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].kind, Kind::bus_off);
  EXPECT_EQ(found[1].kind, Kind::interface_lost);
}

TEST_F(Recorder, AStormOfEmergenciesIsOneRecordingAndTheRestIsCounted) {
  for (int i = 0; i < 1000; ++i) recorder.onEmergency(emergency(0, 0x2310, kStart + i * 10ms));
  const auto found = triggers();
  // Those of half a second belong to the recording; 10 s after it another one may begin.
  ASSERT_EQ(found.size(), 51U);
  EXPECT_EQ(found.back().stamp, kStart + 500ms);
  EXPECT_EQ(recorder.suppressed(), 949U);
}

TEST_F(Recorder, EmergenciesOfAllAxesAreOneStorm) {
  recorder.onEmergency(emergency(0, 0x2310, kStart));
  recorder.onEmergency(emergency(1, 0x2310, kStart + 3s));
  EXPECT_EQ(triggers().size(), 1U);
  EXPECT_EQ(recorder.suppressed(), 1U);
}

TEST_F(Recorder, WhatFindsNoRoomBeforeTheWriterTakesItIsCounted) {
  for (int i = 0; i < 100; ++i) recorder.onEmergency(emergency(0, 0x2310, kStart + i * 1ms));
  const std::uint64_t taken = triggers().size();
  EXPECT_LT(taken, 100U);
  EXPECT_EQ(taken + recorder.suppressed(), 100U);
}

TEST_F(Recorder, AStormOfEmergenciesHidesNoFailure) {
  for (int i = 0; i < 200; ++i) recorder.onEmergency(emergency(0, 0x2310, kStart + i * 10ms));
  triggers();
  recorder.onInterface(can::BusState::error_active, kStart);
  recorder.onInterface(can::BusState::bus_off, kStart + 3s);
  const auto found = triggers();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Kind::bus_off);
}

TEST(FlightRecorder, KnowsTheIdentifiersOfPdosAsTheDrivesKeepThem) {
  NoSink sink;
  const config::RobotConfig config = test::testRobot();
  test::RobotWorld world{config};
  FlightRecorder recorder(config, sink);
  recorder.watch(world.network);
  const auto identifierOf = [&](canopen::NodeId node, canopen::PdoDirection direction) {
    for (const PdoIdentifier& known : recorder.copy(world.now).identifiers) {
      if (known.node == node && known.direction == direction && known.number == 1) {
        return unsigned{known.cob_id};
      }
    }
    return 0U;
  };
  EXPECT_EQ(identifierOf(2, canopen::PdoDirection::tpdo), 0x182U);
  EXPECT_EQ(identifierOf(2, canopen::PdoDirection::rpdo), 0x202U);
  world.boot();
  auto& nodes = world.network.master().nodes();
  nodes[1].image().setCobId(canopen::PdoDirection::tpdo, 1, 0x1E5);
  world.run(110ms);
  recorder.observe();
  EXPECT_EQ(identifierOf(2, canopen::PdoDirection::tpdo), 0x1E5U);
  EXPECT_EQ(identifierOf(1, canopen::PdoDirection::tpdo), 0x181U);
}

TEST(FlightRecorder, SamplesOfAnAxisHoldWhatItsDriveShows) {
  NoSink sink;
  const config::RobotConfig config = test::testRobot();
  test::RobotWorld world{config};
  FlightRecorder recorder(config, sink);
  recorder.watch(world.network);
  world.drives[1].position = 50000;  // counts of 0.00001 rad
  world.enable();
  world.drives[1].disturbance = 2500;  // stands there, but was told to stand at 50000
  world.run(20ms);
  recorder.observe();
  const auto axes = recorder.copy(world.now).axes;
  const auto elbow = std::find_if(axes.rbegin(), axes.rend(),
                                  [](const AxisRecord& record) { return record.axis == 1; });
  ASSERT_NE(elbow, axes.rend());
  EXPECT_FLOAT_EQ(elbow->position, 0.525F);
  EXPECT_FLOAT_EQ(elbow->target, 0.5F);
  EXPECT_FLOAT_EQ(elbow->following_error, -0.025F);
  EXPECT_TRUE(std::isnan(elbow->velocity) && std::isnan(elbow->effort)) << "it tells neither";
  EXPECT_EQ(elbow->statusword, 0x0237);
  EXPECT_EQ(elbow->error_code, 0x0000);
  EXPECT_EQ(elbow->mode, 8);
  EXPECT_EQ(elbow->state, static_cast<int>(drive::State::operation_enabled));
  EXPECT_EQ(elbow->health, static_cast<int>(fieldbus::Health::ready));
  EXPECT_EQ(elbow->procedure, static_cast<int>(drive::ProcedureKind::enable));
  EXPECT_EQ(elbow->flags, AxisRecord::homed | AxisRecord::ready_for_motion | AxisRecord::succeeded);
}

TEST(FlightRecorder, NotesWhenAGroupMovesStopsAndRests) {
  NoSink sink;
  const config::RobotConfig config = test::testRobot();
  test::RobotWorld world{config};
  FlightRecorder recorder(config, sink);
  recorder.watch(world.network);
  world.enable();
  const auto observe = [&](Duration duration) {
    for (const Time end = world.now + duration; world.now < end;) {
      world.run(test::kPeriod);
      recorder.observe();
    }
  };
  ASSERT_TRUE(world.move({1.0, 0.0}, 1.0).success);
  observe(500ms);
  ASSERT_TRUE(world.call(world.trajectory("arm", {})).success);
  observe(1s);
  std::vector<std::string> notes;
  for (const NoteRecord& note : recorder.copy(world.now).notes) {
    if (note.kind == NoteRecord::Kind::group) notes.emplace_back(note.view());
  }
  EXPECT_THAT(notes, testing::ElementsAre("arm: follows a trajectory", "arm: is brought to rest",
                                          "arm: at rest"));
}

TEST(FlightRecorder, NotesEachStepOfAProcedureOnce) {
  NoSink sink;
  const config::RobotConfig config = test::testRobot();
  test::RobotWorld world{config};
  FlightRecorder recorder(config, sink);
  recorder.watch(world.network);
  world.boot();
  world.drives[1].deaf_to_controlword = true;
  const auto steps = [&] {
    (void)world.begin(drive::ProcedureKind::enable, "elbow");
    for (int cycle = 0; cycle < 20; ++cycle) {
      world.run(test::kPeriod);
      recorder.observe();
    }
    std::vector<std::string> all;
    for (const NoteRecord& note : recorder.copy(world.now).notes) {
      if (note.kind != NoteRecord::Kind::step) continue;
      EXPECT_EQ(note.axis, 1U);
      all.emplace_back(note.view());
    }
    return all;
  };
  const std::vector<std::string> once = steps();
  ASSERT_FALSE(once.empty());
  EXPECT_EQ(std::adjacent_find(once.begin(), once.end()), once.end());
  world.run(2s);  // it has failed
  ASSERT_FALSE(world.axis(1).procedure().running);
  const std::vector<std::string> twice = steps();
  EXPECT_EQ(std::adjacent_find(twice.begin(), twice.end()), twice.end());
  for (const char* const step : {"waiting for standstill", "switching the mode"}) {
    EXPECT_EQ(std::count(once.begin(), once.end(), step), 1) << step;
    EXPECT_EQ(std::count(twice.begin(), twice.end(), step), 2) << "of another procedure: " << step;
  }
}

TEST(FlightRecorder, WithNothingToKeepFaultsAreNoTriggers) {
  NoSink sink;
  config::RobotConfig config = test::testRobot();
  config.recorder.keep = 0;
  FlightRecorder recorder(config, sink);
  recorder.onInterface(can::BusState::error_active, kStart);
  recorder.onInterface(can::BusState::bus_off, kStart);
  RecordingTrigger trigger;
  EXPECT_FALSE(recorder.nextTrigger(trigger));
  EXPECT_EQ(recorder.suppressed(), 0U);
}

TEST(FlightRecorder, NeedsMoreMemoryForMoreTimeAndMoreAxes) {
  NoSink sink;
  config::RobotConfig small = test::testRobot(), large = small, slow = small;
  large.recorder.duration = 60s;
  slow.bus.bitrate = 125000;
  const std::size_t base = FlightRecorder(small, sink).memory();
  EXPECT_GT(FlightRecorder(large, sink).memory(), 5 * base);
  EXPECT_LT(FlightRecorder(slow, sink).memory(), base / 4);
}

TEST(RecordingLimiter, RareFaultsAreAllRecorded) {
  RecordingLimiter limiter(10s);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(limiter.permit(kStart + i * 60s)) << i;
}

TEST(RecordingLimiter, InAStormTheGapDoublesUpToAnHour) {
  RecordingLimiter limiter(10s);
  std::vector<Time> recorded;
  for (Time now = kStart; now < kStart + 12h; now += 1s) {
    if (limiter.permit(now)) recorded.push_back(now);
  }
  std::vector<Duration> gaps;
  for (std::size_t i = 1; i < recorded.size(); ++i) gaps.push_back(recorded[i] - recorded[i - 1]);
  ASSERT_GE(gaps.size(), 12U);
  EXPECT_EQ(gaps[0], 10s);
  for (std::size_t i = 1; i < gaps.size(); ++i) {
    EXPECT_EQ(gaps[i], std::min<Duration>(2 * gaps[i - 1], 1h)) << i;
  }
  EXPECT_LE(recorded.size(), 22U) << "in twelve hours";
}

TEST(RecordingLimiter, AMinuteWithoutAFaultEndsTheStorm) {
  RecordingLimiter limiter(10s);
  // Recorded after 0, 10, 30, 70, 150 and 310 s; not before 630 s again.
  for (int i = 0; i < 400; ++i) limiter.permit(kStart + i * 1s);
  EXPECT_FALSE(limiter.permit(kStart + 458s));
  EXPECT_TRUE(limiter.permit(kStart + 518s));
  EXPECT_FALSE(limiter.permit(kStart + 527s));
  EXPECT_TRUE(limiter.permit(kStart + 528s));
}

}  // namespace
}  // namespace cia402::bus
