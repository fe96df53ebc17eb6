// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// After a transfer was given up its answer may still come. It must never answer the next one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using Lines = std::vector<std::string>;
using Failure = SdoTransfer::Failure;

constexpr ObjectId kStatusword{0x6041, 0}, kTarget{0x607A, 0}, kName{0x1008, 0};
constexpr char kAskStatusword[] = "601 40 41 60 00 00 00 00 00";
constexpr char kAbortStatusword[] = "601 80 41 60 00 00 00 04 05";
constexpr char kAskDeviceType[] = "601 40 00 10 00 00 00 00 00";
constexpr char kDeviceType[] = "581 43 00 10 00 92 01 02 00";
constexpr char kAskIdentity[] = "601 40 18 10 00 00 00 00 00";
constexpr char kIdentity[] = "581 4F 18 10 00 04 00 00 00";

class SdoFenceTest : public test::SdoClientFixture {
 protected:
  static SdoOptions once() {
    SdoOptions result;
    result.timeout = milliseconds(50);
    result.retries = 0;
    return result;
  }
  /// A read of the statusword that nobody answered in time.
  void abandonStatusword() {
    const SdoTicket ticket = client.upload(kStatusword, "", once());
    client.tick(now);
    wait(50);
    ASSERT_EQ(ticket->failure(), Failure::timed_out);
    ASSERT_EQ(peer.take(), (Lines{kAskStatusword, kAbortStatusword}));
  }
};

TEST_F(SdoFenceTest, costs_nothing_while_answers_come) {
  peer.on(kAskStatusword, "581 4B 41 60 00 37 02 00 00");
  for (int i = 0; i < 3; ++i) client.upload(kStatusword);
  run();
  EXPECT_EQ(peer.take(), (Lines{kAskStatusword, kAskStatusword, kAskStatusword}));
  EXPECT_EQ(client.counters().fences, 0U);
}

TEST_F(SdoFenceTest, a_late_value_is_not_taken_for_the_answer_to_the_same_read) {
  abandonStatusword();
  const SdoTicket next = client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
  receive("581 4B 41 60 00 11 11 00 00");  // to the abandoned one
  EXPECT_FALSE(next->done());
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  EXPECT_FALSE(next->done());
  receive("581 4B 41 60 00 22 22 00 00");
  ASSERT_TRUE(next->ok());
  EXPECT_EQ(toUnsigned(next->data()), 0x2222U);
  EXPECT_EQ(client.counters().stray_frames, 1U);
  EXPECT_EQ(client.counters().fences, 1U);
}

TEST_F(SdoFenceTest, a_late_confirmation_does_not_confirm_another_value) {
  client.download(kTarget, {1, 0, 0, 0}, "", once());
  client.tick(now);
  wait(50);
  const SdoTicket next = client.download(kTarget, {2, 0, 0, 0});
  client.tick(now);
  receive("581 60 7A 60 00 00 00 00 00");
  EXPECT_FALSE(next->done());
  receive(kDeviceType);
  EXPECT_EQ(peer.take().back(), "601 23 7A 60 00 02 00 00 00");
  EXPECT_FALSE(next->done());
  receive("581 80 7A 60 00 30 00 09 06");
  EXPECT_EQ(next->failure(), Failure::aborted_by_server);
}

TEST_F(SdoFenceTest, a_late_abort_does_not_abort_the_next_transfer) {
  abandonStatusword();
  const SdoTicket next = client.upload(kStatusword);
  client.tick(now);
  receive("581 80 41 60 00 00 00 04 05");
  receive(kDeviceType);
  receive("581 4B 41 60 00 22 22 00 00");
  EXPECT_TRUE(next->ok()) << next->message();
}

