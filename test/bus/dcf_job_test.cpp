// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/dcf_job.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "bus/dcf_world.h"

namespace cia402::bus {
namespace {

using fieldbus::ObjectId;
using test::Bytes;
using testing::AllOf;
using testing::HasSubstr;

struct DcfJobTest : test::DcfWorld {
  Answer read() {
    return world.call(DcfDraft(world.axis(0).config(), world.device(0), stamp()).command());
  }
};

TEST_F(DcfJobTest, HandsBackWhatItReadAndLeavesTheWordsToTheCaller) {
  const SaveDcfCommand command =
      DcfDraft(world.axis(0).config(), world.device(0), stamp()).command();
  const Answer answer = world.call(command);
  EXPECT_TRUE(answer.success);
  const auto& items = command.reading->items;
  ASSERT_EQ(items.size(), 4u);
  EXPECT_EQ(items[0].outcome, DcfReading::Outcome::read);
  EXPECT_EQ(items[0].data, (Bytes{0x34, 0x12}));
  EXPECT_EQ(items[2].outcome, DcfReading::Outcome::refused);
  EXPECT_THAT(items[2].problem, HasSubstr("0x06020000"));
  EXPECT_EQ(command.reading->bitrate, 1e6);
  EXPECT_EQ(command.reading.use_count(), 1) << "the bus thread frees nothing";
}

// The same EDS says what may be written.
TEST_F(DcfJobTest, WhatTheEdsDoesNotAllowIsNotWrittenEither) {
  const auto write = [&](const char* object, const char* value) {
    return world.call(WriteObjectCommand{"shoulder", object, value});
  };
  const Answer written = write("2001:00 u16", "7");
  EXPECT_TRUE(written.success) << written.message;
  world.drives[0].written.clear();
  const Answer refused = write("2005:00 text", "M8");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("shoulder (node 1): 2005:00"),
                                     HasSubstr("not written: "), HasSubstr("motor.eds")));
  EXPECT_TRUE(world.drives[0].written.empty());
}

TEST_F(DcfJobTest, NothingIsWrittenToTheDrive) {
  world.drives[0].written.clear();
  read();
  EXPECT_TRUE(world.drives[0].written.empty());
}

TEST_F(DcfJobTest, ASilentDriveEndsItSoon) {
  world.drives[0].sdo_silent = true;
  const Answer answer = read();
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message,
              AllOf(HasSubstr("shoulder (node 1): no DCF: node 1, object 2004:00 Not there"),
                    HasSubstr("no answer within 100 ms")));
}

TEST_F(DcfJobTest, TwoTransfersInARowMayGoUnanswered) {
  std::string text;
  for (const char last : {'0', '1', '2', '3', '4', '5'}) {
    text += std::string("[300") + last + "]\nParameterName=x\nDataType=6\nAccessType=ro\n";
    world.drives[0].objects[ObjectId{static_cast<std::uint16_t>(0x3000 + last - '0'), 0}] = {1, 0};
  }
  drive::AxisConfig config = world.axis(0).config();
  const config::RobotConfig robot = test::robotWithEds(text);
  config.description = robot.axes[0].description;
  const SaveDcfCommand command = DcfDraft(config, robot.devices[0], stamp()).command();
  const auto count = [&](DcfReading::Outcome outcome) {
    const auto& items = command.reading->items;
    return std::count_if(items.begin(), items.end(),
                         [&](const auto& item) { return item.outcome == outcome; });
  };
  const auto answers = world.begin(command);
  ASSERT_TRUE(world.runUntil([&] { return count(DcfReading::Outcome::read) > 0; }));
  world.drives[0].sdo_silent = true;
  ASSERT_TRUE(world.runUntil([&] { return count(DcfReading::Outcome::refused) > 0; }));
  world.run(std::chrono::milliseconds(50));  // half of the time of the next transfer
  world.drives[0].sdo_silent = false;
  ASSERT_TRUE(world.runUntil([&] { return !answers->empty(); }));
  EXPECT_TRUE(answers->front().success) << answers->front().message;
  EXPECT_EQ(count(DcfReading::Outcome::refused), 2);
  EXPECT_EQ(count(DcfReading::Outcome::read), 4);
}

TEST_F(DcfJobTest, TheReadingIsTheCallersAloneFromTheReplyOn) {
  const SaveDcfCommand save = DcfDraft(world.axis(0).config(), world.device(0), stamp()).command();
  long owners = 0;
  world.network.execute(Command(save, [&](const Answer&) { owners = save.reading.use_count(); }),
                        world.now);
  ASSERT_TRUE(world.runUntil([&] { return owners != 0; }));
  EXPECT_EQ(owners, 1);
}

TEST_F(DcfJobTest, AnUnknownAxisIsRefused) {
  SaveDcfCommand command = DcfDraft(world.axis(0).config(), world.device(0), stamp()).command();
  command.axis = "nobody";
  EXPECT_EQ(world.call(command).message, "there is no axis \"nobody\"");
}

}  // namespace
}  // namespace cia402::bus
