// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Block upload by the bytes of CiA 301, 7.2.4.3.12 to 7.2.4.3.15. CRCs were computed by Python's
// binascii.crc_hqx, which gives 0x31C3 for "123456789".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using Lines = std::vector<std::string>;
using Failure = SdoTransfer::Failure;

constexpr ObjectId kName{0x1008, 0};
constexpr char kInitiate[] = "601 A4 08 10 00 7F 1C 00 00";  // CRC, 127 segments, threshold 28
constexpr char kStart[] = "601 A3 00 00 00 00 00 00 00";
constexpr char kSized[] = "581 C6 08 10 00 0B 00 00 00";  // CRC, 11 bytes
constexpr char kSegment1[] = "581 01 53 65 72 76 6F 20 34";
constexpr char kSegment2[] = "581 82 30 32 2D 58 00 00 00";  // the last one
constexpr char kAcknowledge2[] = "601 A2 02 7F 00 00 00 00 00";
constexpr char kEnd[] = "581 CD 76 18 00 00 00 00 00";  // three bytes unused, CRC 0x1876
constexpr char kEndTaken[] = "601 A1 00 00 00 00 00 00 00";

class SdoBlockUploadTest : public test::SdoClientFixture {
 protected:
  SdoTicket start(const char* initiated = nullptr, std::size_t longest = 1000) {
    SdoOptions block = options();
    block.block = SdoOptions::Block::always;
    block.longest_upload = longest;
    SdoTicket ticket = client.upload(kName, "device name", block);
    client.tick(now);
    EXPECT_EQ(peer.take(), Lines{kInitiate});
    if (initiated != nullptr) receive(initiated);
    return ticket;
  }
  void expectName(const SdoTicket& ticket) {
    ASSERT_TRUE(ticket->ok()) << ticket->message();
    EXPECT_EQ(std::string(ticket->data().begin(), ticket->data().end()), "Servo 402-X");
  }
  void expectAbort(const SdoTicket& ticket, std::uint32_t code, const char* line) {
    EXPECT_EQ(ticket->failure(), Failure::protocol_error) << ticket->message();
    EXPECT_EQ(ticket->abortCode(), code);
    EXPECT_EQ(peer.take().back(), line);
  }
};

TEST_F(SdoBlockUploadTest, takes_segments_acknowledges_them_together_and_checks_the_crc) {
  const SdoTicket ticket = start(kSized);
  EXPECT_EQ(peer.take(), Lines{kStart});
  receive(kSegment1);
  EXPECT_EQ(peer.take(), Lines{});
  receive(kSegment2);
  EXPECT_EQ(peer.take(), Lines{kAcknowledge2});
  EXPECT_FALSE(ticket->done());
  receive(kEnd);
  EXPECT_EQ(peer.take(), Lines{kEndTaken});
  expectName(ticket);
  EXPECT_EQ(client.counters().bytes, 11U);
}

TEST_F(SdoBlockUploadTest, works_without_crc_and_without_size) {
  const SdoTicket ticket = start("581 C0 08 10 00 00 00 00 00");
  receive(kSegment1);
  receive(kSegment2);
  receive("581 CD 00 00 00 00 00 00 00");
  expectName(ticket);
}

TEST_F(SdoBlockUploadTest, takes_an_ordinary_answer_where_the_server_switches) {
  const SdoTicket in_segments = start("581 41 08 10 00 05 00 00 00");
  EXPECT_EQ(peer.take(), Lines{"601 60 00 00 00 00 00 00 00"});
  receive("581 05 53 65 72 76 6F 00 00");
  EXPECT_TRUE(in_segments->ok());
  const SdoTicket expedited = start("581 4F 08 10 00 41 00 00 00");
  EXPECT_EQ(expedited->data(), Bytes{0x41});
}