TEST_F(SdoFenceTest, a_late_segment_with_the_right_toggle_bit_is_not_taken) {
  client.upload(kName, "", once());
  client.tick(now);
  receive("581 41 08 10 00 05 00 00 00");
  wait(50);
  peer.take();
  const SdoTicket next = client.upload(kName);
  client.tick(now);
  receive("581 05 6F 6C 64 65 72 00 00");  // "older", toggle 0, last
  receive(kDeviceType);
  receive("581 41 08 10 00 05 00 00 00");
  receive("581 05 6E 65 77 65 72 00 00");  // "newer"
  ASSERT_TRUE(next->ok()) << next->message();
  EXPECT_EQ(std::string(next->data().begin(), next->data().end()), "newer");
}

TEST_F(SdoFenceTest, a_retry_waits_for_the_past_to_pass_too) {
  const SdoTicket ticket = client.upload(kStatusword);
  client.tick(now);
  wait(500);
  EXPECT_EQ(peer.take(), (Lines{kAskStatusword, kAbortStatusword, kAskDeviceType}));
  receive("581 4B 41 60 00 11 11 00 00");
  EXPECT_FALSE(ticket->done());
  receive(kDeviceType);
  receive("581 4B 41 60 00 22 22 00 00");
  ASSERT_TRUE(ticket->ok());
  EXPECT_EQ(toUnsigned(ticket->data()), 0x2222U);
}

TEST_F(SdoFenceTest, reads_the_identity_where_the_device_type_was_abandoned) {
  client.upload({0x1000, 0}, "", once());
  client.tick(now);
  wait(50);
  peer.take();
  const SdoTicket next = client.upload({0x1000, 0});
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskIdentity});
  receive(kDeviceType);
  EXPECT_FALSE(next->done());
  receive("581 80 18 10 00 00 00 02 06");  // a device without identity answers, too
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
  receive(kDeviceType);
  EXPECT_TRUE(next->ok());
}

TEST_F(SdoFenceTest, a_silent_device_costs_each_transfer_no_more_than_its_own_time_outs) {
  abandonStatusword();
  SdoOptions twice = once();
  twice.retries = 1;
  const SdoTicket first = client.upload(kName, "device name", once());
  const SdoTicket second = client.upload(kStatusword, "statusword", twice);
  client.tick(now);
  wait(49);
  EXPECT_FALSE(first->done());
  wait(1);
  EXPECT_EQ(first->failure(), Failure::timed_out);
  EXPECT_EQ(first->message(),
            "node 1, object 1008:00 device name, read: no answer within 50 ms, the device has been "
            "silent since an earlier request");
  wait(50);
  wait(50);
  EXPECT_EQ(second->failure(), Failure::timed_out);
  EXPECT_EQ(second->message(),
            "node 1, object 6041:00 statusword, read: no answer within 50 ms, asked 2 times");
  // Each time with the abort again: that may have been lost.
  EXPECT_EQ(peer.take(), (Lines{kAskDeviceType, kAbortStatusword, kAskDeviceType, kAbortStatusword,
                                kAskDeviceType, kAbortStatusword}));
  EXPECT_TRUE(client.idle());
}

TEST_F(SdoFenceTest, goes_up_after_a_cancelled_transfer_too) {
  const SdoTicket cancelled = client.upload(kStatusword);
  client.tick(now);
  client.cancelAll("somebody stopped it");
  EXPECT_EQ(cancelled->failure(), Failure::cancelled);
  peer.take();
  const SdoTicket next = client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
  receive("581 4B 41 60 00 11 11 00 00");
  EXPECT_FALSE(next->done());
}

TEST_F(SdoFenceTest, stays_up_when_it_is_cancelled_itself) {
  abandonStatusword();
  client.upload(kName);
  client.tick(now);
  client.cancelAll("somebody stopped it");
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});  // nothing to abort
  client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
}

TEST_F(SdoFenceTest, goes_up_after_an_answer_that_broke_the_protocol) {
  const SdoTicket broken = client.upload(kName);
  client.tick(now);
  receive("581 41 08 10 00 0B 00 00 00");
  receive("581 10 53 65 72 76 6F 20 34");  // toggle bit set in the first segment
  EXPECT_EQ(broken->abortCode(), 0x05030000U);
  peer.take();
  client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
}

