// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/setting_check.h"

#include <algorithm>

#include "common/text.h"

namespace cia402::drive {

bool Condition::holds(std::int64_t whole) const {
  const std::int64_t number = whole & bits;
  switch (kind) {
    case Kind::is:
      return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
    case Kind::is_not:
      return std::find(numbers.begin(), numbers.end(), number) == numbers.end();
    case Kind::above:
      return number > numbers.front();
    case Kind::below:
      return number < numbers.front();
    case Kind::given:
      return false;
  }
  return false;
}

/// "0x0240, of which 0x0010 is 0x0000".
std::string Condition::bitsComplaint(std::int64_t number) const {
  const auto text = [](std::int64_t value) {
    return hexText(static_cast<std::uint64_t>(value), 4);
  };
  return text(number) + ", of which " + text(bits) + " is " + text(number & bits);
}

std::string Condition::complaint(std::int64_t number) const {
  if (bits != -1) return bitsComplaint(number);
  const std::string told = std::to_string(number);
  switch (kind) {
    case Kind::is: {
      std::string wanted;
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (i > 0) wanted += i + 1 < numbers.size() ? ", " : " or ";
        wanted += std::to_string(numbers[i]);
      }
      return told + " instead of " + wanted;
    }
    case Kind::is_not:
      return told + ", which it must not be";
    case Kind::above:
      return told + ", not above " + std::to_string(numbers.front());
    case Kind::below:
      return told + ", not below " + std::to_string(numbers.front());
    case Kind::given:
      return told + ", which nobody has given";
  }
  return told;
}

const std::string& SettingCheck::meaning(std::int64_t number) const {
  const auto own = texts.find(number);
  return own == texts.end() ? text : own->second;
}

}  // namespace cia402::drive
