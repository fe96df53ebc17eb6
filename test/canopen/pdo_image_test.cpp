// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/image.h"

#include <gtest/gtest.h>

#include "canopen/process_objects.h"
#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

using test::frame;
using test::kControlword;
using test::kStatusword;
using test::kTarget;

constexpr Time kStamp(std::chrono::milliseconds(7));
constexpr ObjectId kPosition{0x6064, 0}, kMode{0x6061, 0};

PdoConfig pdo(PdoDirection direction, unsigned number, std::uint16_t cob_id,
              std::vector<PdoEntry> entries) {
  PdoConfig config;
  config.direction = direction;
  config.number = number;
  config.cob_id = cob_id;
  config.entries = std::move(entries);
  return config;
}

std::vector<PdoConfig> servo() {
  return {pdo(PdoDirection::tpdo, 2, 0x283, {{kMode, 8, ""}, {kStatusword, 16, ""}}),
          pdo(PdoDirection::tpdo, 1, 0x183, {{kStatusword, 16, ""}, {kPosition, 32, ""}}),
          pdo(PdoDirection::rpdo, 1, 0x203, {{kControlword, 16, ""}, {kTarget, 32, ""}})};
}

TEST(PdoImage, unpacks_little_endian_entries_one_after_the_other) {
  PdoImage image(servo());
  EXPECT_TRUE(image.receive(0, frame("183 37 02 78 56 34 F2"), kStamp));
  const fieldbus::ProcessValue& statusword = image.input(image.inputSlot(kStatusword));
  EXPECT_EQ(statusword.raw, 0x0237U);
  EXPECT_EQ(statusword.stamp, kStamp);
  EXPECT_TRUE(statusword.valid);
  EXPECT_EQ(image.input(image.inputSlot(kPosition)).raw, 0xF2345678U);  // zero-extended
}

TEST(PdoImage, orders_pdos_by_number_and_shares_the_slot_of_an_object_mapped_twice) {
  PdoImage image(servo());
  ASSERT_EQ(image.tpdos().size(), 2U);
  EXPECT_EQ(image.tpdos()[0].cob_id, 0x183);
  EXPECT_EQ(image.tpdos()[1].cob_id, 0x283);
  image.receive(0, frame("183 37 02 00 00 00 00"), kStamp);
  image.receive(1, frame("283 08 50 02"), kStamp);
  EXPECT_EQ(image.input(image.inputSlot(kStatusword)).raw, 0x0250U);
  EXPECT_EQ(image.input(image.inputSlot(kMode)).raw, 0x08U);
}

TEST(PdoImage, orders_rpdos_by_number) {
  PdoImage image({pdo(PdoDirection::rpdo, 2, 0x303, {{kTarget, 32, ""}}),
                  pdo(PdoDirection::rpdo, 1, 0x203, {{kControlword, 16, ""}})});
  ASSERT_EQ(image.rpdos().size(), 2U);
  EXPECT_EQ(image.rpdos()[0].cob_id, 0x203);
  EXPECT_EQ(image.rpdos()[1].cob_id, 0x303);
}

TEST(PdoImage, takes_no_entry_that_does_not_fit_nor_one_behind_it) {
  PdoImage image({pdo(PdoDirection::tpdo, 1, 0x183,
                      {{kStatusword, 16, ""}, {kPosition, 48, ""}, {kMode, 8, ""}}),
                  pdo(PdoDirection::tpdo, 2, 0x283, {{kTarget, 0, ""}, {kMode, 8, ""}})});
  EXPECT_EQ(image.tpdos()[0].size, 8);
  EXPECT_NE(image.inputSlot(kPosition), fieldbus::kNoSlot) << "64 bits";
  EXPECT_EQ(image.tpdos()[1].size, 0);
  EXPECT_EQ(image.inputSlot(kTarget), fieldbus::kNoSlot);
  EXPECT_EQ(image.inputSlot(kMode), fieldbus::kNoSlot);
}

TEST(PdoImage, keeps_the_two_directions_apart) {
  PdoImage image(servo());
  EXPECT_EQ(image.outputSlot(kStatusword), fieldbus::kNoSlot);
  EXPECT_EQ(image.inputSlot(kControlword), fieldbus::kNoSlot);
  EXPECT_NE(image.outputSlot(kControlword), fieldbus::kNoSlot);
}

