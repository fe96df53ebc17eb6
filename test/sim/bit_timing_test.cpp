// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/bit_timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "can/frame_bits.h"

namespace cia402::sim {
namespace {

using can::Frame;

Frame remoteFrame(std::uint32_t id, std::uint8_t length) {
  Frame frame(id, {});
  frame.remote = true;
  frame.size = length;
  return frame;
}

Frame extendedFrame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  Frame frame(id, bytes);
  frame.extended = true;
  return frame;
}

// The standard's wording, bit by bit and with strings: nothing in common with the tables under
// test.
namespace reference {

std::string binary(std::uint32_t value, int bits) {
  std::string text;
  for (int i = bits - 1; i >= 0; --i) text += ((value >> i) & 1U) != 0 ? '1' : '0';
  return text;
}

// Polynomial long division of the message followed by fifteen zeros.
std::string crc(const std::string& message) {
  const std::string divisor = "1100010110011001";  // x15 + x14 + x10 + x8 + x7 + x4 + x3 + 1
  std::string rest = message + std::string(15, '0');
  for (std::size_t i = 0; i < message.size(); ++i) {
    if (rest[i] == '0') continue;
    for (std::size_t k = 0; k < divisor.size(); ++k)
      rest[i + k] = rest[i + k] == divisor[k] ? '0' : '1';
  }
  return rest.substr(message.size());
}

// After every five equal bits on the wire, stuff bits included, one of the other level.
std::string stuffed(const std::string& region) {
  std::string wire;
  for (char bit : region) {
    wire += bit;
    const bool five = wire.size() >= 5 && wire.substr(wire.size() - 5) == std::string(5, bit);
    if (five) wire += bit == '0' ? '1' : '0';
  }
  return wire;
}

unsigned length(const Frame& frame) {
  std::string bits = "0";
  if (frame.extended) {
    bits += binary(frame.id >> 18, 11) + "11" + binary(frame.id & 0x3FFFF, 18);
    bits += std::string(frame.remote ? "1" : "0") + "00";
  } else {
    bits += binary(frame.id, 11) + (frame.remote ? "1" : "0") + "00";
  }
  bits += binary(frame.size, 4);
  for (std::size_t i = 0; i < frame.size && !frame.remote; ++i) bits += binary(frame.data[i], 8);
  const std::string trailer =
      "1"
      "0"
      "1"
      "1111111"
      "111";  // CRC delimiter, ACK, delimiter, EOF, IFS
  return static_cast<unsigned>((stuffed(bits + crc(bits)) + trailer).size());
}

}  // namespace reference

TEST(Crc15, EqualsTheCheckValueOfTheCatalogue) {
  // CRC-15/CAN of the CRC RevEng catalogue: check value of "123456789" is 0x059E.
  const std::uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc15(digits, sizeof digits), 0x059E);
}

TEST(Crc15, OfASingleLastBitIsThePolynomial) {
  const std::uint8_t one = 1;
  EXPECT_EQ(crc15(&one, 1), 0x4599);
}

TEST(NominalBits, AreTheFieldsOfTheStandardAndTheIntermission) {
  // 1 SOF + 12 arbitration + 6 control + 15 CRC + 1 + 2 ACK + 7 EOF + 3 IFS = 47
  EXPECT_EQ(nominalBits(Frame(0x080, {})), 47u);
  EXPECT_EQ(nominalBits(Frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8})), 47u + 64u);
  // 1 SOF + 32 arbitration + 6 control + ... = 67
  EXPECT_EQ(nominalBits(extendedFrame(1, {})), 67u);
  EXPECT_EQ(nominalBits(extendedFrame(1, {0})), 75u);
  EXPECT_EQ(nominalBits(remoteFrame(0x701, 8)), 47u);
}

TEST(WorstCaseBits, AreThoseOfTheLiterature) {
  // Davis, Burns, Bril, Lukkien 2007: 135 bits for eight bytes with 11-bit, 160 with 29-bit
  // identifiers, intermission included; 55 and 80 without data.
  EXPECT_EQ(worstCaseBits(Frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8})), 135u);
  EXPECT_EQ(worstCaseBits(extendedFrame(1, {1, 2, 3, 4, 5, 6, 7, 8})), 160u);
  EXPECT_EQ(worstCaseBits(Frame(0x080, {})), 55u);
  EXPECT_EQ(worstCaseBits(extendedFrame(1, {})), 80u);
}

TEST(ExactBits, OfSyncCountTheStuffBitsOfIdentifierLengthAndCrc) {
  // 0 00010000000 000 0000, CRC 0x1C05 = 001110000000101; stuff bits in brackets:
  // 0000100000(1)00000(1)00000(1)011100000(1)00101: 34 + 4, and 10 + 3.
  EXPECT_EQ(exactBits(Frame(0x080, {})), 51u);
}

