// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using Lines = std::vector<std::string>;
using Failure = SdoTransfer::Failure;

constexpr ObjectId kStatusword{0x6041, 0}, kMode{0x6060, 0}, kName{0x1008, 0};
constexpr char kAskStatusword[] = "601 40 41 60 00 00 00 00 00";
constexpr char kAskDeviceType[] = "601 40 00 10 00 00 00 00 00";
constexpr char kDeviceType[] = "581 43 00 10 00 92 01 02 00";
constexpr char kAskName[] = "601 40 08 10 00 00 00 00 00";
constexpr char kSegment0[] = "601 60 00 00 00 00 00 00 00";
constexpr char kSegment1[] = "601 70 00 00 00 00 00 00 00";

class SdoClientTest : public test::SdoClientFixture {};

TEST_F(SdoClientTest, reads_a_16_bit_object_expedited) {
  peer.on(kAskStatusword, "581 4B 41 60 00 37 02 00 00");
  const SdoTicket ticket = client.upload(kStatusword);
  EXPECT_FALSE(ticket->done());
  run();
  EXPECT_TRUE(ticket->ok());
  EXPECT_EQ(ticket->data(), (Bytes{0x37, 0x02}));
  EXPECT_EQ(toUnsigned(ticket->data()), 0x0237U);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  EXPECT_TRUE(client.idle());
  EXPECT_EQ(client.nextDeadline(), kNever);
  EXPECT_EQ(client.counters().completed, 1U);
}

TEST_F(SdoClientTest, reads_expedited_answers_of_every_size) {
  const struct {
    const char* answer;
    Bytes data;
  } cases[] = {{"581 4F 41 60 00 08 AA BB CC", {0x08}},
               {"581 4B 41 60 00 01 02 AA BB", {0x01, 0x02}},
               {"581 47 41 60 00 01 02 03 AA", {0x01, 0x02, 0x03}},
               {"581 43 41 60 00 01 02 03 04", {0x01, 0x02, 0x03, 0x04}},
               {"581 42 41 60 00 01 02 03 04", {0x01, 0x02, 0x03, 0x04}}};  // size not indicated
  for (const auto& one : cases) {
    const SdoTicket ticket = client.upload(kStatusword);
    client.tick(now);
    receive(one.answer);
    ASSERT_TRUE(ticket->ok()) << one.answer;
    EXPECT_EQ(ticket->data(), one.data) << one.answer;
  }
}

TEST_F(SdoClientTest, writes_one_to_four_bytes_expedited) {
  client.download({0x1019, 0}, {0x00});
  client.tick(now);
  receive("581 60 19 10 00 00 00 00 00");
  client.download(kMode, {0x02, 0x00});
  client.tick(now);
  receive("581 60 60 60 00 00 00 00 00");
  client.download({0x2000, 5}, {1, 2, 3});
  client.tick(now);
  receive("581 60 00 20 05 00 00 00 00");
  // 607A = -pi as float32, a vector of the Damiao fact sheet
  const SdoTicket last = client.download({0x607A, 0}, {0xDB, 0x0F, 0x49, 0xC0});
  client.tick(now);
  receive("581 60 7A 60 00 00 00 00 00");
  EXPECT_TRUE(last->ok());
  EXPECT_EQ(peer.take(), (Lines{"601 2F 19 10 00 00 00 00 00", "601 2B 60 60 00 02 00 00 00",
                                "601 27 00 20 05 01 02 03 00", "601 23 7A 60 00 DB 0F 49 C0"}));
  EXPECT_EQ(client.counters().completed, 4U);
}

TEST_F(SdoClientTest, reads_segments_with_alternating_toggle_bit) {
  // "Servo 402-X" is 11 bytes: one full segment, one with 4 bytes (n = 3).
  peer.on(kAskName, "581 41 08 10 00 0B 00 00 00")
      .on(kSegment0, "581 00 53 65 72 76 6F 20 34")
      .on(kSegment1, "581 17 30 32 2D 58 00 00 00");
  const SdoTicket ticket = client.upload(kName);
  run();
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(std::string(ticket->data().begin(), ticket->data().end()), "Servo 402-X");
  EXPECT_EQ(peer.take(), (Lines{kAskName, kSegment0, kSegment1}));
}