TEST(PdoImage, packs_outputs_and_cuts_them_to_their_width) {
  PdoImage image(servo());
  image.setOutput(image.outputSlot(kControlword), 0xABCD000F);
  image.setOutput(image.outputSlot(kTarget), static_cast<std::uint64_t>(-2));
  can::Frame packed;
  image.pack(0, packed);
  EXPECT_EQ(test::text(packed), "203 0F 00 FE FF FF FF");
}

TEST(PdoImage, handles_entries_that_are_no_whole_bytes_and_a_full_64_bit_entry) {
  PdoImage bits({pdo(PdoDirection::tpdo, 1, 0x181,
                     {{{0x2000, 1}, 1, ""}, {{0x2000, 2}, 3, ""}, {{0x2000, 3}, 12, ""}})});
  EXPECT_EQ(bits.tpdos()[0].size, 2);
  // 0xABCB = 1010 1011 1100 | 101 | 1
  bits.receive(0, frame("181 CB AB"), kStamp);
  EXPECT_EQ(bits.input(bits.inputSlot({0x2000, 1})).raw, 1U);
  EXPECT_EQ(bits.input(bits.inputSlot({0x2000, 2})).raw, 5U);
  EXPECT_EQ(bits.input(bits.inputSlot({0x2000, 3})).raw, 0xABCU);

  PdoImage wide({pdo(PdoDirection::tpdo, 1, 0x181, {{{0x2001, 0}, 64, ""}})});
  wide.receive(0, frame("181 01 02 03 04 05 06 07 88"), kStamp);
  EXPECT_EQ(wide.input(0).raw, 0x8807060504030201U);
}

TEST(PdoImage, takes_nothing_from_a_frame_that_is_too_short) {
  PdoImage image(servo());
  image.receive(0, frame("183 37 02 01 00 00 00"), kStamp);
  EXPECT_FALSE(image.receive(0, frame("183 50 02 09 00 00"), kStamp + std::chrono::seconds(1)));
  EXPECT_EQ(image.input(image.inputSlot(kStatusword)).raw, 0x0237U);
  EXPECT_EQ(image.input(image.inputSlot(kStatusword)).stamp, kStamp);
  EXPECT_EQ(image.tpdos()[0].too_short, 1U);
  EXPECT_EQ(image.tpdos()[0].received, 1U);
}

TEST(PdoImage, takes_the_mapped_part_of_a_frame_that_is_too_long_but_counts_it) {
  PdoImage image(servo());
  EXPECT_FALSE(image.receive(0, frame("183 37 02 01 00 00 00 FF"), kStamp));
  EXPECT_EQ(image.input(image.inputSlot(kPosition)).raw, 1U);
  EXPECT_EQ(image.tpdos()[0].too_long, 1U);
}

TEST(PdoImage, packs_each_byte_in_its_place) {
  PdoImage image({pdo(PdoDirection::rpdo, 1, 0x203, {{{0x2001, 0}, 64, ""}})});
  image.setOutput(0, 0x8807060504030201U);
  can::Frame packed;
  image.pack(0, packed);
  EXPECT_EQ(test::text(packed), "203 01 02 03 04 05 06 07 88");
}

TEST(PdoImage, counts_frames_of_a_wrong_length) {
  PdoImage image(servo());
  image.receive(0, frame("183 37 02 01 00 00 00"), kStamp);
  EXPECT_EQ(image.wrongLengths(), 0U);
  image.receive(0, frame("183 37 02 01 00 00"), kStamp);
  image.receive(1, frame("283 08 50 02 00"), kStamp);
  EXPECT_EQ(image.wrongLengths(), 2U);
  EXPECT_EQ(image.troubles(), 2U);
}

TEST(PdoImage, has_no_slots_for_disabled_pdos) {
  std::vector<PdoConfig> pdos = servo();
  pdos[0].enabled = false;
  PdoImage image(pdos);
  EXPECT_EQ(image.tpdos().size(), 1U);
  EXPECT_EQ(image.inputSlot(kMode), fieldbus::kNoSlot);
}

TEST(PdoImage, forgets_inputs_and_outputs_when_invalidated) {
  PdoImage image(servo());
  image.receive(0, frame("183 37 02 01 00 00 00"), kStamp);
  image.setOutput(image.outputSlot(kControlword), 0x0F);
  image.invalidate();
  EXPECT_FALSE(image.input(image.inputSlot(kStatusword)).valid);
  EXPECT_EQ(image.output(image.outputSlot(kControlword)), 0U);
}

