// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace cia402::drive {

/// What single numbers of an object mean, in words.
using NumberTexts = std::map<std::int64_t, std::string>;

/// The text of a number; empty where it has none.
inline std::string textOf(const NumberTexts& texts, std::int64_t number) {
  const auto found = texts.find(number);
  return found == texts.end() ? std::string() : found->second;
}

}  // namespace cia402::drive
