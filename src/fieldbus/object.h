// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cia402::fieldbus {

/// Address of an object in a device's object dictionary.
struct ObjectId {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
};

/// Addresses are ordered by index, then by sub-index.
constexpr bool operator==(ObjectId a, ObjectId b) {
  return a.index == b.index && a.subindex == b.subindex;
}
constexpr bool operator!=(ObjectId a, ObjectId b) { return !(a == b); }
constexpr bool operator<(ObjectId a, ObjectId b) {
  return a.index != b.index ? a.index < b.index : a.subindex < b.subindex;
}

/// "6041:00": four and two upper-case hexadecimal digits.
std::string toString(ObjectId object);

/// Reads "6041:00", "0x6041:0", "6041h:0", "0x6041" or "6041" (hexadecimal, sub-index 0 unless
/// given).
std::optional<ObjectId> parseObjectId(std::string_view text);
/// The same, and what YAML makes of such an address where a person has not quoted it: of 0x6041 the
/// number 24641, of 6041:00 the number 362460 (it counts in 60). Both can be told from a
/// hexadecimal index unless they have four digits, see isAmbiguousIndex().
std::optional<ObjectId> parseObjectAddress(std::string_view text);
/// Four decimal digits, from 4096 on: "4120" is index 4120h, or what YAML made of 0x1018.
bool isAmbiguousIndex(std::string_view text);
/// What to write instead: "4120h or, if 0x1018 is meant, 1018h". @pre isAmbiguousIndex(text)
std::string unambiguousIndex(std::string_view text);
/// Is it text in every device that has it: 1008h to 100Ah, device name and versions (CiA 301,
/// 7.5.2.8 to 7.5.2.10)? Of up to four bytes it looks like a number on the wire.
bool isStandardText(ObjectId id);

/// Basic data types of CiA 301, 7.4.7 that can stand in an object dictionary.
enum class DataType : std::uint8_t {
  boolean,
  int8,
  int16,
  int32,
  int64,
  uint8,
  uint16,
  uint32,
  uint64,
  real32,
  real64,
  visible_string,
  octet_string,
  domain,
  int24,
  int40,
  int48,
  int56,
  uint24,
  uint40,
  uint48,
  uint56,
  unicode_string,
  time_of_day,      ///< 48 bits: milliseconds after midnight, days since 1984-01-01
  time_difference,  ///< 48 bits: milliseconds, days
};

/// Size on the wire in bits: 1 for boolean, 8..64 for numbers and times, 0 for types of any length.
unsigned sizeBits(DataType type);
bool isSigned(DataType type);
/// "uint16"; the same words as in profiles.
const char* toString(DataType type);
std::optional<DataType> parseDataType(std::string_view text);
/// The same, and the short words of services and commands: u8 to u64, i8 to i64, f32, f64, text,
/// bytes.
std::optional<DataType> parseTypeWord(std::string_view text);

}  // namespace cia402::fieldbus
