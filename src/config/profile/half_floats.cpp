// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Floats of 32 bits that some devices of a family have in 16.
#include <algorithm>

#include "config/profile/parts.h"

namespace cia402::config {

std::optional<Encoding> readHalfEncoding(const yaml::Value& value) {
  const auto index =
      value.oneOf({"bfloat16", "float32_by_65535_unsigned", "float32_by_65535_signed"});
  if (!index) return {};
  constexpr Encoding kEncodings[] = {Encoding::bfloat16, Encoding::float32_by_65535_unsigned,
                                     Encoding::float32_by_65535_signed};
  return kEncodings[*index];
}

void readHalfFloats(const yaml::Value& value, const DriveProfile& profile,
                    canopen::DeviceProfile& device) {
  yaml::Section section(value);
  if (const auto encoding = section.get("encoding")) {
    device.half_float_encoding = readHalfEncoding(*encoding).value_or(Encoding::bfloat16);
  }
  const auto objects = section.require("objects", "those that may be of 16 bits");
  for (const yaml::Value& entry : objects ? objects->list() : std::vector<yaml::Value>()) {
    const auto name = entry.text();
    if (!name) continue;
    const ObjectSpec* object = profile.find(*name);
    auto& known = device.half_floats;
    if (object == nullptr) {
      entry.problem("the profile has no object `" + *name + "`" +
                    yaml::suggestion(*name, drive::objectNames(profile)));
    } else if (object->encoding != Encoding::float32 || !object->readable) {
      entry.problem("`" + *name + "` is no float32 that the drive lets be read");
    } else if (std::find(known.begin(), known.end(), *name) != known.end()) {
      entry.problem("`" + *name + "` is given twice");
    } else {
      known.push_back(*name);
    }
  }
  section.finish();
}

}  // namespace cia402::config
