// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "cia402_driver/common/result.h"
#include "drive/profile/object_range.h"
#include "fieldbus/object.h"

namespace cia402::drive {

/// How the manual of a family calls the parameters of the maker: by a prefix, a group of two digits
/// and a decimal number in it, "H0A.40". The group is added to an index, the number to a sub-index.
struct ParameterNames {
  std::string prefix;         ///< empty: the manual has no such names
  bool hexadecimal = false;   ///< the group; else it is decimal
  std::uint16_t index = 0;    ///< of group 0
  std::uint8_t subindex = 0;  ///< of number 0
  std::uint8_t last_group = 0;
  /// Those that the profile does not name hold whole numbers: of two bytes or four, without a sign
  /// but for `with_sign`.
  bool whole = false;
  ObjectRanges<bool> with_sign;
  ObjectRanges<unsigned> decimals;  ///< digits behind the point that the manual prints of them

  /// The object of a name, whatever the case of its letters; nothing where it is no such name.
  std::optional<fieldbus::ObjectId> find(const std::string& name) const;
  /// "H0A.40"; empty where the object is none of them.
  std::string nameOf(fieldbus::ObjectId id) const;
  /// What such an object of so many bytes holds; nothing where that is not known.
  std::optional<fieldbus::DataType> typeOf(fieldbus::ObjectId id, std::size_t bytes) const;
  /// "480" as the manual prints it: "48.0"; empty where it prints whole numbers.
  std::string printed(fieldbus::ObjectId id, std::int64_t number) const;
  /// "48.0" as the drive counts: "480". Any other text as it is. An error where the drive has no
  /// number for it.
  Result<std::string> counted(fieldbus::ObjectId id, const std::string& text) const;
};

}  // namespace cia402::drive
