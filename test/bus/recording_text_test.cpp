// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/recording_text.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <sstream>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

AxisRecord record(drive::State state, std::uint8_t flags = 0) {
  AxisRecord one;
  one.state = static_cast<std::uint8_t>(state);
  one.health = static_cast<std::uint8_t>(fieldbus::Health::ready);
  one.mode = 8;
  one.flags = flags;
  one.velocity = one.effort = one.following_error = std::numeric_limits<float>::quiet_NaN();
  return one;
}

TEST(AxisText, TheFirstRecordTellsEverything) {
  const auto axis = test::testAxis("shoulder", 1);
  EXPECT_EQ(axisText(nullptr, record(drive::State::switched_on, AxisRecord::homed), axis),
            "switched on; node ready; mode 8 cyclic_position; error 0x0000 none; homed; at 0 rad");
}

TEST(AxisText, ALaterOneTellsWhatChanged) {
  const auto axis = test::testAxis("shoulder", 1);
  const AxisRecord before = record(drive::State::operation_enabled, AxisRecord::ready_for_motion);
  AxisRecord after = record(drive::State::fault);
  after.error_code = 0x8611;
  after.position = 0.5F;
  after.effort = -2.25F;
  EXPECT_EQ(axisText(&before, after, axis),
            "operation enabled -> fault; error 0x0000 none -> 0x8611 following error; not ready "
            "for motion; at 0.5 rad, effort -2.25 N m");
}

TEST(AxisText, ModesAndProceduresAndMotionAreNamed) {
  const auto axis = test::testAxis("shoulder", 1);
  const AxisRecord before = record(drive::State::operation_enabled);
  AxisRecord after = record(drive::State::operation_enabled,
                            AxisRecord::running | AxisRecord::warning | AxisRecord::moving);
  after.procedure = static_cast<std::uint8_t>(drive::ProcedureKind::home);
  after.mode = 6;
  EXPECT_EQ(axisText(&before, after, axis),
            "mode 8 cyclic_position -> 6 homing; warning; set-points begin to move; procedure home "
            "begins; at 0 rad");
  AxisRecord ended = after;
  ended.flags = AxisRecord::succeeded;
  EXPECT_EQ(axisText(&after, ended, axis),
            "warning gone; set-points at rest; procedure home succeeded; at 0 rad");
  ended.flags = 0;
  EXPECT_THAT(axisText(&after, ended, axis), HasSubstr("procedure home failed"));
}

TEST(AxisText, WithoutAChangeTheNumbersRemain) {
  const auto axis = test::testAxis("shoulder", 1);
  AxisRecord one = record(drive::State::fault);
  EXPECT_EQ(axisText(&one, one, axis), "at 0 rad");
  one.position = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(axisText(&one, one, axis), "no feedback");
}

TEST(AxisText, APrismaticAxisIsInMetres) {
  auto axis = test::testAxis("slide", 1);
  axis.geometry.type = drive::AxisGeometry::Type::prismatic;
  AxisRecord one = record(drive::State::fault);
  one.position = 0.25F;
  one.velocity = 1.0F;
  EXPECT_EQ(axisText(&one, one, axis), "at 0.25 m, velocity 1 m/s");
}

