// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drive/profile/number_texts.h"

namespace cia402::drive {

/// What a whole number of the drive shall be.
struct Condition {
  /// `given`: whatever it is, but the axis must have given it, or say that it keeps it.
  enum class Kind : std::uint8_t { is, is_not, above, below, given };
  Kind kind = Kind::is;
  std::vector<std::int64_t> numbers;  ///< one of these, none of these; above and below: one number
  std::int64_t bits = -1;             ///< those that are looked at; the others count as 0

  bool holds(std::int64_t whole) const;
  /// What is wrong with `number`, after "x is ": "1 instead of 8", "0, not above 0".
  std::string complaint(std::int64_t number) const;
  std::string bitsComplaint(std::int64_t number) const;
};

/// Something that the drive must be set to, or must say, before a motion procedure begins: read
/// then, compared, and told in words; written only where the profile or the axis asks for it.
/// Documented in docs/drive_profiles.md, "Checks".
struct SettingCheck {
  enum class Before : std::uint8_t { enabling, homing };
  enum class Write : std::uint8_t {
    never,
    asked,   ///< where `adjust` of the axis names it
    always,  ///< wherever it differs
  };
  /// One of these must hold the condition; by their names in the profile, whole numbers.
  std::vector<std::string> objects;
  /// Instead: a number stands in one of them at most, but for those of the condition.
  bool each_once = false;
  Condition condition;
  Before before = Before::enabling;
  // When it counts; empty: always.
  std::vector<std::string> modes;  ///< the axis uses one of these
  std::vector<int> methods;        ///< of homing, the axis has one of these
  std::string if_given;            ///< the axis has this value, as NamedWrite::from names it
  std::string unless;              ///< not while this object holds `unless_is`
  Condition unless_is;
  // What follows where it does not hold.
  bool only_warns = false;
  Write write = Write::never;  ///< condition.numbers.front(), then it is read again
  bool power_cycle = false;    ///< what was written counts once power was off
  bool locks = false;          ///< while it does not hold, the drive may refuse what is written
  std::string text, remedy;    ///< what that means, and what to do about it
  NumberTexts texts;           ///< the same for single numbers, instead of `text`

  /// The meaning of a number that it shall not be.
  const std::string& meaning(std::int64_t number) const;
};

}  // namespace cia402::drive