PdoConfig tpdoOfType(std::uint8_t type) {
  PdoConfig config = pdo(PdoDirection::tpdo, 1, 0x183, {{kStatusword, 16, ""}});
  config.transmission = type;
  config.stale_after = 3;
  return config;
}

Time afterMs(int ms) { return Time(std::chrono::seconds(5) + std::chrono::milliseconds(ms)); }

/// SYNCs without a TPDO until it is stale; 0: it never is.
int syncsUntilStale(PdoImage& image) {
  for (int sync = 1; sync <= 1000; ++sync) {
    image.age(afterMs(4 * sync));
    if (image.tpdos()[0].stale) return sync;
  }
  return 0;
}

TEST(PdoImage, a_synchronous_tpdo_is_stale_after_it_failed_to_come_three_times) {
  PdoImage every({tpdoOfType(1)});
  EXPECT_EQ(syncsUntilStale(every), 4);  // the answer to the fourth SYNC is not due yet
  PdoImage fifth({tpdoOfType(5)});
  EXPECT_EQ(syncsUntilStale(fifth), 16);
  EXPECT_EQ(fifth.staleCount(), 1U);
}

TEST(PdoImage, a_tpdo_that_comes_again_is_fresh_again_and_counted_once) {
  PdoImage image({tpdoOfType(1)});
  const fieldbus::Slot slot = image.inputSlot(kStatusword);
  EXPECT_FALSE(image.fresh(slot)) << "nothing has come yet";
  image.receive(0, frame("183 37 02"), kStamp);
  EXPECT_TRUE(image.fresh(slot));
  syncsUntilStale(image);
  EXPECT_FALSE(image.fresh(slot));
  for (int i = 0; i < 5; ++i) image.age(kStamp);
  EXPECT_EQ(image.tpdos()[0].stale_count, 1U);
  image.receive(0, frame("183 37 02"), kStamp);
  EXPECT_TRUE(image.fresh(slot));
  EXPECT_EQ(syncsUntilStale(image), 4);
  EXPECT_EQ(image.staleCount(), 2U);
}

TEST(PdoImage, a_frame_that_is_too_short_does_not_keep_a_tpdo_fresh) {
  PdoImage image({tpdoOfType(1)});
  for (int i = 0; i < 4; ++i) {
    image.age(kStamp);
    image.receive(0, frame("183 37"), kStamp);
  }
  EXPECT_TRUE(image.tpdos()[0].stale);
}

TEST(PdoImage, tpdos_without_a_rate_are_never_stale) {
  for (const int type : {0, 254, 255}) {
    PdoImage image({tpdoOfType(static_cast<std::uint8_t>(type))});
    EXPECT_EQ(syncsUntilStale(image), 0) << type;
    EXPECT_FALSE(image.regular(image.inputSlot(kStatusword)));
  }
}

TEST(PdoImage, an_event_timer_tells_how_long_a_tpdo_may_be_away) {
  PdoConfig config = tpdoOfType(255);
  config.event_timer = 20;  // ms
  config.inhibit = 50;      // 5 ms
  PdoImage image({config});
  EXPECT_TRUE(image.regular(image.inputSlot(kStatusword)));
  image.receive(0, frame("183 37 02"), afterMs(0));
  image.age(afterMs(75));
  EXPECT_FALSE(image.tpdos()[0].stale);
  image.age(afterMs(76));  // more than three times 25 ms
  EXPECT_TRUE(image.tpdos()[0].stale);
}

TEST(PdoImage, asks_by_remote_frame_at_the_configured_rate) {
  for (const int type : {252, 253}) {
    PdoConfig config = tpdoOfType(static_cast<std::uint8_t>(type));
    config.request_every = 3;
    PdoImage image({config});
    ASSERT_EQ(image.requested(), std::vector<std::size_t>{0});
    can::Frame request;
    EXPECT_FALSE(image.requestDue(0, request));
    EXPECT_FALSE(image.requestDue(0, request));
    ASSERT_TRUE(image.requestDue(0, request));
    EXPECT_EQ(request.id, 0x183U);
    EXPECT_TRUE(request.remote);
    EXPECT_EQ(request.size, 2);  // the length that is asked for
    EXPECT_FALSE(image.requestDue(0, request));
    EXPECT_EQ(syncsUntilStale(image), 10);
  }
}

