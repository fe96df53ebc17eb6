// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the flight recorder makes of a robot that runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bus/flight_recorder.h"
#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using Kind = RecordingTrigger::Kind;
using drive::ProcedureKind;

class OpenSink : public can::Sink {
 public:
  bool send(const can::Frame&) override { return true; }
};

/// Shoulder and elbow, looked at in every cycle.
class RecordedRobot : public testing::Test {
 protected:
  static config::RobotConfig configuration() {
    config::RobotConfig robot = test::testRobot();
    robot.recorder.keep = 5;
    return robot;
  }
  RecordedRobot() { recorder.watch(world.network); }

  void observe(Duration duration) {
    for (const Time end = world.now + duration; world.now < end;) {
      world.run(test::kPeriod);
      recorder.observe();
    }
  }
  /// Those of an axis, or of the whole bus, since the last call.
  std::vector<RecordingTrigger> triggers() {
    std::vector<RecordingTrigger> all;
    RecordingTrigger trigger;
    while (recorder.nextTrigger(trigger)) all.push_back(trigger);
    return all;
  }
  std::vector<AxisRecord> records(std::size_t axis) const {
    std::vector<AxisRecord> all = recorder.copy(world.now).axes;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const AxisRecord& record) { return record.axis != axis; }),
              all.end());
    return all;
  }
  void expectOne(const std::vector<RecordingTrigger>& found, Kind kind) const {
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].kind, kind);
    EXPECT_EQ(found[0].axis, 1U);
    EXPECT_EQ(found[0].code, 0) << "none is known";
  }

  OpenSink sink;
  config::RobotConfig config = configuration();
  FlightRecorder recorder{config, sink};
  test::RobotWorld world{config};
};

TEST_F(RecordedRobot, HasNoTriggerWhileAllIsWell) {
  world.network.start(world.now);
  observe(1s);
  (void)world.begin(ProcedureKind::enable);
  observe(1s);
  ASSERT_EQ(world.axis(1).state().state, drive::State::operation_enabled);
  EXPECT_TRUE(triggers().empty());
}

TEST_F(RecordedRobot, AFaultIsOneTriggerWhateverElseChangesWhileItLasts) {
  world.enable();
  observe(100ms);
  world.drives[1].statusword = 0x0218;  // fault, without an EMCY
  observe(20ms);
  expectOne(triggers(), Kind::fault);
  world.drives[1].statusword_bits = 0x0080;  // a warning comes
  observe(20ms);
  ASSERT_TRUE(world.axis(1).state().warning);
  EXPECT_TRUE(triggers().empty());
}

TEST_F(RecordedRobot, AFaultIsATriggerWithItsErrorInAStormOfEmergencies) {
  world.enable();
  observe(100ms);
  EmergencyEvent emergency;
  emergency.axis = 1;
  emergency.emergency.code = 0x2310;
  emergency.emergency.stamp = world.now;
  recorder.onEmergency(emergency);
  observe(2s);
  triggers();
  world.drives[1].fault(0x8611);
  observe(100ms);
  const auto found = triggers();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Kind::fault);
  EXPECT_EQ(found[0].axis, 1U);
  EXPECT_EQ(found[0].code, 0x8611);
  const auto all = records(1);
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.back().error_code, 0x8611);
}

TEST_F(RecordedRobot, ADriveThatFallsSilentIsOneTriggerWhateverElseChangesWhileItIsLost) {
  world.enable();
  observe(100ms);
  EXPECT_TRUE(triggers().empty());
  world.drives[1].silent = true;
  observe(2s);
  ASSERT_EQ(world.axis(1).state().health, fieldbus::Health::lost);
  const auto found = triggers();
  EXPECT_EQ(std::count_if(found.begin(), found.end(),
                          [](const RecordingTrigger& trigger) {
                            return trigger.kind == Kind::node_lost && trigger.axis == 1 &&
                                   trigger.code == 0;
                          }),
            1);
  world.axis(1).loseZero();
  observe(20ms);
  ASSERT_FALSE(world.axis(1).state().homed);
  EXPECT_TRUE(triggers().empty());
  EXPECT_EQ(recorder.suppressed(), 0U);
}

