// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/dcf_job.h"

#include <gmock/gmock.h>

#include "bus/dcf_world.h"

namespace cia402::bus {
namespace {

using canopen::ObjectId;
using test::Bytes;
using testing::AllOf;
using testing::HasSubstr;

struct DcfJobTest : test::DcfWorld {
  Answer read() { return world.call(DcfDraft(world.axis(0).config(), stamp()).command()); }
};

TEST_F(DcfJobTest, HandsBackWhatItReadAndLeavesTheWordsToTheCaller) {
  const SaveDcfCommand command = DcfDraft(world.axis(0).config(), stamp()).command();
  const Answer answer = world.call(command);
  EXPECT_TRUE(answer.success);
  EXPECT_TRUE(answer.text.empty());
  const auto& items = command.reading->items;
  ASSERT_EQ(items.size(), 4u);
  EXPECT_EQ(items[0].outcome, DcfReading::Outcome::read);
  EXPECT_EQ(items[0].data, (Bytes{0x34, 0x12}));
  EXPECT_EQ(items[2].outcome, DcfReading::Outcome::refused);
  EXPECT_THAT(items[2].problem, HasSubstr("0x06020000"));
  EXPECT_EQ(command.reading->bitrate, 1e6);
  EXPECT_EQ(command.reading.use_count(), 1) << "the bus thread frees nothing";
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

TEST_F(DcfJobTest, AnUnknownAxisIsRefused) {
  SaveDcfCommand command = DcfDraft(world.axis(0).config(), stamp()).command();
  command.axis = "nobody";
  EXPECT_EQ(world.call(command).message, "there is no axis \"nobody\"");
}

}  // namespace
}  // namespace cia402::bus
