// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Block download by the bytes of CiA 301, 7.2.4.3.8 to 7.2.4.3.11. CRCs were computed by Python's
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

constexpr ObjectId kProgram{0x1F50, 1};
constexpr char kInitiate[] = "601 C6 50 1F 01 14 00 00 00";  // CRC, size 20
constexpr char kSegment1[] = "601 01 01 02 03 04 05 06 07";
constexpr char kSegment2[] = "601 02 08 09 0A 0B 0C 0D 0E";
constexpr char kSegment3[] = "601 83 0F 10 11 12 13 14 00";  // the last one
constexpr char kEnd[] = "601 C5 D3 EA 00 00 00 00 00";       // one byte unused, CRC 0xEAD3
constexpr char kEnded[] = "581 A1 00 00 00 00 00 00 00";

class SdoBlockDownloadTest : public test::SdoClientFixture {
 protected:
  static Bytes count(std::size_t size) {
    Bytes data(size);
    for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i + 1);
    return data;
  }
  static SdoOptions block() {
    SdoOptions result = options();
    result.block = SdoOptions::Block::always;
    return result;
  }
  SdoTicket start(std::size_t size = 20) {
    SdoTicket ticket = client.download(kProgram, count(size), "program", block());
    client.tick(now);
    return ticket;
  }
  void expectAbort(const SdoTicket& ticket, std::uint32_t code, const char* line) {
    EXPECT_EQ(ticket->failure(), Failure::protocol_error);
    EXPECT_EQ(ticket->abortCode(), code);
    EXPECT_EQ(peer.take().back(), line);
  }
};

TEST_F(SdoBlockDownloadTest, sends_all_segments_at_once_and_ends_with_the_crc) {
  const SdoTicket ticket = start();
  EXPECT_EQ(peer.take(), Lines{kInitiate});
  receive("581 A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(peer.take(), (Lines{kSegment1, kSegment2, kSegment3}));
  receive("581 A2 03 7F 00 00 00 00 00");
  EXPECT_EQ(peer.take(), Lines{kEnd});
  EXPECT_FALSE(ticket->done());
  receive(kEnded);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(client.counters().completed, 1U);
  EXPECT_EQ(client.counters().bytes, 20U);
  EXPECT_EQ(client.counters().retries, 0U);
}

TEST_F(SdoBlockDownloadTest, computes_the_crc_of_the_standard) {
  // CiA 301, 7.2.4.3.16: "123456789" gives 0x31C3.
  const Bytes text{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  client.download(kProgram, text, "", block());
  client.tick(now);
  receive("581 A4 50 1F 01 7F 00 00 00");
  receive("581 A2 02 7F 00 00 00 00 00");
  EXPECT_EQ(peer.take().back(), "601 D5 C3 31 00 00 00 00 00");  // five bytes unused
}

TEST_F(SdoBlockDownloadTest, sends_no_crc_to_a_server_that_computes_none) {
  const SdoTicket ticket = start();
  receive("581 A0 50 1F 01 7F 00 00 00");
  receive("581 A2 03 7F 00 00 00 00 00");
  EXPECT_EQ(peer.take().back(), "601 C5 00 00 00 00 00 00 00");
  receive(kEnded);
  EXPECT_TRUE(ticket->ok());
}

TEST_F(SdoBlockDownloadTest, leaves_no_byte_unused_where_the_last_segment_is_full) {
  start(14);
  receive("581 A4 50 1F 01 7F 00 00 00");
  receive("581 A2 02 7F 00 00 00 00 00");
  EXPECT_EQ(peer.take(), (Lines{"601 C6 50 1F 01 0E 00 00 00", "601 01 01 02 03 04 05 06 07",
                                "601 82 08 09 0A 0B 0C 0D 0E", "601 C1 92 9B 00 00 00 00 00"}));
}

TEST_F(SdoBlockDownloadTest, follows_the_sizes_that_the_server_asks_for) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 01 00 00 00");
  EXPECT_EQ(peer.take(), (Lines{kInitiate, kSegment1}));
  receive("581 A2 01 02 00 00 00 00 00");
  EXPECT_EQ(peer.take(), (Lines{"601 01 08 09 0A 0B 0C 0D 0E", "601 82 0F 10 11 12 13 14 00"}));
  receive("581 A2 02 05 00 00 00 00 00");
  EXPECT_EQ(peer.take(), Lines{kEnd});
  receive(kEnded);
  EXPECT_TRUE(ticket->ok());
}

TEST_F(SdoBlockDownloadTest, repeats_from_the_first_lost_segment_on) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 7F 00 00 00");
  peer.take();
  receive("581 A2 01 7F 00 00 00 00 00");  // the second segment was lost
  EXPECT_EQ(peer.take(), (Lines{"601 01 08 09 0A 0B 0C 0D 0E", "601 82 0F 10 11 12 13 14 00"}));
  receive("581 A2 00 7F 00 00 00 00 00");  // and once more
  EXPECT_EQ(peer.take(), (Lines{"601 01 08 09 0A 0B 0C 0D 0E", "601 82 0F 10 11 12 13 14 00"}));
  receive("581 A2 02 7F 00 00 00 00 00");
  EXPECT_EQ(peer.take(), Lines{kEnd});
  receive(kEnded);
  EXPECT_TRUE(ticket->ok());
  EXPECT_EQ(client.counters().retries, 2U);
}

