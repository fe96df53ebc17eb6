// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A stop by SDO waits for no other transfer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using Lines = std::vector<std::string>;
using Failure = SdoTransfer::Failure;

constexpr ObjectId kControlword{0x6040, 0}, kStatusword{0x6041, 0}, kName{0x1008, 0};
constexpr char kStop[] = "601 2B 40 60 00 02 00 00 00";
constexpr char kStopped[] = "581 60 40 60 00 00 00 00 00";
constexpr char kAskStatusword[] = "601 40 41 60 00 00 00 00 00";
constexpr char kAskDeviceType[] = "601 40 00 10 00 00 00 00 00";
constexpr char kDeviceType[] = "581 43 00 10 00 92 01 02 00";

class SdoUrgentTest : public test::SdoClientFixture {
 protected:
  SdoTicket stop() {
    SdoTicket ticket = client.downloadUrgent(kControlword, {2, 0}, "controlword");
    EXPECT_LE(client.nextDeadline(), now) << "it is due at once";
    client.tick(now);
    return ticket;
  }
};

TEST_F(SdoUrgentTest, leaves_at_once_where_nothing_is_on_the_wire) {
  const SdoTicket ticket = stop();
  EXPECT_EQ(peer.take(), Lines{kStop});
  receive(kStopped);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(client.counters().fences, 0U);
}

TEST_F(SdoUrgentTest, goes_before_what_is_queued_and_is_not_held) {
  client.holdUntil(now + milliseconds(100));
  const SdoTicket queued = client.upload(kStatusword);
  client.tick(now);
  EXPECT_TRUE(peer.take().empty());
  stop();
  EXPECT_EQ(peer.take(), Lines{kStop});
  receive(kStopped);
  EXPECT_TRUE(peer.take().empty()) << "the others are held as before";
  wait(100);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  receive("581 4B 41 60 00 37 02 00 00");
  EXPECT_TRUE(queued->ok());
}

TEST_F(SdoUrgentTest, a_segmented_upload_makes_way) {
  const SdoTicket upload = client.upload(kName, "device name");
  const SdoTicket queued = client.upload(kStatusword);
  client.tick(now);
  receive("581 41 08 10 00 00 00 01 00");  // 65536 bytes follow
  peer.take();
  const SdoTicket ticket = stop();
  EXPECT_EQ(upload->failure(), Failure::cancelled);
  EXPECT_EQ(upload->message(),
            "node 1, object 1008:00 device name, read: cancelled: it made way for an urgent write "
            "to 6040:00 controlword");
  EXPECT_EQ(peer.take(), (Lines{"601 80 08 10 00 00 00 00 08", kAskDeviceType}));
  receive("581 00 53 65 72 76 6F 20 34");  // the segment that was asked for
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kStop});
  receive(kStopped);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(peer.take(), Lines{kAskStatusword}) << "what was queued follows";
  EXPECT_FALSE(queued->done());
}

TEST_F(SdoUrgentTest, a_block_download_makes_way) {
  SdoOptions block = options();
  block.block = SdoOptions::Block::always;
  const SdoTicket download = client.download({0x1F50, 1}, Bytes(20, 7), "program", block);
  client.tick(now);
  receive("581 A4 50 1F 01 02 00 00 00");  // two segments at a time, of three
  EXPECT_EQ(peer.take().back(), "601 02 07 07 07 07 07 07 07");
  const SdoTicket ticket = stop();
  EXPECT_EQ(download->failure(), Failure::cancelled);
  EXPECT_EQ(peer.take(), (Lines{"601 80 50 1F 01 00 00 00 08", kAskDeviceType}));
  receive("581 A2 02 02 00 00 00 00 00");  // the acknowledgement was on its way
  EXPECT_TRUE(peer.take().empty());
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kStop});
  receive(kStopped);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_TRUE(client.idle());
}

