// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace cia402::fieldbus {

/// How a number sits in an object.
enum class Encoding : std::uint8_t {
  integer,   ///< a plain integer, scaled by the profile's units
  float32,   ///< the bit pattern of an IEEE-754 float in a 32-bit integer object
  bfloat16,  ///< the upper 16 bits of such a pattern in a 16-bit object (value << 16)
  float32_by_65535_unsigned,  ///< 16-bit word n; pattern = n * 65535, n unsigned
  float32_by_65535_signed,    ///< 16-bit word n; pattern = n * 65535, n signed
};

inline float floatFromBits(std::uint32_t bits) {
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

inline std::uint32_t bitsFromFloat(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// The value that a device means by `raw`; NaN for NaN and infinity.
inline double decodeFloat(Encoding encoding, std::uint64_t raw) {
  const auto word = static_cast<std::uint16_t>(raw);
  auto bits = static_cast<std::uint32_t>(raw);
  if (encoding == Encoding::bfloat16) {
    bits = static_cast<std::uint32_t>(word) << 16;
  } else if (encoding == Encoding::float32_by_65535_unsigned) {
    bits = static_cast<std::uint32_t>(word) * 65535U;
  } else if (encoding == Encoding::float32_by_65535_signed) {
    bits = static_cast<std::uint32_t>(static_cast<std::int16_t>(word) * 65535);
  }
  const float value = floatFromBits(bits);
  return std::isfinite(value) ? static_cast<double>(value)
                              : std::numeric_limits<double>::quiet_NaN();
}

/// The 16-bit word whose decoding is nearest to the float `bits`.
inline std::uint16_t halfWord(Encoding encoding, std::uint32_t bits) {
  if (encoding == Encoding::bfloat16) {  // to nearest, ties to even
    return static_cast<std::uint16_t>((std::uint64_t{bits} + 0x7FFF + ((bits >> 16) & 1)) >> 16);
  }
  if (encoding == Encoding::float32_by_65535_unsigned) {
    return static_cast<std::uint16_t>((std::uint64_t{bits} + 32767) / 65535);
  }
  const auto pattern = static_cast<std::int64_t>(static_cast<std::int32_t>(bits));
  return static_cast<std::uint16_t>((pattern + (pattern < 0 ? -32767 : 32767)) / 65535);
}

/// Encodes a value. @return false for NaN, infinity and what overflows; -0.0 and what is too small
/// for the encoding become +0.0.
inline bool encodeFloat(Encoding encoding, double value, std::uint64_t& raw) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (!(std::fabs(value) <= kLargest)) return false;  // NaN, too
  const auto narrow = static_cast<float>(value);
  if (encoding == Encoding::float32) {
    raw = narrow == 0.0F ? 0 : bitsFromFloat(narrow);
    return true;
  }
  if (std::fabs(narrow) < std::numeric_limits<float>::min()) {
    raw = 0;
    return true;
  }
  const std::uint16_t word = halfWord(encoding, bitsFromFloat(narrow));
  const double decoded = decodeFloat(encoding, word);
  if (std::isnan(decoded) || (decoded < 0) != (narrow < 0)) return false;
  raw = word;
  return true;
}

/// `raw` with -0.0 replaced by +0.0: drives report the first and refuse it as a target.
inline std::uint64_t withoutNegativeZero(Encoding encoding, std::uint64_t raw) {
  return encoding != Encoding::integer && decodeFloat(encoding, raw) == 0.0 ? 0 : raw;
}

/// Largest value that the encoding holds.
inline double largestFloat(Encoding encoding) {
  if (encoding == Encoding::float32) return static_cast<double>(std::numeric_limits<float>::max());
  return decodeFloat(encoding, encoding == Encoding::bfloat16 ? 0x7F7F : 0x7F80);
}

/// Lowest value that it holds: not in each encoding the opposite of the largest.
inline double lowestFloat(Encoding encoding) {
  if (encoding == Encoding::float32) return -largestFloat(encoding);
  return decodeFloat(encoding, encoding == Encoding::float32_by_65535_unsigned ? 0xFF80 : 0xFF7F);
}

}  // namespace cia402::fieldbus
