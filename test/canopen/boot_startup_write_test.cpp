// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using namespace std::chrono_literals;
using test::Lines;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class StartupWriteTest : public test::NodeFixture {
 protected:
  StartupWriteTest() {
    StartupWrite write;
    write.object = {0x6065, 0};
    write.name = "following_error_window";
    write.data = {0x88, 0x13, 0x00, 0x00};  // 5000
    config.writes = {write};
  }
  const char* kRead = "603 40 65 60 00 00 00 00 00";
  const char* kWrite = "603 23 65 60 00 88 13 00 00";
  const char* kDone = "583 60 65 60 00 00 00 00 00";
};

TEST_F(StartupWriteTest, writes_what_differs) {
  peer.on(kRead, "583 43 65 60 00 10 00 00 00").on(kWrite, kDone);
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_TRUE(sentLine(kWrite));
}

TEST_F(StartupWriteTest, does_not_write_what_is_as_wanted) {
  peer.on(kRead, "583 43 65 60 00 88 13 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_FALSE(sentLine(kWrite));
}

TEST_F(StartupWriteTest, writes_an_object_that_cannot_be_read) {
  peer.on(kRead, "583 80 65 60 00 01 00 01 06").on(kWrite, kDone);
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_TRUE(sentLine(kWrite));
}

TEST_F(StartupWriteTest, does_not_read_first_where_not_wanted) {
  config.writes[0].only_if_different = false;
  peer.on(kWrite, kDone);
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_FALSE(sentLine(kRead));
}

TEST_F(StartupWriteTest, comes_after_the_pdos_or_before_them) {
  const auto place = [this](const std::string& beginning) {
    const auto found = std::find_if(
        peer.sent.begin(), peer.sent.end(),
        [&](const std::string& sent) { return sent.compare(0, beginning.size(), beginning) == 0; });
    EXPECT_NE(found, peer.sent.end()) << beginning;
    return found - peer.sent.begin();
  };
  for (const bool before : {false, true}) {
    peer.sent.clear();
    config.writes[0].before_pdos = before;
    peer.on(kRead, "583 43 65 60 00 10 00 00 00").on(kWrite, kDone);
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    EXPECT_EQ(place(kWrite) < place("603 40 00 14 01"), before) << "the COB-ID of RPDO 1 is read";
    EXPECT_EQ(std::count(peer.sent.begin(), peer.sent.end(), kWrite), 1);
  }
}

// 0x08000022: because of the present device state; e.g. a drive on its way out of operation.
const char* const kNotInThisState = "583 80 65 60 00 22 00 00 08";

TEST_F(StartupWriteTest, tries_again_what_the_present_state_forbids) {
  peer.on(kRead, "583 43 65 60 00 10 00 00 00");
  peer.on(kWrite, kNotInThisState).on(kWrite, kNotInThisState).on(kWrite, kDone);
  boot();
  EXPECT_EQ(node->health(), Health::booting);
  pass(200ms);
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
}

TEST_F(StartupWriteTest, rests_before_it_tries_again_whatever_else_is_heard) {
  peer.on(kRead, "583 43 65 60 00 10 00 00 00").on(kWrite, kNotInThisState);
  boot();
  for (int i = 0; i < 4; ++i) {
    pass(10ms);
    hear("703 7F");
  }
  const auto tries = [&] { return std::count(peer.sent.begin(), peer.sent.end(), kWrite); };
  EXPECT_EQ(tries(), 1);
  pass(10ms);
  EXPECT_EQ(tries(), 2);
}

TEST_F(StartupWriteTest, gives_up_after_three_seconds_in_a_state_that_forbids_it) {
  peer.on(kRead, "583 43 65 60 00 10 00 00 00").on(kWrite, kNotInThisState);
  boot();
  pass(2900ms);
  EXPECT_EQ(node->health(), Health::booting);
  pass(300ms);
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("following_error_window: the drive refused: 0x08000022"));
}

TEST_F(StartupWriteTest, a_refused_write_fails_the_boot_unless_optional) {
  peer.on(kRead, "583 43 65 60 00 10 00 00 00").on(kWrite, "583 80 65 60 00 31 00 09 06");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_EQ(node->problem(),
            "shoulder (node 3): boot failed while writing 0x00001388 to 6065:00 "
            "following_error_window: the drive refused: 0x06090031 (value of parameter written too "
            "high)");
  EXPECT_FALSE(sentLine("000 01 03"));
  config.writes[0].optional = true;
  boot();
  EXPECT_EQ(node->health(), Health::ready);
  EXPECT_THAT(node->notes(),
              ElementsAre(HasSubstr("optional start-up write left out: writing 0x00001388 to "
                                    "6065:00 following_error_window")));
}

