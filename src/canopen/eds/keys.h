// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "canopen/eds/problems.h"
#include "canopen/eds/text.h"

namespace cia402::canopen {

/// Reads the numbers behind the keys of sections; what is none becomes a problem.
class EdsKeys {
 public:
  /// Must outlive it.
  explicit EdsKeys(EdsProblems& problems) : problems_(problems) {}

  /// The section of this name, as CiA 306 writes it; nullptr and a warning if it is missing.
  const EdsSection* require(const EdsText& text, const char* name);
  /// The number of a key that is 0 to `highest`; nothing and a problem if it is none.
  std::optional<std::uint64_t> numberOf(const EdsKey& key, std::uint64_t highest);
  /// The same of a key that may be missing. @param key in lower case
  std::optional<std::uint64_t> number(const EdsSection& section, const char* key,
                                      std::uint64_t highest);
  /// 0 where it is missing or none.
  std::uint64_t numberOr0(const EdsSection& section, const char* key, std::uint64_t highest);
  bool flag(const EdsSection& section, const char* key) { return numberOr0(section, key, 1) != 0; }

 private:
  EdsProblems& problems_;
};

}  // namespace cia402::canopen
