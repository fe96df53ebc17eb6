// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/boot/retry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::kAskDeviceType;
using test::kAskVendor;
using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const char kAskIdentityCount[] = "603 40 18 10 00 00 00 00 00";

class BootRetryTest : public test::NodeFixture {
 protected:
  std::ptrdiff_t asked(const char* line) {
    const Lines sent = peer.take();
    return std::count(sent.begin(), sent.end(), line);
  }
};

TEST_F(BootRetryTest, a_time_out_is_tried_again_after_the_delay_and_given_up_in_words) {
  peer.forget(kAskVendor);
  boot();
  pass(seconds(1));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(asked(kAskVendor), 2);
  pass(milliseconds(999));
  EXPECT_EQ(asked(kAskVendor), 0);
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::booting);
  EXPECT_EQ(node->bootStep(), "attempt 2 of 3: reading 1018:01 vendor id");
  EXPECT_EQ(peer.take()[0], "000 80 03");
  pass(seconds(1));
  EXPECT_THAT(node->problem(), HasSubstr("; it is tried again in 1 s (attempt 3 of 3)"));
  pass(seconds(2));
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("asked 2 times; given up after 3 attempts"));
  peer.take();
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty());
  EXPECT_EQ(node->nextDeadline(), kNever);
}

TEST_F(BootRetryTest, a_second_attempt_may_succeed) {
  peer.forget(kAskVendor);
  boot();
  pass(seconds(1));
  peer.on(kAskVendor, "583 43 18 10 01 CD AB 00 00");
  pass(seconds(1));
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_EQ(node->problem(), "");
  EXPECT_EQ(node->bootStep(), "ready");
}

TEST_F(BootRetryTest, what_a_person_asks_for_begins_to_count_anew) {
  peer.forget(kAskVendor);
  boot();
  pass(seconds(20));
  ASSERT_THAT(node->problem(), HasSubstr("given up"));
  node->boot(now, true);
  settle();
  pass(seconds(1));
  EXPECT_THAT(node->problem(), HasSubstr("attempt 2 of 3"));
}

TEST_F(BootRetryTest, a_wrong_identity_is_not_tried_again) {
  config.serial = 4711;
  boot();
  ASSERT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), Not(HasSubstr("again")));
  peer.take();
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty());
}

TEST_F(BootRetryTest, a_refusal_is_not_tried_again) {
  config.vendor_id = 1;
  peer.replace(kAskVendor, "583 80 18 10 01 00 00 02 06");
  boot();
  ASSERT_EQ(node->health(), Health::failed);
  peer.take();
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty());
}

TEST_F(BootRetryTest, without_retries_it_is_told_at_once_as_final) {
  config.boot.retries = 0;
  peer.forget(kAskVendor);
  boot();
  pass(seconds(60));
  EXPECT_THAT(node->problem(), ::testing::EndsWith("asked 2 times"));
}

TEST_F(BootRetryTest, an_absent_node_is_asked_ever_less_often_and_for_ever) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  peer.forget(kAskIdentityCount);
  boot();
  pass(milliseconds(5250));
  ASSERT_EQ(node->health(), Health::absent);
  peer.take();
  // As a late answer to the last question could not be told from one to this, another is asked.
  const std::vector<int> pauses_s{2, 4, 8, 16, 30, 30, 30};  // after each time-out of 0.5 s
  for (const int pause : pauses_s) {
    pass(seconds(pause) - milliseconds(1));
    EXPECT_THAT(peer.take(), IsEmpty()) << pause;
    pass(milliseconds(1));
    EXPECT_THAT(peer.take(), ElementsAre("000 80 03", kAskIdentityCount)) << pause;
    pass(milliseconds(500));
    EXPECT_THAT(peer.take(), ElementsAre("603 80 00 10 00 00 00 04 05")) << "the abort";
    EXPECT_EQ(node->health(), Health::absent);
  }
  EXPECT_EQ(node->bootStep(), "looked for 7 times, again every 30 s");
  pass(seconds(3600));
  const std::ptrdiff_t times = asked(kAskIdentityCount);
  EXPECT_LE(times, 120);
  EXPECT_GE(times, 110);
}

TEST_F(BootRetryTest, a_node_that_answers_the_search_boots_though_it_said_nothing_by_itself) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(seconds(120));
  ASSERT_EQ(node->health(), Health::absent);
  peer.on(kAskDeviceType, "583 43 00 10 00 92 01 02 00");
  for (int i = 0; i < 310 && node->health() == Health::absent; ++i) pass(milliseconds(100));
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine("000 80 03"));
}

