// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/boot/text.h"

#include "common/text.h"

namespace cia402::canopen {

std::string objectText(ObjectId object, const std::string& name) {
  return name.empty() ? toString(object) : toString(object) + " " + name;
}

std::string valueText(const Bytes& data) {
  if (data.empty() || data.size() > 8) return std::to_string(data.size()) + " bytes";
  return hexText(toUnsigned(data), static_cast<int>(2 * data.size()));
}

}  // namespace cia402::canopen