TEST_F(RecordedRobot, ANodeThatIsTakenOutOfOperationIsOneTrigger) {
  world.boot();
  observe(100ms);
  NmtServiceCommand stop;
  stop.axis = "elbow";
  stop.command = "stop";
  const auto answers = world.begin(stop);
  observe(20ms);
  world.network.receive(can::Frame(0x702, {0x04}), world.now, world.now);  // it is stopped
  observe(100ms);
  ASSERT_EQ(answers->size(), 1U);
  ASSERT_EQ(world.axis(1).state().health, fieldbus::Health::failed);
  expectOne(triggers(), Kind::node_failed);
}

TEST_F(RecordedRobot, AFailureOfTheLastAxisHidesNoBusOff) {
  world.enable();
  observe(100ms);
  recorder.onInterface(can::BusState::error_active, world.now);
  world.drives[1].statusword = 0x0218;
  observe(20ms);
  expectOne(triggers(), Kind::fault);
  observe(2s);  // that recording is over, the next one of the elbow may begin after 10 s
  recorder.onInterface(can::BusState::bus_off, world.now);
  const auto found = triggers();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Kind::bus_off);
  EXPECT_EQ(found[0].code, 0);
  EXPECT_EQ(found[0].stamp, world.now);
}

TEST_F(RecordedRobot, EachAxisIsRecordedTenTimesASecondThoughNothingHappens) {
  world.boot();
  observe(1s);
  const Time from = world.now;
  observe(2s);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<AxisRecord> quiet = records(axis);
    quiet.erase(std::remove_if(quiet.begin(), quiet.end(),
                               [&](const AxisRecord& record) { return record.stamp <= from; }),
                quiet.end());
    EXPECT_NEAR(static_cast<double>(quiet.size()), 20.0, 1.0);
    for (std::size_t i = 1; i < quiet.size(); ++i) {
      EXPECT_GE(quiet[i].stamp - quiet[i - 1].stamp, 100ms);
    }
  }
}

TEST_F(RecordedRobot, AChangeIsRecordedInItsCycleAndOnce) {
  world.enable();
  observe(1s);
  world.drives[1].statusword_bits = 0x0080;
  const Time from = world.now;
  observe(40ms);
  const auto all = records(1);
  const auto first = std::find_if(all.begin(), all.end(), [](const AxisRecord& record) {
    return (record.flags & AxisRecord::warning) != 0;
  });
  ASSERT_NE(first, all.end());
  EXPECT_LE(first->stamp, from + 12ms);
  EXPECT_LE(std::count_if(all.begin(), all.end(),
                          [&](const AxisRecord& record) { return record.stamp > from; }),
            2)
      << "with a sample";
}

TEST_F(RecordedRobot, BetweenTwoCyclesNothingIsRecorded) {
  world.boot();
  observe(1s);
  const std::size_t before = recorder.copy(world.now).notes.size();
  (void)world.begin(ProcedureKind::enable);  // has its first step
  recorder.observe();
  EXPECT_EQ(recorder.copy(world.now).notes.size(), before);
  observe(8ms);
  EXPECT_GT(recorder.copy(world.now).notes.size(), before);
}

TEST_F(RecordedRobot, KeepsTheWordsOfEventsWithTheirTime) {
  Event event;
  event.text.assign("something happened");
  event.stamp = world.now - 3s;
  recorder.onEvent(event);
  const Recording recording = recorder.copy(world.now);
  ASSERT_EQ(recording.notes.size(), 1U);
  EXPECT_EQ(recording.notes[0].kind, NoteRecord::Kind::event);
  EXPECT_EQ(recording.notes[0].axis, NoteRecord::kNoAxis);
  EXPECT_EQ(recording.notes[0].view(), "something happened");
  EXPECT_EQ(recording.notes[0].stamp, event.stamp);
}

TEST_F(RecordedRobot, ACopySaysWhichTimeItIsOf) {
  const Time end{100s};
  const Recording recording = recorder.copy(end);
  EXPECT_EQ(recording.end, end);
  EXPECT_EQ(recording.begin, end - config.recorder.duration);
}

TEST_F(RecordedRobot, FramesOfOneMomentStayInTheOrderInWhichTheyCame) {
  for (std::uint32_t id = 0x181; id <= 0x1A0; ++id) {
    recorder.received(can::Frame(id, {1}), world.now);
  }
  const auto frames = recorder.copy(world.now).frames;
  ASSERT_EQ(frames.size(), 0x20U);
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(frames[i].frame().id, 0x181U + i);
}

}  // namespace
}  // namespace cia402::bus
