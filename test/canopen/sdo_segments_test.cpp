// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using test::frame;
using Lines = std::vector<std::string>;

constexpr ObjectId kName{0x1008, 0};
constexpr char kAskName[] = "601 40 08 10 00 00 00 00 00";
constexpr char kSegment0[] = "601 60 00 00 00 00 00 00 00";
constexpr char kSegment1[] = "601 70 00 00 00 00 00 00 00";

/// Plays the server for lengths that nobody wants to write out: counts and checks bytes by hand.
class LongTransfer : public test::SdoClientFixture,
                     public ::testing::WithParamInterface<std::size_t> {
 protected:
  static std::uint8_t byteAt(std::size_t i) { return static_cast<std::uint8_t>(i * 31 + i / 256); }
};

TEST_P(LongTransfer, is_read_to_the_last_byte) {
  const std::size_t size = GetParam();
  const SdoTicket ticket = client.upload(kName);
  client.tick(now);
  ASSERT_EQ(peer.take(), Lines{kAskName});
  can::Frame answer = frame("581 41 08 10 00 00 00 00 00");
  for (std::size_t i = 0; i < 4; ++i) {
    answer.data[4 + i] = static_cast<std::uint8_t>(size >> (8 * i));
  }
  client.receive(answer, now);
  bool toggle = false;
  for (std::size_t sent = 0; sent < size; toggle = !toggle) {
    ASSERT_EQ(peer.take(), Lines{toggle ? kSegment1 : kSegment0});
    const std::size_t count = std::min<std::size_t>(7, size - sent);
    can::Frame segment = frame("581 00 00 00 00 00 00 00 00");
    for (std::size_t i = 0; i < count; ++i) segment.data[1 + i] = byteAt(sent + i);
    sent += count;
    segment.data[0] =
        static_cast<std::uint8_t>((toggle ? 16U : 0U) + 2 * (7 - count) + (sent == size ? 1U : 0U));
    client.receive(segment, now);
  }
  ASSERT_TRUE(ticket->ok()) << ticket->message();
  ASSERT_EQ(ticket->data().size(), size);
  for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(ticket->data()[i], byteAt(i)) << i;
}

TEST_P(LongTransfer, is_written_to_the_last_byte) {
  const std::size_t size = GetParam();
  Bytes data(size);
  for (std::size_t i = 0; i < size; ++i) data[i] = byteAt(i);
  SdoOptions in_segments = options();
  in_segments.block = SdoOptions::Block::never;
  const SdoTicket ticket = client.download({0x1F50, 1}, data, "", in_segments);
  client.tick(now);
  can::Frame first = frame(peer.take().back());
  EXPECT_EQ(first.data[0], 0x21);
  EXPECT_EQ(first.data[4] | first.data[5] << 8 | first.data[6] << 16, static_cast<int>(size));
  receive("581 60 50 1F 01 00 00 00 00");
  std::size_t got = 0;
  for (bool toggle = false; !ticket->done(); toggle = !toggle) {
    const Lines lines = peer.take();
    ASSERT_EQ(lines.size(), 1U);
    const can::Frame segment = frame(lines[0]);
    ASSERT_EQ((segment.data[0] & 0x10) != 0, toggle);
    const std::size_t count = 7U - (segment.data[0] >> 1 & 7U);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(segment.data[1 + i], byteAt(got + i));
    got += count;
    ASSERT_EQ((segment.data[0] & 1) != 0, got == size);
    receive(toggle ? "581 30 00 00 00 00 00 00 00" : "581 20 00 00 00 00 00 00 00");
  }
  EXPECT_TRUE(ticket->ok());
  EXPECT_EQ(got, size);
}

INSTANTIATE_TEST_SUITE_P(Sizes, LongTransfer,
                         ::testing::Values<std::size_t>(5, 7, 8, 14, 200, 1000, 100000));

}  // namespace
}  // namespace cia402::canopen
