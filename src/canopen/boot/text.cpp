// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/boot/text.h"

#include <array>
#include <cinttypes>
#include <cstdio>

namespace cia402::canopen {

std::string objectText(ObjectId object, const std::string& name) {
  return name.empty() ? toString(object) : toString(object) + " " + name;
}

std::string valueText(const Bytes& data) {
  if (data.empty() || data.size() > 8) return std::to_string(data.size()) + " bytes";
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "0x%0*" PRIX64, static_cast<int>(2 * data.size()),
                toUnsigned(data));
  return text.data();
}

std::string hex32(std::uint32_t value) { return valueText(toBytes(value, 4)); }

std::string secondsText(Duration duration) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g s", toSeconds(duration));
  return text.data();
}

}  // namespace cia402::canopen
