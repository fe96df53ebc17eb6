// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "common/text.h"

#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>

namespace cia402 {
namespace {

/// @param format of the number, with one %.*g or the like whose digits are `digits`
std::string print(const char* format, int digits, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, digits, value);
  return text.data();
}

}  // namespace

void append(std::string& list, std::string_view item, std::string_view separator) {
  if (!list.empty()) list += separator;
  list += item;
}

std::string joined(const std::vector<std::string>& items, std::string_view separator) {
  std::string list;
  for (const std::string& item : items) append(list, item, separator);
  return list;
}

std::string hexText(std::uint64_t value, int digits) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "0x%0*" PRIX64, digits, value);
  return text.data();
}

std::string hexBytes(const std::uint8_t* bytes, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) append(text, hexText(bytes[i], 2).substr(2), " ");
  return text;
}

std::string numberText(double value, int digits) { return print("%.*g", digits, value); }

std::string secondsText(Duration duration) { return numberText(toSeconds(duration)) + " s"; }

std::string secondsText(Duration duration, int decimals) {
  return print("%.*f", decimals, toSeconds(duration)) + " s";
}

std::string millisecondsText(Duration duration, int digits) {
  return numberText(1e3 * toSeconds(duration), digits) + " ms";
}

std::string percentText(double share, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return numberText(std::round(share * 100.0 * unit) / unit) + " %";
}

}  // namespace cia402
