// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/parameter_names.h"

#include <algorithm>
#include <cctype>

namespace cia402::drive {
namespace {

constexpr char kDigits[] = "0123456789ABCDEF";

char upper(char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); }

/// A number of two or three digits; nothing where it is none.
std::optional<unsigned> numberOf(const std::string& text, unsigned base) {
  if (text.size() < 2 || text.size() > 3) return {};
  unsigned number = 0;
  for (const char c : text) {
    const auto digit =
        static_cast<unsigned>(std::find(kDigits, kDigits + base, upper(c)) - kDigits);
    if (digit >= base) return {};
    number = number * base + digit;
  }
  return number;
}

std::string twoDigits(unsigned number, unsigned base) {
  std::string text = {kDigits[number / base % base], kDigits[number % base]};
  return number < base * base ? text : kDigits[number / base / base] + text;
}

}  // namespace

std::optional<fieldbus::ObjectId> ParameterNames::find(const std::string& name) const {
  const std::size_t length = prefix.size();
  const std::size_t point = name.find('.');
  if (length == 0 || point == std::string::npos || point < length) return {};
  const bool begins = std::equal(prefix.begin(), prefix.end(), name.begin(),
                                 [](char a, char b) { return upper(a) == upper(b); });
  const auto group = numberOf(name.substr(length, point - length), hexadecimal ? 16 : 10);
  const auto number = numberOf(name.substr(point + 1), 10);
  if (!begins || !group || *group > last_group || !number || *number + subindex > 0xFF) return {};
  return fieldbus::ObjectId{static_cast<std::uint16_t>(index + *group),
                            static_cast<std::uint8_t>(subindex + *number)};
}

std::string ParameterNames::nameOf(fieldbus::ObjectId id) const {
  const bool within =
      id.index >= index && id.index <= index + last_group && id.subindex >= subindex;
  if (prefix.empty() || !within) return {};
  return prefix + twoDigits(static_cast<unsigned>(id.index - index), hexadecimal ? 16 : 10) + "." +
         twoDigits(static_cast<unsigned>(id.subindex - subindex), 10);
}

std::optional<fieldbus::DataType> ParameterNames::typeOf(fieldbus::ObjectId id,
                                                         std::size_t bytes) const {
  using fieldbus::DataType;
  if (!whole || nameOf(id).empty() || (bytes != 2 && bytes != 4)) return {};
  if (with_sign.find(id) != nullptr) return bytes == 2 ? DataType::int16 : DataType::int32;
  return bytes == 2 ? DataType::uint16 : DataType::uint32;
}

std::string ParameterNames::printed(fieldbus::ObjectId id, std::int64_t number) const {
  const unsigned* const behind = decimals.find(id);
  if (behind == nullptr) return {};
  std::string digits = std::to_string(number < 0 ? -number : number);
  if (digits.size() <= *behind) digits.insert(0, *behind + 1 - digits.size(), '0');
  digits.insert(digits.size() - *behind, 1, '.');
  return (number < 0 ? "-" : "") + digits;
}

Result<std::string> ParameterNames::counted(fieldbus::ObjectId id, const std::string& text) const {
  const unsigned* const behind = decimals.find(id);
  const std::size_t point = text.find('.');
  const bool plain = text.find_first_not_of("0123456789.-") == std::string::npos;
  if (behind == nullptr || point == std::string::npos || !plain) return text;
  std::string after = text.substr(point + 1);
  const std::size_t last = after.find_last_not_of('0');
  after.resize(last == std::string::npos ? 0 : last + 1);
  if (after.size() > *behind) {
    return Error{text + " has more than the " + std::to_string(*behind) +
                 " digits behind the point that the drive counts by"};
  }
  after.append(*behind - after.size(), '0');
  const bool negative = text[0] == '-';
  std::string digits = text.substr(negative ? 1 : 0, point - (negative ? 1 : 0)) + after;
  const std::size_t first = digits.find_first_not_of('0');
  digits.erase(0, first == std::string::npos ? digits.size() - 1 : first);
  return (negative ? "-" : "") + digits;
}

}  // namespace cia402::drive