TEST_F(SdoFenceTest, is_not_needed_after_an_abort_by_the_server) {
  client.upload(kName);
  client.tick(now);
  receive("581 80 08 10 00 00 00 02 06");
  peer.take();
  client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
}

TEST_F(SdoFenceTest, is_not_needed_after_a_boot_up_message) {
  abandonStatusword();
  client.cancelAll("the node rebooted");
  client.serverRestarted();
  client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
}

TEST_F(SdoFenceTest, two_reads_follow_a_block_upload_whose_segments_can_look_like_anything) {
  SdoOptions block = once();
  block.block = SdoOptions::Block::always;
  client.upload(kName, "", block);
  client.tick(now);
  receive("581 C0 08 10 00 00 00 00 00");
  wait(50);
  peer.take();
  const SdoTicket next = client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskIdentity});
  receive("581 4F 18 10 00 41 42 43 44");  // segment 79 of the abandoned upload
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
  receive(kIdentity);
  EXPECT_TRUE(peer.take().empty());
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  receive("581 4B 41 60 00 22 22 00 00");
  EXPECT_TRUE(next->ok());
}

TEST_F(SdoFenceTest, one_repetition_of_a_segment_is_no_toggle_error_a_second_one_is) {
  const SdoTicket ticket = client.upload(kName);
  client.tick(now);
  receive("581 41 08 10 00 0B 00 00 00");
  receive("581 00 53 65 72 76 6F 20 34");
  receive("581 00 53 65 72 76 6F 20 34");
  EXPECT_FALSE(ticket->done());
  receive("581 00 53 65 72 76 6F 20 34");
  EXPECT_EQ(ticket->abortCode(), 0x05030000U);
}

SdoOptions ifThere() {
  SdoOptions result;
  result.timeout = milliseconds(50);
  result.retries = 1;
  result.silence_is_missing = true;
  return result;
}

TEST_F(SdoFenceTest, silence_for_one_object_alone_counts_as_missing_where_that_is_asked_for) {
  const SdoTicket ticket = client.upload(kStatusword, "", ifThere());
  client.tick(now);
  wait(50);
  EXPECT_EQ(peer.take(), (Lines{kAskStatusword, kAbortStatusword, kAskDeviceType}));
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{kAskStatusword});
  wait(50);
  ASSERT_TRUE(ticket->done());
  EXPECT_EQ(ticket->failure(), Failure::aborted_by_server);
  EXPECT_EQ(ticket->abortCode(), 0x06020000U);
  EXPECT_THAT(ticket->reason(), ::testing::HasSubstr("counts as missing"));
}

TEST_F(SdoFenceTest, silence_for_all_objects_is_a_time_out) {
  const SdoTicket ticket = client.upload(kStatusword, "", ifThere());
  client.tick(now);
  wait(50);
  wait(50);
  ASSERT_TRUE(ticket->done());
  EXPECT_EQ(ticket->failure(), Failure::timed_out);
}

TEST_F(SdoFenceTest, silence_is_a_time_out_where_nothing_else_is_asked_for) {
  SdoOptions must_be = ifThere();
  must_be.silence_is_missing = false;
  const SdoTicket ticket = client.upload(kStatusword, "", must_be);
  client.tick(now);
  wait(50);
  receive(kDeviceType);
  wait(50);
  ASSERT_TRUE(ticket->done());
  EXPECT_EQ(ticket->failure(), Failure::timed_out);
}

TEST_F(SdoFenceTest, one_question_is_too_few_to_call_an_object_missing) {
  SdoOptions single = ifThere();
  single.retries = 0;
  const SdoTicket ticket = client.upload(kStatusword, "", single);
  client.tick(now);
  wait(50);
  EXPECT_EQ(ticket->failure(), Failure::timed_out);
}

TEST_F(SdoFenceTest, goes_up_after_a_last_word_for_which_nobody_waits) {
  ASSERT_TRUE(client.post({0x6040, 0}, {2, 0}));
  EXPECT_EQ(peer.take(), Lines{"601 2B 40 60 00 02 00 00 00"});
  const SdoTicket next = client.download({0x6040, 0}, {6, 0});
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
  receive("581 60 40 60 00 00 00 00 00");  // to that word
  EXPECT_FALSE(next->done());
  receive(kDeviceType);
  EXPECT_EQ(peer.take(), Lines{"601 2B 40 60 00 06 00 00 00"});
}

