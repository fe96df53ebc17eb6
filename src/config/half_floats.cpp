// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Floats of 32 bits that some devices of a family have in 16, of an axis and its node.
#include "config/profile/parts.h"
#include "config/robot_parts.h"

namespace cia402::config {

void readHalfFloatKey(yaml::Section& section, AxisDraft& draft) {
  const auto value = section.get("half_floats");
  if (!value || !draft.device.profile) return;
  draft.device.half_floats = readHalfEncoding(*value);
  if (!draft.device.profile->half_floats.empty()) return;
  value->problem("profile " + draft.axis.profile->name +
                 " has no floats that may be of 16 bits; remove the key");
}

void addHalfFloats(const drive::AxisConfig& axis, const canopen::DeviceConfig& device,
                   canopen::NodeConfig& node) {
  const canopen::DeviceProfile& family = *device.profile;
  for (const std::string& name : family.half_floats) {
    const drive::ObjectSpec* object = axis.profile->find(name);
    if (object == nullptr || drive::saidToLack(axis, name)) continue;
    node.half_floats.push_back(
        {object->id, name, device.half_floats.value_or(family.half_float_encoding)});
  }
}

}  // namespace cia402::config