TEST_F(SdoBlockDownloadTest, gives_up_on_a_server_that_never_takes_a_segment) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 7F 00 00 00");
  for (int i = 0; i < 11; ++i) {
    ASSERT_FALSE(ticket->done()) << i;
    receive("581 A2 00 7F 00 00 00 00 00");
  }
  expectAbort(ticket, 0x05040003, "601 80 50 1F 01 03 00 04 05");
}

TEST_F(SdoBlockDownloadTest, aborts_on_sub_blocks_of_no_or_too_many_segments) {
  const SdoTicket none = start();
  receive("581 A4 50 1F 01 00 00 00 00");
  expectAbort(none, 0x05040002, "601 80 50 1F 01 02 00 04 05");
  client.serverRestarted();
  const SdoTicket many = start();
  receive("581 A4 50 1F 01 80 00 00 00");
  expectAbort(many, 0x05040002, "601 80 50 1F 01 02 00 04 05");
  client.serverRestarted();
  const SdoTicket later = start();
  receive("581 A4 50 1F 01 01 00 00 00");
  receive("581 A2 01 80 00 00 00 00 00");
  expectAbort(later, 0x05040002, "601 80 50 1F 01 02 00 04 05");
}

TEST_F(SdoBlockDownloadTest, aborts_on_an_acknowledge_of_what_was_not_sent) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 7F 00 00 00");
  receive("581 A2 04 7F 00 00 00 00 00");
  expectAbort(ticket, 0x05040003, "601 80 50 1F 01 03 00 04 05");
}

TEST_F(SdoBlockDownloadTest, tells_the_crc_error_that_the_server_found) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 7F 00 00 00");
  receive("581 A2 03 7F 00 00 00 00 00");
  receive("581 80 50 1F 01 04 00 04 05");
  EXPECT_EQ(ticket->failure(), Failure::aborted_by_server);
  EXPECT_EQ(ticket->abortCode(), 0x05040004U);
  EXPECT_THAT(ticket->message(), HasSubstr("object 1F50:01 program, write 01 02"));
  EXPECT_THAT(ticket->message(), HasSubstr("0x05040004 (CRC error)"));
}