/// As one that rebooted unheard does: it has no heartbeat any more, and was told to stop meanwhile.
TEST_F(BootRetryTest, a_lost_node_that_obeyed_the_stop_is_woken_before_it_is_asked) {
  boot();
  ASSERT_EQ(node->health(), Health::ready);
  peer.forget(kAskDeviceType);
  peer.take();
  pass(milliseconds(300));
  ASSERT_EQ(node->health(), Health::lost);
  pass(milliseconds(2999));
  const Lines stops = peer.take();
  EXPECT_EQ(std::count(stops.begin(), stops.end(), kAskDeviceType), 0)
      << "not before it is told to stop no more";
  EXPECT_EQ(stops.back(), "000 02 03");
  pass(milliseconds(1));
  const Lines search = peer.take();
  ASSERT_GE(search.size(), 2u);
  EXPECT_EQ(search[0], "000 80 03");
  EXPECT_EQ(search[1], kAskDeviceType);
}

TEST_F(BootRetryTest, a_node_that_is_said_to_be_there_is_asked_when_it_is_said) {
  config.boot.search_period = Duration::zero();
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  peer.forget(kAskIdentityCount);
  boot();
  pass(milliseconds(6000));
  ASSERT_EQ(node->health(), Health::absent);
  peer.take();
  node->look(now + milliseconds(500));
  pass(milliseconds(499));
  EXPECT_THAT(peer.take(), IsEmpty());
  pass(milliseconds(1));
  EXPECT_THAT(peer.take(), ElementsAre("000 80 03", kAskIdentityCount));
  pass(milliseconds(500));
  peer.take();
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty()) << "no search where none is wanted";
  node->look(now);
  peer.on(kAskIdentityCount, "583 4F 18 10 00 04 00 00 00");
  peer.on(kAskDeviceType, "583 43 00 10 00 92 01 02 00");
  pass(milliseconds(1));
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootRetryTest, a_node_that_was_taken_out_of_operation_is_not_looked_for_though_it_is_there) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(milliseconds(5250));
  ASSERT_EQ(node->health(), Health::absent);
  node->command(NmtCommand::stop, now);
  peer.take();
  node->look(now);
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty());
}

TEST_F(BootRetryTest, a_refusal_of_the_search_is_a_sign_of_life_too) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(milliseconds(5250));
  peer.on(kAskDeviceType, "583 80 00 10 00 00 00 00 08");
  pass(seconds(2));
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootRetryTest, no_search_where_none_is_wanted) {
  config.boot.search_period = Duration::zero();
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(milliseconds(6000));
  ASSERT_EQ(node->health(), Health::absent);
  EXPECT_EQ(node->nextDeadline(), kNever);
}

TEST_F(BootRetryTest, an_nmt_command_out_of_operation_ends_the_attempts) {
  peer.forget(kAskVendor);
  boot();
  pass(seconds(1));
  ASSERT_THAT(node->problem(), HasSubstr("; it is tried again in 1 s (attempt 2 of 3)"));
  peer.on(kAskVendor, "583 43 18 10 01 CD AB 00 00");
  node->command(NmtCommand::stop, now);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): boot failed while reading 1018:01 vendor id: no answer within 500 "
            "ms, asked 2 times; it is not tried again, for it was taken out of operation by the "
            "NMT command 'stop'; boot it (recover) to use it again");
  peer.take();
  hear("703 04");
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty());
  EXPECT_EQ(node->health(), Health::failed);
  node->boot(now, false);
  settle();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootRetryTest, an_nmt_command_out_of_operation_keeps_the_reason_of_a_boot_that_was_refused) {
  config.serial = 4711;
  boot();
  ASSERT_EQ(node->health(), Health::failed);
  node->command(NmtCommand::stop, now);
  EXPECT_THAT(node->problem(), HasSubstr("1018:04 serial number"));
}

