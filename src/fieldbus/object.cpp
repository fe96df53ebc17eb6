// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/object.h"

#include <array>
#include <charconv>
#include <cstdio>

namespace cia402::fieldbus {
namespace {

struct TypeRow {
  DataType type;
  const char* name;
  unsigned bits;
  bool is_signed;
};

// In the order of DataType.
constexpr std::array<TypeRow, 25> kTypes{{
    {DataType::boolean, "boolean", 1, false},
    {DataType::int8, "int8", 8, true},
    {DataType::int16, "int16", 16, true},
    {DataType::int32, "int32", 32, true},
    {DataType::int64, "int64", 64, true},
    {DataType::uint8, "uint8", 8, false},
    {DataType::uint16, "uint16", 16, false},
    {DataType::uint32, "uint32", 32, false},
    {DataType::uint64, "uint64", 64, false},
    {DataType::real32, "real32", 32, true},
    {DataType::real64, "real64", 64, true},
    {DataType::visible_string, "visible_string", 0, false},
    {DataType::octet_string, "octet_string", 0, false},
    {DataType::domain, "domain", 0, false},
    {DataType::int24, "int24", 24, true},
    {DataType::int40, "int40", 40, true},
    {DataType::int48, "int48", 48, true},
    {DataType::int56, "int56", 56, true},
    {DataType::uint24, "uint24", 24, false},
    {DataType::uint40, "uint40", 40, false},
    {DataType::uint48, "uint48", 48, false},
    {DataType::uint56, "uint56", 56, false},
    {DataType::unicode_string, "unicode_string", 0, false},
    {DataType::time_of_day, "time_of_day", 48, false},
    {DataType::time_difference, "time_difference", 48, false},
}};

constexpr bool isInOrder() {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (static_cast<std::size_t>(kTypes[i].type) != i) return false;
  }
  return static_cast<std::size_t>(DataType::time_difference) + 1 == kTypes.size();
}
static_assert(isInOrder(), "one row for each type, found by its number");

const TypeRow& row(DataType type) { return kTypes[static_cast<std::size_t>(type)]; }

std::optional<unsigned> parseNumber(std::string_view text, int base, unsigned max) {
  unsigned value = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value, base);
  if (parsed.ec != std::errc() || parsed.ptr != end || value > max) return {};
  return value;
}

std::optional<unsigned> parseHex(std::string_view text, unsigned max) {
  if (text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    text.remove_prefix(2);
  } else if (text.size() > 1 && (text.back() == 'h' || text.back() == 'H')) {
    text.remove_suffix(1);
  }
  return parseNumber(text, 16, max);
}

// YAML 1.1 takes digits with a colon for a number to the base of 60. The smallest index, 1000:00,
// makes 60000, which as an index would be EA60h: CiA 301 reserves C000h to FFFFh.
constexpr unsigned kSmallestBase60 = 60000, kLargestBase60 = 9999 * 60 + 59;
constexpr unsigned kLastIndex = 0xBFFF;

/// Of an address that YAML has made a number of five or six decimal digits of.
std::optional<ObjectId> parseYamlNumber(std::string_view text) {
  const std::optional<unsigned> number =
      text.size() > 4 ? parseNumber(text, 10, kLargestBase60) : std::nullopt;
  if (!number || text.front() == '0') return {};
  if (*number <= kLastIndex) return ObjectId{static_cast<std::uint16_t>(*number), 0};
  if (*number < kSmallestBase60) return {};
  // The digits that stood there were hexadecimal ones.
  const auto index = parseHex(std::to_string(*number / 60), 0xFFFF);
  const auto subindex = parseHex(std::to_string(*number % 60), 0xFF);
  return ObjectId{static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*subindex)};
}

}  // namespace

std::string toString(ObjectId object) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%04X:%02X", static_cast<unsigned>(object.index),
                static_cast<unsigned>(object.subindex));
  return text.data();
}

bool isStandardText(ObjectId id) {
  return id.index >= 0x1008 && id.index <= 0x100A && id.subindex == 0;
}

std::optional<ObjectId> parseObjectId(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::optional<unsigned> index = parseHex(text.substr(0, colon), 0xFFFF);
  const std::optional<unsigned> subindex =
      colon == std::string_view::npos ? 0U : parseHex(text.substr(colon + 1), 0xFF);
  if (!index || !subindex) return {};
  return ObjectId{static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*subindex)};
}

std::optional<ObjectId> parseObjectAddress(std::string_view text) {
  const std::optional<ObjectId> object = parseObjectId(text);
  return object ? object : parseYamlNumber(text);
}

bool isAmbiguousIndex(std::string_view text) {
  return text.size() == 4 && parseNumber(text, 10, 9999).value_or(0) >= 0x1000;
}

std::string unambiguousIndex(std::string_view text) {
  const std::string meant =
      toString(ObjectId{static_cast<std::uint16_t>(parseNumber(text, 10, 9999).value_or(0)), 0})
          .substr(0, 4);
  return std::string(text) + "h or, if 0x" + meant + " is meant, " + meant + "h";
}

unsigned sizeBits(DataType type) { return row(type).bits; }
bool isSigned(DataType type) { return row(type).is_signed; }
const char* toString(DataType type) { return row(type).name; }

std::optional<DataType> parseDataType(std::string_view text) {
  for (const TypeRow& candidate : kTypes) {
    if (text == candidate.name) return candidate.type;
  }
  return {};
}

std::optional<DataType> parseTypeWord(std::string_view text) {
  if (text == "text") return DataType::visible_string;
  if (text == "bytes") return DataType::octet_string;
  if (text == "f32") return DataType::real32;
  if (text == "f64") return DataType::real64;
  const bool letter = text.size() > 1 && (text.front() == 'u' || text.front() == 'i');
  const bool is_short = letter && text[1] >= '1' && text[1] <= '9';
  if (!is_short) return parseDataType(text);
  return parseDataType((text.front() == 'u' ? "uint" : "int") + std::string(text.substr(1)));
}

}  // namespace cia402::fieldbus