TEST_F(StartupWriteTest, tells_values_of_up_to_eight_bytes) {
  config.writes[0].only_if_different = false;
  config.writes[0].data = {1, 2, 3, 4, 5, 6, 7, 8};
  peer.on("603 21 65 60 00 08 00 00 00", "583 80 65 60 00 31 00 09 06");
  boot();
  EXPECT_THAT(node->problem(), HasSubstr("while writing 0x0807060504030201 to 6065:00"));
  config.writes[0].data.push_back(9);
  peer.on("603 21 65 60 00 09 00 00 00", "583 80 65 60 00 31 00 09 06");
  boot();
  EXPECT_THAT(node->problem(), HasSubstr("while writing 9 bytes to 6065:00"));
}

TEST_F(StartupWriteTest, leaves_out_what_only_a_default_asked_for_and_the_drive_does_not_have) {
  config.writes[0].by_default = true;
  config.lacking_remedy = "name it in `lacks`";
  for (const char* refusal : {"583 80 65 60 00 00 00 02 06", "583 80 65 60 00 41 00 04 06",
                              "583 80 65 60 00 11 00 09 06", "583 80 65 60 00 02 00 01 06"}) {
    peer.on(kRead, "583 80 65 60 00 00 00 02 06").on(kWrite, refusal);
    boot();
    EXPECT_EQ(node->health(), Health::ready) << refusal << ": " << node->problem();
    EXPECT_THAT(node->notes(), ElementsAre(AllOf(HasSubstr("6065:00 following_error_window"),
                                                 HasSubstr("name it in `lacks`"))));
  }
}

TEST_F(StartupWriteTest, a_value_that_the_drive_refuses_is_an_error_though_a_default_asked_for_it) {
  config.writes[0].by_default = true;
  peer.on(kRead, "583 43 65 60 00 10 00 00 00").on(kWrite, "583 80 65 60 00 31 00 09 06");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
}

TEST_F(StartupWriteTest, a_missing_object_that_was_asked_for_is_an_error) {
  peer.on(kRead, "583 80 65 60 00 00 00 02 06").on(kWrite, "583 80 65 60 00 00 00 02 06");
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("0x06020000"));
}

TEST_F(StartupWriteTest, keeps_the_order_of_the_configuration) {
  StartupWrite second = config.writes[0];
  second.object = {0x605A, 0};
  second.data = {0x02, 0x00};
  config.writes.push_back(second);
  for (StartupWrite& write : config.writes) write.only_if_different = false;
  peer.on(kWrite, kDone).on("603 2B 5A 60 00 02 00 00 00", "583 60 5A 60 00 00 00 00 00");
  boot();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.end() - 3, sent.end()),
            (Lines{kWrite, "603 2B 5A 60 00 02 00 00 00", "000 01 03"}));
}

TEST_F(StartupWriteTest, a_read_that_is_not_answered_fails_the_boot_before_anything_is_written) {
  boot();
  pass(1000ms);
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(),
              HasSubstr("boot failed while reading 6065:00 following_error_window: no answer"));
  EXPECT_FALSE(sentLine(kWrite));
}

// A drive that is silent where it should abort: asked three times (canopen/boot/context.h).
TEST_F(StartupWriteTest, an_optional_object_that_is_silent_while_others_answer_is_missing) {
  config.writes[0].optional = true;
  config.writes[0].only_if_different = false;
  boot();
  for (int i = 0; i < 50 && node->health() == Health::booting; ++i) {
    hear("703 7F");
    pass(100ms);
  }
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(std::count(peer.sent.begin(), peer.sent.end(), kWrite), 3);
}

TEST_F(StartupWriteTest, what_was_asked_for_is_written_as_patiently_as_configured) {
  config.writes[0].only_if_different = false;
  config.sdo.timeout = 250ms;
  config.sdo.retries = 0;
  boot();
  pass(249ms);
  EXPECT_EQ(node->health(), Health::booting);
  pass(1ms);
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("no answer within 250 ms"));
}

}  // namespace
}  // namespace cia402::canopen