TEST_F(BootRetryTest, an_nmt_command_out_of_operation_ends_the_search_until_somebody_asks) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  boot();
  pass(milliseconds(5250));
  ASSERT_EQ(node->health(), Health::absent);
  node->command(NmtCommand::enter_pre_operational, now);
  peer.on(kAskDeviceType, "583 43 00 10 00 92 01 02 00");
  peer.take();
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty());
  EXPECT_EQ(node->health(), Health::absent) << "optional ones stay excused";
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): is absent and was taken out of operation by the NMT command 'enter "
            "pre-operational'; boot it (recover) to use it again");
  hear("703 7F");
  pass(seconds(600));
  EXPECT_THAT(peer.take(), IsEmpty());
  EXPECT_EQ(node->health(), Health::failed) << "it is there, but nobody asked for it";
  EXPECT_THAT(node->problem(), HasSubstr("shoulder (node 3): was taken out of operation by"));
  node->boot(now, false);
  settle();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(BootRetryTest, an_nmt_command_out_of_operation_ends_a_question_of_the_search_on_its_way) {
  peer.forget("000 82 03");
  peer.forget(kAskDeviceType);
  peer.forget(kAskIdentityCount);
  boot();
  pass(milliseconds(7250));
  ASSERT_EQ(node->health(), Health::absent);
  ASSERT_EQ(peer.take().back(), kAskIdentityCount);
  node->command(NmtCommand::stop, now);
  hear("583 4F 18 10 00 04 00 00 00");
  hear("583 43 00 10 00 92 01 02 00");
  EXPECT_EQ(node->health(), Health::absent);
  pass(seconds(600));
  EXPECT_THAT(peer.take(), ElementsAre("000 02 03"));
}

TEST_F(BootRetryTest, a_lost_node_that_was_stopped_boots_at_its_boot_up_message_only) {
  boot();
  ASSERT_EQ(node->health(), Health::ready);
  pass(seconds(1));
  ASSERT_EQ(node->health(), Health::lost);
  node->command(NmtCommand::stop, now);
  hear("703 04");
  EXPECT_EQ(node->health(), Health::failed);
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  pass(seconds(1));
  ASSERT_EQ(node->health(), Health::lost);
  hear("703 05");
  EXPECT_EQ(node->health(), Health::ready) << "as ever, for that command is over";
}

TEST_F(BootRetryTest, another_drive_than_before_is_told_where_no_serial_refuses_it) {
  boot();
  ASSERT_EQ(node->health(), Health::ready);
  EXPECT_THAT(node->notes(), IsEmpty());
  peer.replace("603 40 18 10 04 00 00 00 00", "583 43 18 10 04 3A 30 00 00");
  hear("703 00");
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_THAT(node->notes(),
              ElementsAre(HasSubstr("is another drive than before: its serial number (1018:04) is "
                                    "12346, it was 12345; check its position")));
  hear("703 00");
  EXPECT_THAT(node->notes(), IsEmpty()) << "told once";
  peer.replace("603 40 18 10 02 00 00 00 00", "583 43 18 10 02 18 01 0D 00");
  hear("703 00");
  EXPECT_THAT(node->notes(),
              ElementsAre(HasSubstr(", and its vendor or product is another one, too; check")));
}

TEST_F(BootRetryTest, a_node_that_was_stopped_while_lost_and_booted_since_boots_at_its_heartbeat) {
  boot();
  pass(seconds(1));
  ASSERT_EQ(node->health(), Health::lost);
  node->command(NmtCommand::stop, now);
  node->boot(now, false);
  settle();
  ASSERT_EQ(node->health(), Health::ready) << node->problem();
  pass(seconds(1));
  ASSERT_EQ(node->health(), Health::lost);
  hear("703 7F");
  EXPECT_EQ(node->health(), Health::ready) << "that command is over";
}

TEST(BootRetry, another_attempt_is_not_due_any_more_where_nobody_answers_and_nobody_is_looked_for) {
  BootPolicy policy;
  policy.search_period = Duration::zero();
  BootRetry retry{policy};
  const Time now{seconds(100)};
  retry.failed(BootFailure::timed_out, now);
  ASSERT_EQ(retry.deadline(), now + seconds(1));
  retry.search(now);
  EXPECT_EQ(retry.deadline(), kNever);
  EXPECT_EQ(retry.attemptText(), "");
}

TEST(BootRetry, what_was_refused_is_not_due_again) {
  BootRetry retry{BootPolicy{}};
  const Time now{seconds(100)};
  retry.failed(BootFailure::timed_out, now);
  retry.failed(BootFailure::refused, now);
  EXPECT_EQ(retry.deadline(), kNever);
  EXPECT_EQ(retry.outlook(), "");
}

TEST(BootRetry, a_search_that_somebody_asked_for_goes_on_as_slowly_as_one_from_a_loss) {
  BootRetry retry{BootPolicy{}};  // every 2 s at first, twice as long each time
  const Time now{seconds(100)};
  retry.look(now);
  EXPECT_TRUE(retry.searchDue(now));
  retry.begun();
  retry.notFound(now);
  EXPECT_EQ(retry.deadline(), now + seconds(4));
}

}  // namespace
}  // namespace cia402::canopen
