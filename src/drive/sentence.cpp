// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/sentence.h"

#include <array>
#include <cstdio>

namespace cia402::drive {
namespace {
std::string print(const char* format, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}
}  // namespace

std::string seconds(Duration duration) {
  const double value = toSeconds(duration);
  return print(value < 999.5 ? "%.3g s" : "%.0f s", value);  // not "1.2e+03 s"
}

std::string number(double value) { return print("%.3f", value); }

std::string length(double value, bool prismatic) {
  return number(value) + (prismatic ? " m" : " rad");
}

}  // namespace cia402::drive