TEST_F(SdoClientTest, reads_segments_when_the_server_announces_no_size) {
  peer.on(kAskName, "581 40 08 10 00 00 00 00 00").on(kSegment0, "581 0D 41 00 00 00 00 00 00");
  const SdoTicket ticket = client.upload(kName);
  run();
  ASSERT_TRUE(ticket->ok());
  EXPECT_EQ(ticket->data(), Bytes{0x41});
}

TEST_F(SdoClientTest, writes_segments_of_seven_bytes) {
  // 8 bytes: a full segment, then one byte (n = 6, c = 1).
  peer.on("601 21 00 20 01 08 00 00 00", "581 60 00 20 01 00 00 00 00")
      .on("601 00 01 02 03 04 05 06 07", "581 20 00 00 00 00 00 00 00")
      .on("601 1D 08 00 00 00 00 00 00", "581 30 00 00 00 00 00 00 00");
  const SdoTicket ticket = client.download({0x2000, 1}, {1, 2, 3, 4, 5, 6, 7, 8});
  run();
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(ticket->data(), (Bytes{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(SdoClientTest, writes_five_and_seven_bytes_in_one_segment_and_none_in_an_empty_one) {
  peer.on("601 21 00 20 01 05 00 00 00", "581 60 00 20 01 00 00 00 00")
      .on("601 05 01 02 03 04 05 00 00", "581 20 00 00 00 00 00 00 00")
      .on("601 21 00 20 01 07 00 00 00", "581 60 00 20 01 00 00 00 00")
      .on("601 01 01 02 03 04 05 06 07", "581 20 00 00 00 00 00 00 00")
      .on("601 21 00 20 01 00 00 00 00", "581 60 00 20 01 00 00 00 00")
      .on("601 0F 00 00 00 00 00 00 00", "581 20 00 00 00 00 00 00 00");
  const SdoTicket five = client.download({0x2000, 1}, {1, 2, 3, 4, 5});
  const SdoTicket seven = client.download({0x2000, 1}, {1, 2, 3, 4, 5, 6, 7});
  const SdoTicket none = client.download({0x2000, 1}, {});
  run();
  EXPECT_TRUE(five->ok()) << five->message();
  EXPECT_TRUE(seven->ok()) << seven->message();
  EXPECT_TRUE(none->ok()) << none->message();
}

TEST_F(SdoClientTest, tells_an_abort_in_words_and_does_not_retry_it) {
  peer.on("601 2F 60 60 00 08 00 00 00", "581 80 60 60 00 30 00 09 06");
  const SdoTicket ticket = client.download(kMode, {0x08}, "mode_of_operation");
  run();
  EXPECT_TRUE(ticket->done());
  EXPECT_FALSE(ticket->ok());
  EXPECT_EQ(ticket->failure(), Failure::aborted_by_server);
  EXPECT_EQ(ticket->abortCode(), 0x06090030U);
  EXPECT_EQ(ticket->message(),
            "node 1, object 6060:00 mode_of_operation, write 08: the drive refused: 0x06090030 "
            "(invalid value for parameter)");
  wait(10000);
  EXPECT_EQ(peer.take().size(), 1U);
  EXPECT_EQ(client.counters().aborted, 1U);
}

TEST_F(SdoClientTest, takes_an_abort_in_the_middle_of_segments) {
  peer.on(kAskName, "581 41 08 10 00 0B 00 00 00").on(kSegment0, "581 80 08 10 00 00 00 00 08");
  const SdoTicket ticket = client.upload(kName);
  run();
  EXPECT_EQ(ticket->failure(), Failure::aborted_by_server);
  EXPECT_EQ(ticket->abortCode(), 0x08000000U);
}

TEST_F(SdoClientTest, ignores_and_counts_answers_for_another_object) {
  const SdoTicket ticket = client.upload(kStatusword);
  client.tick(now);
  receive("581 4B 42 60 00 11 11 00 00");  // other index
  receive("581 4B 41 60 01 22 22 00 00");  // other sub-index
  receive("581 80 40 60 00 00 00 02 06");  // abort for another object
  receive("581 60 41 60 00 00 00 00 00");  // answer to a write of the same object
  receive("581 00 01 02 03 04 05 06 07");  // a segment nobody asked for
  receive("582 4B 41 60 00 33 33 00 00");  // another node
  receive("581 4B 41 60");                 // cut off
  EXPECT_FALSE(ticket->done());
  EXPECT_EQ(client.counters().stray_frames, 7U);
  receive("581 4B 41 60 00 37 02 00 00");
  ASSERT_TRUE(ticket->ok());
  EXPECT_EQ(toUnsigned(ticket->data()), 0x0237U);
}

TEST_F(SdoClientTest, counts_answers_to_nothing) {
  receive("581 4B 41 60 00 37 02 00 00");
  EXPECT_EQ(client.counters().stray_frames, 1U);
  EXPECT_TRUE(peer.take().empty());
}

TEST_F(SdoClientTest, aborts_when_the_toggle_bit_of_an_upload_does_not_alternate) {
  peer.on(kAskName, "581 41 08 10 00 0B 00 00 00")
      .on(kSegment0, "581 00 53 65 72 76 6F 20 34")
      .on(kSegment1, "581 07 30 32 2D 58 00 00 00");
  const SdoTicket ticket = client.upload(kName);
  run();
  EXPECT_EQ(ticket->failure(), Failure::protocol_error);
  EXPECT_EQ(ticket->abortCode(), 0x05030000U);
  EXPECT_EQ(peer.take().back(), "601 80 08 10 00 00 00 03 05");
}

TEST_F(SdoClientTest, aborts_when_the_toggle_bit_of_a_download_does_not_alternate) {
  peer.on("601 21 00 20 01 08 00 00 00", "581 60 00 20 01 00 00 00 00")
      .on("601 00 01 02 03 04 05 06 07", "581 30 00 00 00 00 00 00 00");
  const SdoTicket ticket = client.download({0x2000, 1}, {1, 2, 3, 4, 5, 6, 7, 8});
  run();
  EXPECT_EQ(ticket->failure(), Failure::protocol_error);
  EXPECT_EQ(peer.take().back(), "601 80 00 20 01 00 00 03 05");
}

TEST_F(SdoClientTest, aborts_an_upload_that_brings_more_than_announced) {
  peer.on(kAskName, "581 41 08 10 00 05 00 00 00").on(kSegment0, "581 01 01 02 03 04 05 06 07");
  const SdoTicket ticket = client.upload(kName);
  run();
  EXPECT_EQ(ticket->failure(), Failure::protocol_error);
  EXPECT_EQ(ticket->abortCode(), 0x06070012U);
  EXPECT_EQ(peer.take().back(), "601 80 08 10 00 12 00 07 06");
}

TEST_F(SdoClientTest, aborts_an_upload_that_ends_before_all_announced_bytes_came) {
  peer.on(kAskName, "581 41 08 10 00 08 00 00 00").on(kSegment0, "581 01 01 02 03 04 05 06 07");
  const SdoTicket ticket = client.upload(kName);
  run();
  EXPECT_EQ(ticket->abortCode(), 0x06070013U);
  EXPECT_THAT(ticket->message(), HasSubstr("7 bytes came, 8 were announced"));
  EXPECT_EQ(peer.take().back(), "601 80 08 10 00 13 00 07 06");
}

TEST_F(SdoClientTest, refuses_an_announced_size_that_would_eat_the_memory) {
  peer.on(kAskName, "581 41 08 10 00 FF FF FF FF");
  const SdoTicket ticket = client.upload(kName);
  run();
  EXPECT_EQ(ticket->abortCode(), 0x05040005U);
  EXPECT_EQ(peer.take().back(), "601 80 08 10 00 05 00 04 05");
}

TEST_F(SdoClientTest, aborts_on_a_command_specifier_that_does_not_exist) {
  peer.on(kAskStatusword, "581 E0 41 60 00 00 00 00 00");
  const SdoTicket ticket = client.upload(kStatusword);
  run();
  EXPECT_EQ(ticket->failure(), Failure::protocol_error);
  EXPECT_EQ(peer.take().back(), "601 80 41 60 00 01 00 04 05");
}

TEST_F(SdoClientTest, after_a_time_out_aborts_asks_again_and_gives_up) {
  const SdoTicket ticket = client.upload(kStatusword, "statusword");
  client.tick(now);
  EXPECT_EQ(client.nextDeadline(), now + milliseconds(500));
  wait(499);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  wait(1);
  EXPECT_EQ(peer.take(), (Lines{"601 80 41 60 00 00 00 04 05", kAskDeviceType}));
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  EXPECT_FALSE(ticket->done());
  wait(500);
  EXPECT_EQ(peer.take(), Lines{"601 80 41 60 00 00 00 04 05"});
  EXPECT_EQ(ticket->failure(), Failure::timed_out);
  EXPECT_EQ(ticket->message(),
            "node 1, object 6041:00 statusword, read: no answer within 500 ms, asked 2 times");
  EXPECT_EQ(client.counters().timeouts, 2U);
  EXPECT_EQ(client.counters().retries, 1U);
  EXPECT_EQ(client.counters().aborted, 0U);
}

TEST_F(SdoClientTest, a_retried_transfer_starts_from_the_beginning_and_can_succeed) {
  const SdoTicket ticket = client.download({0x2000, 1}, {1, 2, 3, 4, 5, 6, 7, 8});
  client.tick(now);
  receive("581 60 00 20 01 00 00 00 00");
  receive("581 20 00 00 00 00 00 00 00");  // the second segment's answer never comes
  peer.take();
  peer.on(kAskDeviceType, kDeviceType)
      .on("601 21 00 20 01 08 00 00 00", "581 60 00 20 01 00 00 00 00")
      .on("601 00 01 02 03 04 05 06 07", "581 20 00 00 00 00 00 00 00")
      .on("601 1D 08 00 00 00 00 00 00", "581 30 00 00 00 00 00 00 00");
  wait(500);
  run();
  EXPECT_TRUE(ticket->ok()) << ticket->message();
  EXPECT_EQ(client.counters().retries, 1U);
}

TEST_F(SdoClientTest, each_answer_gets_the_whole_time_out) {
  peer.on(kAskName, "581 41 08 10 00 0B 00 00 00");
  client.upload(kName);
  run();
  now += milliseconds(400);
  receive("581 00 53 65 72 76 6F 20 34");
  EXPECT_EQ(client.nextDeadline(), now + milliseconds(500));
}

TEST_F(SdoClientTest, counts_the_last_the_longest_and_the_mean_latency_of_answers) {
  const auto read = [&](int ms) {
    const SdoTicket ticket = client.upload({0x1000, 0}, "device type");
    client.tick(now);
    wait(ms);
    receive("581 43 00 10 00 92 01 02 00");
    ASSERT_TRUE(ticket->ok());
    EXPECT_EQ(client.counters().last_latency, std::chrono::milliseconds(ms));
  };
  read(10);
  EXPECT_EQ(client.counters().longest_latency, std::chrono::milliseconds(10));
  read(40);
  read(25);
  EXPECT_EQ(client.counters().longest_latency, std::chrono::milliseconds(40));
  EXPECT_EQ(client.counters().total_latency, std::chrono::milliseconds(75));
  EXPECT_EQ(client.counters().meanLatency(), std::chrono::milliseconds(25));
}

TEST_F(SdoClientTest, has_one_transfer_on_the_wire_and_starts_the_next_with_the_answer) {
  const SdoTicket first = client.upload(kStatusword);
  const SdoTicket second = client.upload(kMode);
  EXPECT_LE(client.nextDeadline(), now);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  client.tick(now);
  EXPECT_TRUE(peer.take().empty());
  receive("581 4B 41 60 00 37 02 00 00");
  EXPECT_TRUE(first->ok());
  EXPECT_EQ(peer.take(), Lines{"601 40 60 60 00 00 00 00 00"});
  EXPECT_FALSE(second->done());
}

TEST_F(SdoClientTest, cancels_running_and_queued_transfers_with_a_reason) {
  const SdoTicket running = client.upload(kStatusword);
  const SdoTicket queued = client.upload(kMode);
  client.tick(now);
  peer.take();
  client.cancelAll("the node rebooted");
  for (const SdoTicket& ticket : {running, queued}) {
    EXPECT_EQ(ticket->failure(), Failure::cancelled);
    EXPECT_EQ(ticket->abortCode(), 0U) << "nobody aborted it";
  }
  EXPECT_THAT(queued->message(), HasSubstr("cancelled: the node rebooted"));
  EXPECT_TRUE(client.idle());
  EXPECT_EQ(peer.take(), Lines{"601 80 41 60 00 00 00 00 08"});
  receive("581 4B 41 60 00 37 02 00 00");
  EXPECT_EQ(client.counters().stray_frames, 1U);
}

TEST_F(SdoClientTest, survives_a_dropped_ticket) {
  peer.on(kAskStatusword, "581 4B 41 60 00 37 02 00 00");
  client.upload(kStatusword);
  run();
  EXPECT_EQ(client.counters().completed, 1U);
}

TEST_F(SdoClientTest, an_unknown_command_specifier_for_another_object_is_none_of_its_business) {
  const SdoTicket ticket = client.upload(kStatusword);
  client.tick(now);
  receive("581 E0 42 60 00 00 00 00 00");
  EXPECT_FALSE(ticket->done());
  EXPECT_EQ(client.counters().stray_frames, 1U);
  receive("581 4B 41 60 00 37 02 00 00");
  EXPECT_TRUE(ticket->ok());
}

TEST_F(SdoClientTest, has_nothing_to_say_of_a_transfer_that_went_well) {
  peer.on(kAskStatusword, "581 4B 41 60 00 37 02 00 00");
  const SdoTicket ticket = client.upload(kStatusword, "statusword");
  run();
  ASSERT_TRUE(ticket->ok());
  EXPECT_EQ(ticket->message(), "");
  EXPECT_EQ(ticket->reason(), "");
  EXPECT_EQ(ticket->abortCode(), 0U);
}

TEST_F(SdoClientTest, shows_the_first_eight_bytes_of_what_could_not_be_written) {
  const SdoTicket eight = client.download({0x2000, 1}, {1, 2, 3, 4, 5, 6, 7, 8});
  client.tick(now);
  receive("581 80 00 20 01 02 00 01 06");
  EXPECT_THAT(eight->message(), HasSubstr("write 01 02 03 04 05 06 07 08: the drive refused"));
  const SdoTicket nine = client.download({0x2000, 1}, {1, 2, 3, 4, 5, 6, 7, 8, 9});
  client.tick(now);
  receive("581 80 00 20 01 02 00 01 06");
  EXPECT_THAT(nine->message(),
              HasSubstr("write 01 02 03 04 05 06 07 08 ... (9 bytes): the drive refused"));
}

TEST(SdoBytes, are_little_endian) {
  EXPECT_EQ(toBytes(0x12345678, 4), (Bytes{0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(toBytes(0x12345678, 2), (Bytes{0x78, 0x56}));
  EXPECT_EQ(toBytes(0x0102030405060708, 8), (Bytes{8, 7, 6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(toUnsigned({0x78, 0x56, 0x34, 0x12}), 0x12345678U);
  EXPECT_EQ(toUnsigned({8, 7, 6, 5, 4, 3, 2, 1}), 0x0102030405060708U);
  EXPECT_EQ(toUnsigned({}), 0U);
}

}  // namespace
}  // namespace cia402::canopen
