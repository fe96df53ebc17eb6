// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cia402::drive {

/// Some bits of an object that are a number of their own.
struct BitField {
  std::string name;
  unsigned low = 0, high = 0;                  ///< first and last bit
  std::map<std::uint64_t, std::string> words;  ///< what its numbers mean
};
/// All that is said of the bits of an object.
using BitFields = std::vector<BitField>;

/// "reaction 3 (the motor is held), code 0x7121": each field with its name, its number, in
/// hexadecimal where it is wider than a byte, and what that means.
std::string fieldsText(const BitFields& fields, std::uint64_t raw);

}  // namespace cia402::drive