TEST_F(SdoBlockUploadTest, asks_again_from_the_first_lost_segment_on) {
  const SdoTicket ticket = start(kSized);
  peer.take();
  receive(kSegment2);  // the first one was lost
  EXPECT_EQ(peer.take(), Lines{"601 A2 00 7F 00 00 00 00 00"});
  receive(kSegment1);
  receive(kSegment2);
  EXPECT_EQ(peer.take(), Lines{kAcknowledge2});
  receive(kEnd);
  expectName(ticket);
  EXPECT_EQ(client.counters().retries, 1U);
}

TEST_F(SdoBlockUploadTest, asks_again_when_the_end_of_a_sub_block_was_lost) {
  const SdoTicket ticket = start(kSized);
  receive(kSegment1);
  peer.take();
  wait(500);
  EXPECT_EQ(peer.take(), Lines{"601 A2 01 7F 00 00 00 00 00"});
  receive("581 81 30 32 2D 58 00 00 00");  // a new sub-block of one segment
  EXPECT_EQ(peer.take(), Lines{"601 A2 01 7F 00 00 00 00 00"});
  receive(kEnd);
  expectName(ticket);
}

TEST_F(SdoBlockUploadTest, repeats_its_own_word_when_that_may_have_been_lost) {
  const SdoTicket ticket = start(kSized);
  peer.take();
  wait(500);
  EXPECT_EQ(peer.take(), Lines{kStart});
  receive(kSegment1);
  receive(kSegment2);
  peer.take();
  wait(500);
  EXPECT_EQ(peer.take(), Lines{kAcknowledge2});
  receive(kEnd);
  expectName(ticket);
  EXPECT_EQ(client.counters().retries, 2U);
}

TEST_F(SdoBlockUploadTest, begins_anew_when_that_does_not_help) {
  const SdoTicket ticket = start(kSized);
  receive(kSegment1);
  wait(500);
  peer.take();
  wait(500);
  EXPECT_EQ(peer.take(), (Lines{"601 80 08 10 00 00 00 04 05", "601 40 18 10 00 00 00 00 00"}));
  receive("581 4F 18 10 00 04 00 00 00");
  receive("581 43 00 10 00 92 01 02 00");
  EXPECT_EQ(peer.take().back(), kInitiate);
  receive(kSized);
  receive(kSegment1);
  receive(kSegment2);
  receive(kEnd);
  expectName(ticket);
}

TEST_F(SdoBlockUploadTest, trusts_no_repetition_where_neither_crc_nor_size_could_prove_it) {
  const SdoTicket ticket = start("581 C0 08 10 00 00 00 00 00");
  receive(kSegment2);
  expectAbort(ticket, 0x05040003, "601 80 08 10 00 03 00 04 05");
}

TEST_F(SdoBlockUploadTest, aborts_on_a_wrong_crc) {
  const SdoTicket ticket = start(kSized);
  receive(kSegment1);
  receive(kSegment2);
  receive("581 CD 77 18 00 00 00 00 00");
  expectAbort(ticket, 0x05040004, "601 80 08 10 00 04 00 04 05");
}

TEST_F(SdoBlockUploadTest, aborts_on_another_size_than_announced) {
  const SdoTicket less = start("581 C2 08 10 00 0C 00 00 00");
  receive(kSegment1);
  receive(kSegment2);
  receive("581 CD 00 00 00 00 00 00 00");
  EXPECT_THAT(less->message(), HasSubstr("11 bytes came, 12 were announced"));
  expectAbort(less, 0x06070010, "601 80 08 10 00 10 00 07 06");
  client.serverRestarted();
  const SdoTicket more = start("581 C6 08 10 00 07 00 00 00");
  receive(kSegment1);
  receive(kSegment2);
  expectAbort(more, 0x06070010, "601 80 08 10 00 10 00 07 06");
}