TEST_F(SdoUrgentTest, the_late_answer_to_an_expedited_write_of_the_same_object_confirms_nothing) {
  const SdoTicket enable = client.download(kControlword, {0x0F, 0}, "controlword");
  client.tick(now);
  peer.take();
  const SdoTicket ticket = stop();
  EXPECT_EQ(enable->failure(), Failure::cancelled);
  EXPECT_EQ(peer.take(), (Lines{"601 80 40 60 00 00 00 00 08", kAskDeviceType}));
  receive(kStopped);  // to the abandoned one
  EXPECT_FALSE(ticket->done());
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kStop});
  EXPECT_FALSE(ticket->done());
  receive("581 80 40 60 00 22 00 00 08");
  EXPECT_EQ(ticket->failure(), Failure::aborted_by_server);
}

TEST_F(SdoUrgentTest, a_transfer_that_waits_for_the_past_to_pass_goes_on_waiting) {
  SdoOptions once = options();
  once.retries = 0;
  client.upload(kStatusword, "", once);
  client.tick(now);
  wait(500);
  const SdoTicket name = client.upload(kName);
  client.tick(now);
  peer.take();
  const SdoTicket ticket = client.downloadUrgent(kControlword, {2, 0}, "controlword");
  client.tick(now);
  EXPECT_TRUE(peer.take().empty()) << "the question is on its way already";
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kStop});
  EXPECT_FALSE(name->done());
  receive(kStopped);
  EXPECT_TRUE(ticket->ok());
  EXPECT_EQ(peer.take(), Lines{"601 40 08 10 00 00 00 00 00"});
}

// 6060h that has two bytes in this drive; what is posted waits for nothing either.
TEST_F(SdoUrgentTest, is_as_long_as_the_drive_has_the_object) {
  client.widths().add({{0x6060, 0}, 1, 2, true});
  client.downloadUrgent({0x6060, 0}, {0x09}, "mode");
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{"601 2B 60 60 00 09 00 00 00"});
  receive("581 60 60 60 00 00 00 00 00");
  EXPECT_TRUE(client.post({0x6060, 0}, {0xFE}));
  EXPECT_EQ(peer.take(), Lines{"601 2B 60 60 00 FE FF 00 00"});
}

TEST_F(SdoUrgentTest, two_are_done_one_after_the_other) {
  const SdoTicket first = stop();
  const SdoTicket queued = client.upload(kStatusword);
  const SdoTicket second = client.downloadUrgent(kControlword, {0, 0}, "controlword");
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kStop});
  receive(kStopped);
  EXPECT_TRUE(first->ok());
  EXPECT_EQ(peer.take(), Lines{"601 2B 40 60 00 00 00 00 00"});
  receive(kStopped);
  EXPECT_TRUE(second->ok());
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  EXPECT_FALSE(queued->done());
}

TEST_F(SdoUrgentTest, has_all_its_tries_where_it_takes_over_the_question_of_another) {
  client.upload(kStatusword);
  client.tick(now);
  wait(500);  // asked again, behind a read of the device type
  EXPECT_EQ(peer.take().back(), kAskDeviceType);
  const SdoTicket ticket = client.downloadUrgent(kControlword, {2, 0}, "controlword");
  wait(500);
  EXPECT_FALSE(ticket->done()) << ticket->message();
  EXPECT_EQ(peer.take().back(), kAskDeviceType);
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kStop});
  receive(kStopped);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
}

TEST_F(SdoUrgentTest, tells_nothing_of_whether_the_server_takes_blocks) {
  SdoOptions block = options();
  block.block = SdoOptions::Block::always;
  const char kInitiate[] = "601 C6 50 1F 01 14 00 00 00";
  client.download({0x1F50, 1}, Bytes(20, 7), "program", block);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kInitiate});
  wait(500);  // no answer: that may be for the blocks
  client.downloadUrgent(kControlword, {2, 0}, "controlword");
  receive(kDeviceType);
  peer.take();
  receive(kStopped);
  EXPECT_EQ(peer.take(), Lines{kInitiate});
}

TEST_F(SdoUrgentTest, is_told_by_its_name_where_it_is_refused) {
  const SdoTicket ticket = stop();
  receive("581 80 40 60 00 22 00 00 08");
  EXPECT_THAT(ticket->message(),
              ::testing::HasSubstr("object 6040:00 controlword, write 02 00: the drive refused"));
}

}  // namespace
}  // namespace cia402::canopen