TEST_F(SdoFenceTest, a_last_word_takes_no_read_away_that_an_abandoned_block_upload_needs) {
  SdoOptions block = once();
  block.block = SdoOptions::Block::always;
  client.upload(kName, "", block);
  client.tick(now);
  receive("581 C0 08 10 00 00 00 00 00");
  wait(50);
  ASSERT_TRUE(client.post({0x6040, 0}, {2, 0}));
  peer.take();
  client.upload(kStatusword);
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskIdentity});
  receive(kIdentity);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
}

TEST_F(SdoFenceTest, a_last_word_goes_out_in_front_of_the_first_answer_to_a_read) {
  const SdoTicket read = client.upload(kStatusword);
  client.tick(now);
  ASSERT_TRUE(client.post({0x6040, 0}, {2, 0}));
  EXPECT_EQ(peer.take(), (Lines{kAskStatusword, "601 2B 40 60 00 02 00 00 00"}));
  receive("581 4B 41 60 00 37 02 00 00");
  ASSERT_TRUE(read->ok()) << read->message();
  EXPECT_EQ(toUnsigned(read->data()), 0x237U);
  client.download({0x6040, 0}, {6, 0});
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType}) << "its answer is still to come";
}

TEST_F(SdoFenceTest, a_last_word_behind_the_read_of_the_fence_has_another_object_read) {
  abandonStatusword();
  const SdoTicket next = client.download({0x6040, 0}, {6, 0}, "", once());
  client.tick(now);
  EXPECT_EQ(peer.take(), Lines{kAskDeviceType});
  ASSERT_TRUE(client.post({0x6040, 0}, {2, 0}));
  EXPECT_EQ(peer.take(), (Lines{"601 2B 40 60 00 02 00 00 00", kAskIdentity}));
  receive(kDeviceType);
  receive("581 60 40 60 00 00 00 00 00");  // to that word
  EXPECT_TRUE(peer.take().empty());
  receive(kIdentity);
  EXPECT_EQ(peer.take(), Lines{"601 2B 40 60 00 06 00 00 00"});
  EXPECT_FALSE(next->done());
}

TEST_F(SdoFenceTest, a_last_word_has_the_fence_s_only_object_read_once_more) {
  client.upload({0x1000, 0}, "", once());
  client.tick(now);
  wait(50);
  client.download({0x6040, 0}, {6, 0}, "", once());
  client.tick(now);
  peer.take();
  ASSERT_TRUE(client.post({0x6040, 0}, {2, 0}));
  peer.take();
  receive(kIdentity);
  EXPECT_EQ(peer.take(), Lines{kAskIdentity});
  receive("581 60 40 60 00 00 00 00 00");  // to that word
  EXPECT_TRUE(peer.take().empty());
  receive(kIdentity);
  EXPECT_EQ(peer.take(), Lines{"601 2B 40 60 00 06 00 00 00"});
}

TEST_F(SdoFenceTest, a_last_word_has_one_to_four_bytes_and_no_transfer_in_its_way) {
  EXPECT_FALSE(client.post({0x6040, 0}, {}));
  EXPECT_FALSE(client.post({0x6040, 0}, {1, 2, 3, 4, 5}));
  client.upload(kName);
  client.tick(now);
  receive("581 41 08 10 00 05 00 00 00");  // five bytes, in segments
  peer.take();
  EXPECT_FALSE(client.post({0x6040, 0}, {2, 0}));
  EXPECT_TRUE(peer.take().empty());
  client.cancelAll("it is lost");
  EXPECT_TRUE(client.post({0x2000, 1}, {1, 2, 3, 4}));
  EXPECT_EQ(peer.take().back(), "601 23 00 20 01 01 02 03 04");
}

}  // namespace
}  // namespace cia402::canopen