TEST(RecordingText, LinesAreInTheOrderOfTimeAndTheHeadSaysWhy) {
  const config::RobotConfig robot = test::testRobot();
  Recording recording;
  recording.begin = Time(0s);
  recording.end = Time(10s);
  recording.frames = {{can::Frame(0x081, {0x11, 0x86, 0x21, 0, 0, 0, 0, 0}), Time(9s), false},
                      {can::Frame(0x000, {0x01, 0x02}), Time(9s + 2ms), true}};
  recording.axes = {record(drive::State::fault)};
  recording.axes[0].stamp = Time(9s + 1ms);
  recording.notes = {
      {NoteRecord::Kind::event, NoteRecord::kNoAxis, "something happened", Time(9s + 3ms)},
      {NoteRecord::Kind::step, 1, "switching on", Time(9s + 4ms)}};
  RecordingTrigger trigger;
  trigger.kind = RecordingTrigger::Kind::emergency;
  trigger.code = 0x8611;
  trigger.stamp = Time(9s);
  recording.triggers = {trigger};
  std::ostringstream out;
  writeText(out, recording, robot, test::masterOf(robot), 1'700'000'000s);
  EXPECT_EQ(out.str(),
            "# Flight recording of can0, 2023-11-14T22-13-20.000Z to 2023-11-14T22-13-30.000Z, 2 "
            "frames\n"
            "# 2023-11-14T22-13-29.000Z shoulder (node 1): emergency 0x8611 following error\n"
            "# s since 1970, s from the first of these, direction (rx, tx; -- is no frame), "
            "service, node, text\n"
            "1700000009.000000   +0.000000  rx  EMCY       shoulder (1)      0x8611 following "
            "error; error register 0x21 generic, device profile\n"
            "1700000009.001000   +0.001000  --  axis       shoulder (1)      fault; node ready; "
            "mode 8 cyclic_position; error 0x0000 none; at 0 rad\n"
            "1700000009.002000   +0.002000  tx  NMT        elbow (2)         start\n"
            "1700000009.003000   +0.003000  --  event      -                 something happened\n"
            "1700000009.004000   +0.004000  --  step       elbow (2)         switching on\n");
}

TEST(RecordingText, PdosAreKnownByTheIdentifiersThatTheDrivesKept) {
  const config::RobotConfig robot = test::testRobot();
  Recording recording;
  recording.frames = {{can::Frame(0x1E5, {0x37, 0x02}), Time(1ms), false},
                      {can::Frame(0x182, {0x37, 0x02}), Time(2ms), false},
                      {can::Frame(0x181, {0x37, 0x02}), Time(3ms), false}};
  recording.identifiers = {{2, canopen::PdoDirection::tpdo, 1, 0x1E5},
                           {2, canopen::PdoDirection::rpdo, 1, 0x202}};
  recording.triggers.resize(1);
  std::ostringstream out;
  writeText(out, recording, robot, test::masterOf(robot), 0s);
  EXPECT_THAT(out.str(), HasSubstr("rx  TPDO1      elbow (2)         too short, 2 of "));
  EXPECT_THAT(out.str(), HasSubstr("rx  ?          -                 0x0182: 37 02"));
  EXPECT_THAT(out.str(), HasSubstr("rx  TPDO1      shoulder (1)      too short, 2 of "));
}

TEST(RecordingText, AfterTheFirstRecordOfAnAxisOnlyWhatChangesIsTold) {
  const config::RobotConfig robot = test::testRobot();
  Recording recording;
  recording.triggers.resize(1);
  recording.axes = {record(drive::State::switched_on), record(drive::State::fault)};
  recording.axes[1].stamp = Time(1ms);
  std::ostringstream out;
  writeText(out, recording, robot, test::masterOf(robot), 0s);
  EXPECT_THAT(out.str(), HasSubstr("shoulder (1)      switched on; node ready; mode 8"));
  EXPECT_THAT(out.str(), HasSubstr("shoulder (1)      switched on -> fault; at 0 rad\n"));
}

TEST(RecordingText, AFrameComesBeforeWhatItMakesOfTheAxisAndThatBeforeWords) {
  const config::RobotConfig robot = test::testRobot();
  Recording recording;
  recording.triggers.resize(1);
  recording.frames = {{can::Frame(0x181, {0x37, 0x02}), Time(1ms), false}};
  recording.axes = {record(drive::State::fault)};
  recording.axes[0].stamp = Time(1ms);
  recording.notes = {{NoteRecord::Kind::event, NoteRecord::kNoAxis, "something", Time(1ms)}};
  std::ostringstream out;
  writeText(out, recording, robot, test::masterOf(robot), 0s);
  const std::size_t frame = out.str().find("TPDO1"), axis = out.str().find("--  axis"),
                    words = out.str().find("something");
  EXPECT_LT(frame, axis);
  EXPECT_LT(axis, words);
  EXPECT_NE(words, std::string::npos);
}

TEST(RecordingText, FramesAreLoggedWithTheirDirection) {
  Recording recording;
  can::Frame error(0x040, {0, 0, 0, 0, 0, 0, 0, 0});
  error.error = true;
  recording.frames = {{can::Frame(0x181, {0x37, 0x12}), Time(1ms), false},
                      {can::Frame(0x080, {}), Time(2ms), true},
                      {error, Time(3ms), false}};
  std::ostringstream out;
  writeFrames(out, recording, "can0", 1'700'000'000s);
  EXPECT_EQ(out.str(),
            "(1700000000.001000) can0 181#3712 R\n"
            "(1700000000.002000) can0 080# T\n"
            "(1700000000.003000) can0 20000040#0000000000000000 R\n");
}

TEST(RecordingText, NotesThatAreTooLongAreCut) {
  NoteRecord note(NoteRecord::Kind::group, NoteRecord::kNoAxis, std::string(240, 'x'), Time());
  note.append("1234");
  EXPECT_EQ(note.view(), std::string(240, 'x') + "1234");
  note.append("5");
  EXPECT_EQ(note.view(), std::string(240, 'x') + "1...");
}

TEST(RecordingText, ANoteThatIsTooLongLeavesTheNextOneAlone) {
  std::array<NoteRecord, 2> notes;
  notes[0].append(std::string(244, 'x'));
  notes[0].append("y");
  EXPECT_EQ(notes[0].view(), std::string(241, 'x') + "...");
  EXPECT_EQ(notes[1].stamp, Time{});
}

TEST(RecordingText, AnAxisThatTheConfigurationDoesNotHaveIsLeftOut) {
  const config::RobotConfig robot = test::testRobot();
  Recording recording;
  recording.triggers.resize(1);
  recording.axes = {record(drive::State::fault), record(drive::State::fault)};
  recording.axes[0].axis = 2;
  recording.axes[1].axis = 1;
  recording.notes = {{NoteRecord::Kind::step, 2, "whose", Time(1ms)}};
  std::ostringstream out;
  writeText(out, recording, robot, test::masterOf(robot), 0s);
  EXPECT_THAT(out.str(), HasSubstr("--  axis       elbow (2)         fault; "));
  EXPECT_THAT(out.str(), testing::Not(HasSubstr("axis       -")));
  EXPECT_THAT(out.str(), HasSubstr("--  step       -                 whose\n"));
}

TEST(RecordingTriggerText, NamesAxisAndErrorForPeopleAndFiles) {
  const config::RobotConfig robot = test::testRobot();
  RecordingTrigger trigger;
  EXPECT_EQ(triggerText(trigger, robot), "asked for");
  EXPECT_EQ(triggerName(trigger, robot), "requested");
  trigger.kind = RecordingTrigger::Kind::fault;
  trigger.axis = 1;
  EXPECT_EQ(triggerText(trigger, robot), "elbow (node 2): fault");
  trigger.code = 0x8611;
  EXPECT_EQ(triggerText(trigger, robot), "elbow (node 2): fault 0x8611 following error");
  EXPECT_EQ(triggerName(trigger, robot), "elbow_fault_8611");
  trigger.kind = RecordingTrigger::Kind::bus_off;
  EXPECT_EQ(triggerText(trigger, robot), "bus-off");
  EXPECT_EQ(triggerName(trigger, robot), "bus_off");
  trigger.kind = RecordingTrigger::Kind::node_lost;
  trigger.code = 0;
  EXPECT_EQ(triggerName(trigger, robot), "elbow_node_lost");
}

TEST(RecordingTriggerText, AnAxisThatTheConfigurationDoesNotHaveIsNotNamed) {
  const config::RobotConfig robot = test::testRobot();
  RecordingTrigger trigger;
  trigger.kind = RecordingTrigger::Kind::fault;
  trigger.axis = 2;
  EXPECT_EQ(triggerText(trigger, robot), "fault");
  EXPECT_EQ(triggerName(trigger, robot), "fault");
}

}  // namespace
}  // namespace cia402::bus
