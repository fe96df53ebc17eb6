// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

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

  /// The object of a name, whatever the case of its letters; nothing where it is no such name.
  std::optional<fieldbus::ObjectId> find(const std::string& name) const;
  /// "H0A.40"; empty where the object is none of them.
  std::string nameOf(fieldbus::ObjectId id) const;
};

}  // namespace cia402::drive
