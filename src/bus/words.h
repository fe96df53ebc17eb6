// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Numbers and lists in sentences.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// Adds to a list in a sentence.
inline void append(std::string& list, std::string_view item, std::string_view separator = "; ") {
  if (!list.empty()) list += separator;
  list += item;
}
inline std::string joined(const std::vector<std::string>& items,
                          std::string_view separator = "; ") {
  std::string list;
  for (const std::string& item : items) append(list, item, separator);
  return list;
}

/// "0.25 s". @param format of the number, with one %.*g or the like whose digits are `digits`
inline std::string inUnit(const char* format, int digits, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, digits, value);
  return text;
}
/// "0.25 s", "150 s": as many of six digits as it takes.
inline std::string seconds(Duration duration) { return inUnit("%.*g s", 6, toSeconds(duration)); }
/// "0.250 s".
inline std::string secondsTo(int decimals, Duration duration) {
  return inUnit("%.*f s", decimals, toSeconds(duration));
}
/// "4 ms", "1.25 ms".
inline std::string milliseconds(Duration duration, int digits = 6) {
  return inUnit("%.*g ms", digits, 1e3 * toSeconds(duration));
}

}  // namespace cia402::bus
