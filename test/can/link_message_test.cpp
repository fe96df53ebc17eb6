// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/link_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <random>

namespace cia402::can {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Numbers as in linux/rtnetlink.h, linux/if_link.h and linux/can/netlink.h; little-endian.
Bytes u16(unsigned value) {
  return {static_cast<std::uint8_t>(value & 0xFF), static_cast<std::uint8_t>(value >> 8)};
}
Bytes u32(std::uint32_t value) {
  Bytes bytes = u16(value & 0xFFFF);
  const Bytes high = u16(value >> 16);
  bytes.insert(bytes.end(), high.begin(), high.end());
  return bytes;
}
Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
Bytes text(const std::string& words) { return Bytes(words.begin(), words.end()) + Bytes{0}; }
Bytes attribute(unsigned type, const Bytes& content) {
  Bytes bytes = u16(static_cast<unsigned>(content.size()) + 4) + u16(type) + content;
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}
Bytes newLink(std::uint32_t flags, const Bytes& attributes) {
  const Bytes info = Bytes{0, 0} + u16(280) + u32(7) + u32(flags) + u32(0);   // ARPHRD_CAN, index 7
  const Bytes rest = u16(16) + u16(0) + u32(1) + u32(0) + info + attributes;  // RTM_NEWLINK
  return u32(static_cast<std::uint32_t>(rest.size()) + 4) + rest;
}
Bytes canData(std::uint32_t state, std::uint32_t restart_ms, std::uint32_t mode) {
  return attribute(1, u32(500000) + Bytes(28)) +  // bit timing: rate first
         attribute(2, Bytes(48)) +                // bit timing constants
         attribute(4, u32(state)) + attribute(5, u32(0xFF) + u32(mode)) +
         attribute(6, u32(restart_ms)) + attribute(8, u16(136) + u16(5));
}
Bytes canLink(const Bytes& data, const std::string& kind = "can") {
  const Bytes stats = u32(11) + u32(2) + u32(1) + u32(3) + u32(4) + u32(9);
  return newLink(0x10041,
                 attribute(3, text("can0")) + attribute(13, u32(10)) +
                     attribute(18 | 0x8000, attribute(1, text(kind)) + attribute(3, stats) +
                                                attribute(2 | 0x8000, data)));
}
std::optional<LinkSettings> parse(const Bytes& bytes) {
  return parseLink(bytes.data(), bytes.size());
}

// struct can_bittiming: bit/s, thousandths of a bit, ns of a quantum, ...
TEST(ParseLink, TakesTheSamplePointOfAController) {
  const Bytes timing =
      u32(1000000) + u32(750) + u32(125) + u32(2) + u32(3) + u32(2) + u32(1) + u32(1);
  const auto link = parse(canLink(attribute(1, timing) + attribute(2, Bytes(48))));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->bitrate, 1000000u);
  ASSERT_TRUE(link->sample_point);
  EXPECT_DOUBLE_EQ(*link->sample_point, 0.75);
}

TEST(ParseLink, TakesTheSettingsOfAController) {
  const auto link = parse(canLink(canData(2, 100, 0x10)));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->name, "can0");
  EXPECT_EQ(link->index, 7);
  EXPECT_EQ(link->kind, "can");
  EXPECT_TRUE(link->up);
  EXPECT_TRUE(link->carrier);
  EXPECT_EQ(link->tx_queue_length, 10u);
  EXPECT_EQ(link->bitrate, 500000u);
  EXPECT_FALSE(link->sample_point) << "0: it is not known";
  EXPECT_EQ(link->controller, BusState::error_passive);
  EXPECT_EQ(link->restart_ms, 100u);
  EXPECT_EQ(link->transmit_errors, 136u);
  EXPECT_EQ(link->receive_errors, 5u);
  EXPECT_TRUE(link->error_reporting);
  EXPECT_FALSE(link->listen_only || link->loopback || link->one_shot);
  EXPECT_TRUE(link->real_controller);
  ASSERT_TRUE(link->events);
  EXPECT_EQ(link->events->bus_errors, 11u);
  EXPECT_EQ(link->events->warnings, 2u);
  EXPECT_EQ(link->events->passives, 1u);
  EXPECT_EQ(link->events->bus_offs, 3u);
  EXPECT_EQ(link->events->arbitration_lost, 4u);
  EXPECT_EQ(link->events->restarts, 9u);
}

TEST(ParseLink, TellsStatesAndModesApart) {
  EXPECT_EQ(parse(canLink(canData(0, 0, 0)))->controller, BusState::error_active);
  EXPECT_EQ(parse(canLink(canData(1, 0, 0)))->controller, BusState::error_warning);
  EXPECT_EQ(parse(canLink(canData(3, 0, 0)))->controller, BusState::bus_off);
  EXPECT_EQ(parse(canLink(canData(4, 0, 0)))->controller, BusState::down);
  EXPECT_FALSE(parse(canLink(canData(77, 0, 0)))->controller);
  EXPECT_TRUE(parse(canLink(canData(0, 0, 0x02)))->listen_only);
  EXPECT_TRUE(parse(canLink(canData(0, 0, 0x01)))->loopback);
  EXPECT_TRUE(parse(canLink(canData(0, 0, 0x08)))->one_shot);
}