TEST_F(SdoBlockUploadTest, refuses_more_than_allowed_announced_or_not) {
  const SdoTicket announced = start("581 C6 08 10 00 FF FF FF FF");
  EXPECT_THAT(announced->message(), HasSubstr("4294967295 bytes are more than the 1000 allowed"));
  expectAbort(announced, 0x05040005, "601 80 08 10 00 05 00 04 05");
  client.serverRestarted();
  const SdoTicket silent = start("581 C4 08 10 00 00 00 00 00", 7);
  receive(kSegment1);
  EXPECT_FALSE(silent->done());
  receive(kSegment2);
  expectAbort(silent, 0x05040005, "601 80 08 10 00 05 00 04 05");
}

TEST_F(SdoBlockUploadTest, aborts_on_segment_number_zero) {
  const SdoTicket ticket = start(kSized);
  receive("581 00 53 65 72 76 6F 20 34");
  expectAbort(ticket, 0x05040003, "601 80 08 10 00 03 00 04 05");
}

TEST_F(SdoBlockUploadTest, ignores_frames_that_come_twice) {
  const SdoTicket ticket = start(kSized);
  receive(kSized);  // looks like segment 70, the last one
  receive(kSegment1);
  receive(kSegment1);
  receive(kSegment2);
  receive(kSegment2);
  EXPECT_EQ(peer.take(), (Lines{kStart, kAcknowledge2}));
  receive(kEnd);
  receive(kEnd);
  expectName(ticket);
  EXPECT_EQ(client.counters().stray_frames, 4U);
}

TEST_F(SdoBlockUploadTest, does_not_take_a_repeated_last_segment_for_the_end) {
  // 65 segments; the last one is 0xC1, as an end with no byte unused is.
  const SdoTicket ticket = start("581 C0 08 10 00 00 00 00 00");
  for (int i = 1; i <= 64; ++i) {
    char line[40];
    std::snprintf(line, sizeof line, "581 %02X 01 01 01 01 01 01 01", static_cast<unsigned>(i));
    receive(line);
  }
  receive("581 C1 02 02 00 00 00 00 00");
  receive("581 C1 02 02 00 00 00 00 00");
  EXPECT_FALSE(ticket->done());
  receive("581 D5 00 00 00 00 00 00 00");  // five bytes unused
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(ticket->data().size(), 64U * 7U + 2U);
}

TEST_F(SdoBlockUploadTest, goes_in_segments_from_a_server_that_refuses_blocks_and_remembers) {
  const SdoTicket first = start("581 80 08 10 00 01 00 04 05");
  EXPECT_EQ(peer.take(), Lines{"601 40 08 10 00 00 00 00 00"});
  receive("581 4F 08 10 00 41 00 00 00");
  EXPECT_EQ(first->data(), Bytes{0x41});
  SdoOptions block = options();
  block.block = SdoOptions::Block::always;
  client.upload(kName, "", block);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{"601 40 08 10 00 00 00 00 00"});
}

TEST_F(SdoBlockUploadTest, takes_an_abort_between_segments) {
  const SdoTicket ticket = start(kSized);
  receive(kSegment1);
  receive("581 80 08 10 00 00 00 00 08");
  EXPECT_EQ(ticket->failure(), Failure::aborted_by_server);
  EXPECT_EQ(ticket->abortCode(), 0x08000000U);
}

TEST_F(SdoBlockUploadTest, takes_an_empty_object) {
  const SdoTicket ticket = start("581 C6 08 10 00 00 00 00 00");
  receive("581 81 00 00 00 00 00 00 00");
  receive("581 DD 00 00 00 00 00 00 00");
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_TRUE(ticket->data().empty());
}

TEST_F(SdoBlockUploadTest, goes_on_over_several_sub_blocks) {
  const SdoTicket ticket = start("581 C2 08 10 00 7C 03 00 00");  // 892 = 127 * 7 + 3 bytes
  for (unsigned i = 1; i <= 127; ++i) {
    char line[40];
    std::snprintf(line, sizeof line, "581 %02X 01 01 01 01 01 01 01", i);
    receive(line);
  }
  EXPECT_EQ(peer.take(), (Lines{kStart, "601 A2 7F 7F 00 00 00 00 00"}));
  receive("581 81 02 03 04 00 00 00 00");
  EXPECT_EQ(peer.take(), Lines{"601 A2 01 7F 00 00 00 00 00"});
  receive("581 D1 00 00 00 00 00 00 00");  // four bytes unused
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(ticket->data().size(), 892U);
  EXPECT_EQ(ticket->data().back(), 4);
}

