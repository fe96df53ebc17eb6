// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cia402::drive {

/// How a family keeps and forgets its parameters where it has other objects for that than 1010h and
/// 1011h (CiA 301).
struct ParameterRecipes {
  /// An object that brings back what the factory has set.
  struct Restore {
    std::string object;      ///< by its name; empty: 1011h does it
    std::int64_t value = 1;  ///< that is written to it
    std::string then;        ///< what is lost by it, and what must follow, in words; or empty
  };
  /// An object that says whether what is written stays without power.
  struct Memory {
    std::string object;  ///< by its name; empty: 1010h saves
    std::int64_t on = 1, off = 0;
  };
  Restore restore;
  Memory memory;
  /// Objects that make the drive do something by being written: neither saved nor loaded.
  std::vector<std::string> commands;
  /// Objects that are loaded after all others, in this order.
  std::vector<std::string> load_last;
};

}  // namespace cia402::drive