TEST(ParseLink, KnowsAnInterfaceWithoutAController) {
  const auto link = parse(
      newLink(0x10041, attribute(3, text("vcan0")) + attribute(18, attribute(1, text("vcan")))));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "vcan");
  EXPECT_FALSE(link->bitrate || link->controller || link->restart_ms || link->transmit_errors);
  EXPECT_FALSE(link->real_controller);
  EXPECT_FALSE(link->events);
}

TEST(ParseLink, TakesWhatTheKernelHasCounted) {
  const Bytes counters = u32(7) + u32(1) + u32(300) + u32(0) + u32(50) + u32(0) + u32(80) + u32(0);
  const auto link = parse(newLink(0x10041, attribute(23, counters + Bytes(160))));  // IFLA_STATS64
  ASSERT_TRUE(link && link->traffic);
  EXPECT_EQ(link->traffic->frames_received, 0x1'0000'0007u);
  EXPECT_EQ(link->traffic->frames_sent, 300u);
  EXPECT_EQ(link->traffic->bytes_received, 50u);
  EXPECT_EQ(link->traffic->bytes_sent, 80u);
  EXPECT_FALSE(parse(newLink(0x10041, attribute(23, Bytes(31))))->traffic);
  EXPECT_FALSE(parse(newLink(0x10041, attribute(3, text("can0"))))->traffic);
}

TEST(ParseLink, DoesNotTakeAnotherKindsNumbersForThoseOfCan) {
  const auto link = parse(canLink(canData(3, 100, 0), "bridge"));
  ASSERT_TRUE(link);
  EXPECT_FALSE(link->controller || link->bitrate || link->events);
}

TEST(ParseLink, SeesAnInterfaceThatIsDown) {
  const auto link = parse(newLink(0x40, attribute(3, text("can0"))));
  EXPECT_FALSE(link->up);
  EXPECT_FALSE(link->carrier);
}

TEST(ParseLink, RefusesOtherMessagesAndSurvivesCutAndBrokenOnes) {
  Bytes error = canLink(canData(0, 0, 0));
  error[4] = 2;  // NLMSG_ERROR
  EXPECT_FALSE(parse(error));
  const Bytes whole = canLink(canData(0, 0, 0));
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(parseLink(whole.data(), size));
  std::mt19937 random(3);
  for (int i = 0; i < 20'000; ++i) {
    Bytes broken = whole;
    for (int j = 0; j < 4; ++j) {
      broken[16 + random() % (broken.size() - 16)] = static_cast<std::uint8_t>(random());
    }
    (void)parse(broken);  // nothing to expect but that it reads within its bytes
  }
}

TEST(RestartRequest, AsksForARestartOfAControllerAndAnAcknowledgement) {
  const Bytes info = Bytes{0, 0, 0, 0} + u32(7) + u32(0) + u32(0);
  const Bytes kind = Bytes{7, 0, 1, 0, 'c', 'a', 'n', 0};
  const Bytes data = Bytes{12, 0, 2, 0, 8, 0, 7, 0, 1, 0, 0, 0};
  const Bytes expected = u32(56) + u16(16) + u16(5) + u32(42) + u32(0) + info +
                         Bytes{24, 0, 18, 0} + kind + data;  // flags: request, acknowledge
  EXPECT_EQ(restartRequest(7, 42), expected);
}

TEST(LinkRequest, AsksForOneInterfaceByName) {
  const Bytes expected = u32(44) + u16(18) + u16(1) + u32(3) + u32(0) + Bytes(16) +
                         Bytes{9, 0, 3, 0, 'c', 'a', 'n', '0', 0, 0, 0, 0};
  EXPECT_EQ(linkRequest("can0", 3), expected);
}

TEST(ParseAcknowledgement, GivesTheErrnoValue) {
  const auto answer = [](std::uint32_t error) {
    const Bytes bytes = u32(36) + u16(2) + u16(0) + u32(42) + u32(0) + u32(error) + Bytes(16);
    return parseAcknowledgement(bytes.data(), bytes.size());
  };
  EXPECT_EQ(answer(0), 0);
  EXPECT_EQ(answer(0xFFFFFFFF), EPERM);
  EXPECT_EQ(answer(0xFFFFFFA1), EOPNOTSUPP);
  const Bytes link = canLink({});
  EXPECT_FALSE(parseAcknowledgement(link.data(), link.size()));
  EXPECT_FALSE(parseAcknowledgement(link.data(), 3));
}

}  // namespace
}  // namespace cia402::can