TEST_F(SdoBlockDownloadTest, asks_from_the_start_when_an_acknowledge_does_not_come) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 7F 00 00 00");
  peer.take();
  wait(500);
  EXPECT_EQ(peer.take(), (Lines{"601 80 50 1F 01 00 00 04 05", "601 40 00 10 00 00 00 00 00"}));
  receive("581 A2 03 7F 00 00 00 00 00");  // late
  receive("581 43 00 10 00 92 01 02 00");
  EXPECT_EQ(peer.take(), Lines{kInitiate});
  wait(500);
  wait(500);
  EXPECT_EQ(ticket->failure(), Failure::timed_out);
  EXPECT_EQ(ticket->abortCode(), 0x05040000U);
}

TEST_F(SdoBlockDownloadTest, goes_in_segments_to_a_server_that_refuses_blocks_and_remembers) {
  peer.on(kInitiate, "581 80 50 1F 01 01 00 04 05")
      .on("601 21 50 1F 01 14 00 00 00", "581 60 50 1F 01 00 00 00 00")
      .on("601 00 01 02 03 04 05 06 07", "581 20 00 00 00 00 00 00 00")
      .on("601 10 08 09 0A 0B 0C 0D 0E", "581 30 00 00 00 00 00 00 00")
      .on("601 03 0F 10 11 12 13 14 00", "581 20 00 00 00 00 00 00 00");
  const SdoTicket first = client.download(kProgram, count(20), "", block());
  const SdoTicket second = client.download(kProgram, count(20), "", block());
  run();
  EXPECT_TRUE(first->ok()) << first->message();
  EXPECT_TRUE(second->ok()) << second->message();
  const Lines sent = peer.take();
  ASSERT_EQ(sent.size(), 9U);
  EXPECT_EQ(sent[0], kInitiate);
  EXPECT_EQ(sent[5], "601 21 50 1F 01 14 00 00 00");
  client.serverRestarted();  // with other firmware, perhaps
  client.download(kProgram, count(20), "", block());
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kInitiate});
}

TEST_F(SdoBlockDownloadTest, tries_segments_after_every_abort_that_does_not_speak_of_the_object) {
  for (const char* code : {"01 00 04 05", "02 00 04 05", "00 00 04 05", "00 00 01 06",
                           "23 00 0A 06", "00 00 00 08", "00 00 00 00"}) {
    const SdoTicket ticket = start();
    receive(std::string("581 80 50 1F 01 ") + code);
    EXPECT_FALSE(ticket->done()) << code;
    EXPECT_EQ(peer.take().back(), "601 21 50 1F 01 14 00 00 00") << code;
    receive("581 80 50 1F 01 02 00 01 06");
    EXPECT_EQ(ticket->abortCode(), 0x06010002U);
    client.serverRestarted();
  }
  for (const char* code :
       {"02 00 01 06", "00 00 02 06", "12 00 07 06", "22 00 00 08", "05 00 04 05"}) {
    const SdoTicket ticket = start();
    receive(std::string("581 80 50 1F 01 ") + code);
    EXPECT_EQ(ticket->failure(), Failure::aborted_by_server) << code;
    EXPECT_EQ(peer.take(), Lines{kInitiate}) << code;
  }
}

TEST_F(SdoBlockDownloadTest, tries_segments_on_a_server_that_does_not_answer_to_blocks) {
  const SdoTicket ticket = start();
  wait(500);
  receive("581 43 00 10 00 92 01 02 00");  // it is there
  EXPECT_EQ(peer.take().back(), "601 21 50 1F 01 14 00 00 00");
  EXPECT_FALSE(ticket->done());
  receive("581 60 50 1F 01 00 00 00 00");
  receive("581 20 00 00 00 00 00 00 00");
  receive("581 30 00 00 00 00 00 00 00");
  receive("581 20 00 00 00 00 00 00 00");
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  peer.take();
  start();
  EXPECT_EQ(peer.take(), Lines{"601 21 50 1F 01 14 00 00 00"}) << "remembered";
}

