// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/history_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using fieldbus::ObjectId;
using test::RobotWorld;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

struct HistoryJobTest : testing::Test {
  HistoryJobTest() { world.boot(); }
  void remember(std::uint8_t place, std::uint16_t code, std::uint16_t info) {
    world.drives[0].objects[ObjectId{0x1003, 0}] = {place};
    world.drives[0].objects[ObjectId{0x1003, place}] = {
        static_cast<std::uint8_t>(code & 0xFF), static_cast<std::uint8_t>(code >> 8),
        static_cast<std::uint8_t>(info & 0xFF), static_cast<std::uint8_t>(info >> 8)};
  }
  HistoryAnswer read(const std::string& axis = "shoulder") {
    return world.call(ErrorHistoryCommand{axis});
  }
  RobotWorld world;
};

TEST_F(HistoryJobTest, AnswersWithTheTextsOfTheProfileAndOfTheStandard) {
  remember(1, 0x8611, 0x1234);
  remember(2, 0x3210, 0);
  const HistoryAnswer answer = read();
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message,
            "shoulder (node 1): error history (1003h): 0x8611 following error (info 0x1234), "
            "0x3210 DC link overvoltage");
  ASSERT_EQ(answer.history.entries.size(), 2u);
  EXPECT_EQ(answer.history.entries[1].code, 0x3210);
}

TEST_F(HistoryJobTest, TellsAnEmptyHistoryFromOneThatDoesNotExist) {
  world.drives[0].aborts[ObjectId{0x1003, 0}] = 0x06020000;
  EXPECT_FALSE(read().success);
  EXPECT_THAT(read().message,
              HasSubstr("the drive keeps no error history: 1003:00 does not exist"));
  world.drives[0].aborts.clear();
  world.drives[0].objects[ObjectId{0x1003, 0}] = {0};
  EXPECT_TRUE(read().success);
  EXPECT_EQ(read().message, "shoulder (node 1): error history (1003h): empty");
  EXPECT_EQ(read("hand").message, "there is no axis \"hand\"");
}

TEST_F(HistoryJobTest, IsReadOnceWhenAnAxisFaultsAndShownInTheSnapshot) {
  for (std::uint8_t place = 1; place <= 6; ++place) remember(place, 0x8611, place);
  world.drives[0].fault(0x8611);
  world.run(200ms);
  EXPECT_EQ(world.eventsWith("error history (1003h), newest first: 0x8611 following error (info "
                             "0x0001)"),
            1u)
      << world.allEvents();
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  EXPECT_THAT(snapshot.axes[0].words.history.str(), HasSubstr("(info 0x0004) and 2 older"));
  EXPECT_THAT(snapshot.axes[0].words.history.str(), Not(HasSubstr("0x0005")));
  EXPECT_TRUE(snapshot.axes[1].words.history.empty());
  world.run(10s);
  EXPECT_EQ(world.eventsWith("newest first"), 1u);
}

TEST_F(HistoryJobTest, IsReadOfASecondFaultToo) {
  remember(1, 0x8611, 0);
  world.drives[0].fault(0x8611);
  world.run(200ms);
  ASSERT_TRUE(world.call(drive::ProcedureKind::clear_faults, "shoulder").success);
  remember(1, 0x3210, 0);
  world.drives[0].fault(0x3210);
  world.run(1s);
  EXPECT_EQ(world.eventsWith("newest first"), 1u) << "not in quick succession";
  world.run(5s);
  EXPECT_EQ(world.eventsWith("newest first: 0x3210 DC link overvoltage"), 1u);
}

TEST_F(HistoryJobTest, DoesNotHoldTheCycleUp) {
  remember(1, 0x8611, 0);
  world.drives[0].sdo_silent = true;
  const auto answer = world.begin(ErrorHistoryCommand{"shoulder"});
  const std::size_t before = world.sentWithId(0x080).size();
  world.run(80ms);
  EXPECT_EQ(world.sentWithId(0x080).size() - before, 20u);
  EXPECT_TRUE(answer->empty());
  EXPECT_THAT(world.wait(answer).message, HasSubstr("1003:00 not read"));
}

TEST_F(HistoryJobTest, IsNotToldOfADriveThatKeepsNone) {
  world.drives[0].aborts[ObjectId{0x1003, 0}] = 0x06020000;
  world.drives[0].fault(0x8611);
  world.run(500ms);
  EXPECT_EQ(world.eventsWith("error history"), 0u) << world.allEvents();
  NetworkSnapshot snapshot;
  world.network.fill(snapshot);
  EXPECT_THAT(snapshot.axes[0].words.history.str(), HasSubstr("the drive keeps no error history"));
}

}  // namespace
}  // namespace cia402::bus