TEST(PdoImage, an_rpdo_leaves_when_its_content_changes_and_at_its_refresh_rate) {
  PdoConfig config = pdo(PdoDirection::rpdo, 1, 0x203, {{kControlword, 16, ""}});
  config.refresh_every = 4;
  PdoImage image({config});
  can::Frame frame;
  const auto due = [&] { return image.packDue(0, frame, kStamp); };
  EXPECT_TRUE(due()) << "the first one";
  EXPECT_FALSE(due());
  image.setOutput(image.outputSlot(kControlword), 6);
  EXPECT_TRUE(due());
  EXPECT_EQ(test::text(frame), "203 06 00");
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(due()) << i;
  EXPECT_TRUE(due()) << "the fourth cycle since";
  image.sendAgain(image.outputSlot(kControlword));
  EXPECT_TRUE(due()) << "asked for";
  EXPECT_FALSE(due());
  image.invalidate();
  EXPECT_TRUE(due()) << "the drive has rebooted";
  EXPECT_EQ(image.sent(0), 5U);
}

TEST(PdoImage, after_a_reboot_a_tpdo_has_as_long_to_come_as_at_first) {
  PdoImage image({tpdoOfType(1)});
  for (const int syncs : {3, 4}) {
    for (int i = 0; i < syncs; ++i) image.age(kStamp);
    image.invalidate();
    EXPECT_FALSE(image.tpdos()[0].stale);
    EXPECT_EQ(syncsUntilStale(image), 4);
    image.invalidate();
  }
}

TEST(PdoImage, after_a_reboot_a_tpdo_with_an_event_timer_is_expected_from_then_on) {
  PdoConfig config = tpdoOfType(255);
  config.event_timer = 20;  // ms, stale after three of them
  PdoImage image({config});
  image.receive(0, frame("183 37 02"), afterMs(0));
  image.invalidate();
  image.age(afterMs(1000));
  EXPECT_FALSE(image.tpdos()[0].stale);
  image.age(afterMs(1060));
  EXPECT_FALSE(image.tpdos()[0].stale);
  image.age(afterMs(1061));
  EXPECT_TRUE(image.tpdos()[0].stale);
}

TEST(PdoImage, after_a_reboot_a_tpdo_is_asked_for_at_its_rate_from_then_on) {
  PdoConfig config = tpdoOfType(252);
  config.request_every = 3;
  PdoImage image({config});
  can::Frame request;
  image.requestDue(0, request);
  image.requestDue(0, request);
  image.invalidate();
  EXPECT_FALSE(image.requestDue(0, request));
  EXPECT_FALSE(image.requestDue(0, request));
  EXPECT_TRUE(image.requestDue(0, request));
}

TEST(PdoImage, a_request_is_a_plain_remote_frame_whatever_the_frame_was_before) {
  PdoImage image({tpdoOfType(252)});
  can::Frame request = frame("7FF 01 02 03 04 05 06 07 08");
  request.extended = request.error = true;
  ASSERT_TRUE(image.requestDue(0, request));
  EXPECT_EQ(test::text(request), "183 R2");
  EXPECT_FALSE(request.extended || request.error);
}

TEST(PdoImage, remembers_when_an_rpdo_was_sent) {
  PdoImage image({pdo(PdoDirection::rpdo, 1, 0x203, {{kControlword, 16, ""}})});
  can::Frame out;
  ASSERT_TRUE(image.packDue(0, out, kStamp));
  EXPECT_EQ(image.rpdos()[0].last, kStamp);
}