TEST_F(SdoBlockUploadTest, takes_no_notice_of_a_segment_of_before) {
  const SdoTicket ticket = start("581 C2 08 10 00 11 00 00 00");  // 17 bytes, no CRC
  receive("581 01 01 02 03 04 05 06 07");
  receive("581 02 08 09 0A 0B 0C 0D 0E");
  receive("581 01 01 02 03 04 05 06 07");
  receive("581 83 0F 10 11 00 00 00 00");
  EXPECT_EQ(peer.take(), (Lines{kStart, "601 A2 03 7F 00 00 00 00 00"}));
  receive("581 D1 00 00 00 00 00 00 00");
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(client.counters().retries, 0U);
  EXPECT_EQ(client.counters().stray_frames, 1U);
}

TEST_F(SdoBlockUploadTest, a_crc_proves_a_repetition_once_it_has_seen_more_than_zeros) {
  const SdoTicket proved = start("581 C4 08 10 00 00 00 00 00");  // CRC, no size
  receive("581 01 01 02 03 04 05 06 07");
  receive("581 02 08 09 0A 0B 0C 0D 0E");
  receive("581 84 16 17 18 00 00 00 00");  // the third was lost
  EXPECT_EQ(peer.take(), (Lines{kStart, "601 A2 02 7F 00 00 00 00 00"}));
  EXPECT_FALSE(proved->done());
  client.cancelAll("enough");
  client.serverRestarted();
  peer.take();
  const SdoTicket zeros = start("581 C4 08 10 00 00 00 00 00");
  receive("581 01 00 00 00 00 00 00 00");
  receive("581 02 00 00 00 00 00 00 00");
  receive("581 84 16 17 18 00 00 00 00");
  expectAbort(zeros, 0x05040003, "601 80 08 10 00 03 00 04 05");
}

TEST_F(SdoBlockUploadTest, waits_the_whole_time_out_for_what_follows_an_acknowledge) {
  start(kSized);
  receive(kSegment1);
  now += milliseconds(400);
  receive(kSegment2);
  EXPECT_EQ(client.nextDeadline(), now + milliseconds(500));
}

TEST_F(SdoBlockUploadTest, each_segment_and_each_repetition_gets_the_whole_time_out) {
  start(kSized);
  wait(500);
  EXPECT_EQ(peer.take().back(), kStart);
  EXPECT_EQ(client.nextDeadline(), now + milliseconds(500));
  now += milliseconds(400);
  receive(kSegment1);
  EXPECT_EQ(client.nextDeadline(), now + milliseconds(500));
}

TEST_F(SdoBlockUploadTest, after_a_gap_and_a_silence_it_goes_on_without_a_gap) {
  const SdoTicket ticket = start("581 C2 08 10 00 18 00 00 00");  // 24 bytes
  receive("581 01 01 02 03 04 05 06 07");
  receive("581 03 0F 10 11 12 13 14 15");  // the second was lost, and so is what follows
  peer.take();
  wait(500);
  EXPECT_EQ(peer.take(), Lines{"601 A2 01 7F 00 00 00 00 00"});
  receive("581 01 08 09 0A 0B 0C 0D 0E");
  receive("581 02 0F 10 11 12 13 14 15");
  receive("581 83 16 17 18 00 00 00 00");
  EXPECT_EQ(peer.take(), Lines{"601 A2 03 7F 00 00 00 00 00"});
  receive("581 D1 00 00 00 00 00 00 00");  // four bytes unused
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(ticket->data()[i], i + 1);
}

}  // namespace
}  // namespace cia402::canopen
