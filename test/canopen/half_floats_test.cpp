// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/half_floats.h"

#include <gtest/gtest.h>

namespace cia402::canopen {
namespace {

using fieldbus::Encoding;

struct Word {
  Encoding encoding;
  std::uint16_t word;
  std::uint32_t bits;  ///< that it stands for
};

// Computed from the rules of the Damiao manual [L30-36]: n << 16; n * 65535, unsigned or signed.
constexpr Word kWords[] = {
    {Encoding::bfloat16, 0x3E99, 0x3E990000},
    {Encoding::bfloat16, 0xBF80, 0xBF800000},
    {Encoding::float32_by_65535_unsigned, 0x3E99, 0x3E98C167},  // printed
    {Encoding::float32_by_65535_unsigned, 0xBF80, 0xBF7F4080},
    {Encoding::float32_by_65535_signed, 0x3E99, 0x3E98C167},
    {Encoding::float32_by_65535_signed, 0xBF80, 0xBF804080},
};

TEST(HalfFloats, StandForTheirBitsAndComeBackAsTheSameWord) {
  for (const Word& tested : kWords) {
    EXPECT_EQ(wholeOf(tested.encoding, tested.word), tested.bits) << std::hex << tested.word;
    EXPECT_EQ(halfOf(tested.encoding, tested.bits), tested.word) << std::hex << tested.bits;
  }
}

TEST(HalfFloats, NeverBecomeMinusZeroOrWhatIsNoNumber) {
  for (const Encoding encoding : {Encoding::bfloat16, Encoding::float32_by_65535_unsigned,
                                  Encoding::float32_by_65535_signed}) {
    for (const std::uint32_t bits : {0x80000000U, 0x7FC00000U, 0x7F800000U, 0x80000001U}) {
      EXPECT_EQ(halfOf(encoding, bits), 0U) << std::hex << bits;
    }
  }
}

TEST(HalfFloats, AreNarrowOnTheWireAlone) {
  HalfFloats halves;
  const ObjectId torque{0x6071, 0}, other{0x607A, 0};
  EXPECT_EQ(halves.narrowed(torque, {0, 0, 0x80, 0x3F}), (Bytes{0, 0, 0x80, 0x3F}));
  halves.add({torque, "target_torque", Encoding::bfloat16});
  EXPECT_EQ(halves.narrowed(torque, {0, 0, 0x80, 0x3F}), (Bytes{0x80, 0x3F}));
  EXPECT_EQ(halves.widened(torque, {0x80, 0x3F}), (Bytes{0, 0, 0x80, 0x3F}));
  EXPECT_EQ(halves.widened(torque, {0, 0, 0x80, 0x3F}), (Bytes{0, 0, 0x80, 0x3F}));
  EXPECT_EQ(halves.narrowed(other, {0, 0, 0x80, 0x3F}), (Bytes{0, 0, 0x80, 0x3F}));
  EXPECT_EQ(halves.widened(other, {0x80, 0x3F}), (Bytes{0x80, 0x3F}));
  halves.clear();
  EXPECT_EQ(halves.narrowed(torque, {0, 0, 0x80, 0x3F}), (Bytes{0, 0, 0x80, 0x3F}));
}

}  // namespace
}  // namespace cia402::canopen