TEST_F(SdoBlockDownloadTest, happens_by_itself_above_the_threshold_only) {
  client.download(kProgram, count(256));
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{"601 21 50 1F 01 00 01 00 00"});
  receive("581 80 50 1F 01 02 00 01 06");
  client.download(kProgram, count(257));
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{"601 C6 50 1F 01 01 01 00 00"});
  receive("581 80 50 1F 01 02 00 01 06");
  SdoOptions never = options();
  never.block = SdoOptions::Block::never;
  client.download(kProgram, count(257), "", never);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{"601 21 50 1F 01 01 01 00 00"});
}

TEST_F(SdoBlockDownloadTest, ignores_answers_that_come_twice) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 01 00 00 00");
  receive("581 A4 50 1F 01 01 00 00 00");
  receive("581 A2 01 02 00 00 00 00 00");
  receive("581 A2 02 05 00 00 00 00 00");
  receive("581 A2 02 05 00 00 00 00 00");
  EXPECT_EQ(peer.take().back(), kEnd);
  receive(kEnded);
  receive(kEnded);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(client.counters().stray_frames, 3U);
}

TEST_F(SdoBlockDownloadTest, begins_with_the_answer_to_its_own_request_only) {
  const SdoTicket ticket = start();
  peer.take();
  receive("581 A4 51 1F 01 7F 00 00 00");  // another object
  receive("581 A1 50 1F 01 7F 00 00 00");  // the end of a block transfer
  EXPECT_TRUE(peer.take().empty());
  EXPECT_EQ(client.counters().stray_frames, 2U);
  receive("581 A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(peer.take().size(), 3U);
  receive("581 A2 03 7F 00 00 00 00 00");
  receive("581 A2 03 7F 00 00 00 00 00");
  EXPECT_FALSE(ticket->done()) << "the acknowledge came twice, the end is still to come";
  receive(kEnded);
  EXPECT_TRUE(ticket->ok()) << ticket->message();
}

TEST_F(SdoBlockDownloadTest, one_follows_another_with_a_crc_of_its_own) {
  for (int i = 0; i < 2; ++i) {
    const SdoTicket ticket = start();
    receive("581 A4 50 1F 01 7F 00 00 00");
    receive("581 A2 03 7F 00 00 00 00 00");
    EXPECT_EQ(peer.take(), (Lines{kInitiate, kSegment1, kSegment2, kSegment3, kEnd})) << i;
    receive(kEnded);
    EXPECT_TRUE(ticket->ok()) << ticket->message();
  }
}

TEST_F(SdoBlockDownloadTest, a_segment_that_is_taken_gives_the_server_all_its_tries_again) {
  const SdoTicket ticket = start();
  receive("581 A4 50 1F 01 7F 00 00 00");
  for (int i = 0; i < 10; ++i) receive("581 A2 00 7F 00 00 00 00 00");
  receive("581 A2 01 7F 00 00 00 00 00");
  for (int i = 0; i < 10; ++i) receive("581 A2 00 7F 00 00 00 00 00");
  EXPECT_FALSE(ticket->done()) << ticket->message();
  receive("581 A2 00 7F 00 00 00 00 00");
  expectAbort(ticket, 0x05040003, "601 80 50 1F 01 03 00 04 05");
}

// 0x05040001, the command is not known, is said of blocks; 0x08000000 may be said of anything.
TEST_F(SdoBlockDownloadTest, remembers_a_server_that_does_not_know_blocks_whatever_follows) {
  const auto nextBegins = [&](const char* refusal) {
    client.serverRestarted();
    start();
    receive(std::string("581 80 50 1F 01 ") + refusal);
    receive("581 80 50 1F 01 02 00 01 06");  // not in segments either
    peer.take();
    start();
    const Lines sent = peer.take();
    receive("581 80 50 1F 01 02 00 01 06");
    return sent;
  };
  EXPECT_EQ(nextBegins("01 00 04 05"), Lines{"601 21 50 1F 01 14 00 00 00"});
  EXPECT_EQ(nextBegins("00 00 00 08"), Lines{kInitiate});
}

}  // namespace
}  // namespace cia402::canopen