// Statusword, mode, position; without the mode the position moves up.
TEST(PdoImage, what_stands_behind_an_entry_that_is_left_out_moves_up) {
  PdoImage image({pdo(PdoDirection::tpdo, 1, 0x183,
                      {{kStatusword, 16, ""}, {kMode, 8, ""}, {kPosition, 32, ""}})});
  EXPECT_TRUE(image.receive(0, frame("183 37 02 08 78 56 34 12"), kStamp));
  image.invalidate();
  image.leaveOut(PdoDirection::tpdo, 1, kMode);
  EXPECT_TRUE(image.inputLeftOut(image.inputSlot(kMode)));
  EXPECT_FALSE(image.inputLeftOut(image.inputSlot(kPosition)));
  EXPECT_TRUE(image.receive(0, frame("183 37 02 78 56 34 12"), kStamp));
  EXPECT_EQ(image.input(image.inputSlot(kPosition)).raw, 0x12345678U);
  EXPECT_FALSE(image.fresh(image.inputSlot(kMode)));
  image.includeAll();
  EXPECT_TRUE(image.receive(0, frame("183 37 02 08 78 56 34 12"), kStamp));
  EXPECT_EQ(image.input(image.inputSlot(kPosition)).raw, 0x12345678U);
  EXPECT_EQ(image.input(image.inputSlot(kMode)).raw, 8U);
  EXPECT_FALSE(image.inputLeftOut(image.inputSlot(kMode)));
}

TEST(PdoImage, a_pdo_without_entries_is_neither_sent_nor_expected) {
  PdoImage image({pdo(PdoDirection::tpdo, 1, 0x183, {{kStatusword, 16, ""}}),
                  pdo(PdoDirection::rpdo, 2, 0x303, {{kTarget, 32, ""}})});
  image.leaveOut(PdoDirection::tpdo, 1, kStatusword);
  image.leaveOut(PdoDirection::rpdo, 2, kTarget);
  for (int cycle = 0; cycle < 1000; ++cycle) image.age(kStamp);
  EXPECT_EQ(image.staleCount(), 0U);
  can::Frame out;
  EXPECT_FALSE(image.packDue(0, out, kStamp));
  image.includeAll();
  EXPECT_TRUE(image.packDue(0, out, kStamp));
  for (int cycle = 0; cycle < 1000; ++cycle) image.age(kStamp);
  EXPECT_EQ(image.staleCount(), 1U);
}

TEST(PdoImage, an_object_that_another_pdo_still_has_is_not_left_out) {
  PdoImage image(servo());
  image.leaveOut(PdoDirection::tpdo, 2, kStatusword);
  EXPECT_FALSE(image.inputLeftOut(image.inputSlot(kStatusword)));
  image.leaveOut(PdoDirection::tpdo, 1, kStatusword);
  EXPECT_TRUE(image.inputLeftOut(image.inputSlot(kStatusword)));
}

TEST(PdoImage, moves_what_stands_behind_an_object_that_the_drive_holds_in_more_bits) {
  PdoImage image({pdo(PdoDirection::tpdo, 1, 0x183, {{kMode, 8, ""}, {kStatusword, 16, ""}}),
                  pdo(PdoDirection::rpdo, 1, 0x203, {{kMode, 8, ""}, {kTarget, 32, ""}})});
  image.widen(kMode, 16, true);
  EXPECT_TRUE(image.receive(0, frame("183 FF FF 37 02"), kStamp));
  EXPECT_EQ(image.input(image.inputSlot(kMode)).raw, 0xFFU) << "as wide as it was";
  EXPECT_EQ(image.input(image.inputSlot(kStatusword)).raw, 0x0237U);
  EXPECT_FALSE(image.receive(0, frame("183 FF 37 02"), kStamp)) << "too short now";
  can::Frame sent;
  image.setOutput(image.outputSlot(kTarget), 0x12345678);
  image.setOutput(image.outputSlot(kMode), 0x03);
  image.pack(0, sent);
  EXPECT_EQ(sent, frame("203 03 00 78 56 34 12"));
  image.setOutput(image.outputSlot(kMode), 0xFF);  // -1
  image.pack(0, sent);
  EXPECT_EQ(sent, frame("203 FF FF 78 56 34 12"));
  image.includeAll();  // another drive: as constructed
  image.pack(0, sent);
  EXPECT_EQ(sent, frame("203 FF 78 56 34 12"));
}

TEST(PdoImage, widens_numbers_without_a_sign_by_zeros) {
  PdoImage image({pdo(PdoDirection::rpdo, 1, 0x203, {{kMode, 8, ""}})});
  image.widen(kMode, 16, false);
  image.setOutput(image.outputSlot(kMode), 0xFF);
  can::Frame sent;
  image.pack(0, sent);
  EXPECT_EQ(sent, frame("203 FF 00"));
}

}  // namespace
}  // namespace cia402::canopen