TEST(ExactBits, OfAHeartbeat) {
  // 0 11100000001 000 0001 00000101, CRC 0x4D0E = 100110100001110:
  // 011100000(1)00100000(1)0100000(1)101100110100001110: 42 + 3, and 13.
  EXPECT_EQ(exactBits(Frame(0x701, {0x05})), 58u);
}

TEST(ExactBits, OfNmtStartAllNodes) {
  // 0 00000000000 000 0010 00000001 00000000, CRC 0x6197 = 110000110010111:
  // 00000(1)00000(1)00000(1)00100000(1)000100000(1)000110000110010111: 50 + 5, and 13.
  EXPECT_EQ(exactBits(Frame(0x000, {0x01, 0x00})), 68u);
}

TEST(ExactBits, OfAnAlternatingPatternNeedOnlyTheStuffBitsOfLengthAndCrc) {
  // 0 10101010101 000 1000 0101..., CRC 0x1B04 = 001101100000100: the only five in a row lie in it.
  EXPECT_EQ(exactBits(Frame(0x555, {0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55})), 112u);
}

TEST(ExactBits, StuffAfterTheVeryLastBitOfTheCrc) {
  // Remote frame of node guarding: 0 11100000001 100 0001, CRC 0x79E0 = 111100111100000:
  // 011100000(1)001100000(1)1111(0)100111100000(1): the last stuff bit precedes the CRC delimiter.
  EXPECT_EQ(exactBits(remoteFrame(0x701, 1)), 51u);
}

TEST(ExactBits, OfAnExtendedFrame) {
  // 0 00000000000 11 000000000000000001 000 0000, CRC 0x6403 = 110010000000011:
  // 00000(1)00000(1)001100000(1)00000(1)00000(1)00100000(1)001100100000(1)00011: 54 + 7, and 13.
  EXPECT_EQ(exactBits(extendedFrame(1, {})), 74u);
}

TEST(ExactBits, AreNoneForErrorFramesOfTheKernel) {
  Frame error(0x40, {});
  error.error = true;
  EXPECT_EQ(exactBits(error), 0u);
  EXPECT_EQ(nominalBits(error), 0u);
  EXPECT_EQ(worstCaseBits(error), 0u);
}

TEST(ExactBits, EqualABitByBitReferenceForRandomFramesWithinBounds) {
  std::mt19937 generator(402);
  const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
  for (int i = 0; i < 20000; ++i) {
    Frame frame;
    frame.extended = (random() & 1U) != 0;
    frame.remote = random() % 8 == 0;
    frame.id = random() & (frame.extended ? 0x1FFFFFFFU : 0x7FFU);
    if (random() % 4 == 0) frame.id &= random();
    frame.size = static_cast<std::uint8_t>(random() % 9);
    const std::uint32_t style = random() % 3;  // random, many zeros, long runs
    for (auto& byte : frame.data) {
      byte = static_cast<std::uint8_t>(random());
      if (style == 1) byte = static_cast<std::uint8_t>(byte & random() & random());
      if (style == 2) byte = (byte & 1U) != 0 ? 0xFF : 0x00;
    }
    ASSERT_EQ(exactBits(frame), reference::length(frame)) << std::hex << frame.id;
    ASSERT_LE(nominalBits(frame), exactBits(frame));
    ASSERT_LE(exactBits(frame), worstCaseBits(frame));
  }
}

TEST(ExactBits, NeedAtLeastOneStuffBitForTheZerosOfAnEmptyStandardFrame) {
  unsigned fewest_stuff_bits = 99;
  unsigned most_stuff_bits = 0;
  for (std::uint32_t id = 0; id < 0x800; ++id) {
    const Frame frame(id, {});
    const unsigned stuff_bits = exactBits(frame) - nominalBits(frame);
    fewest_stuff_bits = std::min(fewest_stuff_bits, stuff_bits);
    most_stuff_bits = std::max(most_stuff_bits, stuff_bits);
  }
  // RTR, IDE, r0 and the length 0 are seven zeros in a row: one stuff bit at least.
  EXPECT_EQ(fewest_stuff_bits, 1u);
  EXPECT_GE(most_stuff_bits, 4u);
}

TEST(ExactBits, AreThoseThatTheDriverCountsForItself) {
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) {
    Frame frame;
    frame.extended = random() % 4 == 0;
    frame.id = static_cast<std::uint32_t>(random()) & (frame.extended ? 0x1FFFFFFFU : 0x7FFU);
    frame.remote = random() % 8 == 0;
    frame.size = static_cast<std::uint8_t>(random() % 9);
    for (std::uint8_t& byte : frame.data) {
      byte = random() % 2 == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(random());
    }
    ASSERT_EQ(can::wireBits(frame), exactBits(frame)) << i;
  }
}

}  // namespace
}  // namespace cia402::sim
