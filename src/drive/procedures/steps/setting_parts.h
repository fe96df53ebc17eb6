// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "drive/axis/config.h"
#include "drive/profile/named_write.h"

namespace cia402::drive {

template <typename Value>
bool contains(const std::vector<Value>& values, const Value& value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

/// "control_mode (2002:01)".
inline std::string settingTitle(const ObjectSpec& object) {
  return object.name + " (" + fieldbus::toString(object.id) + ")";
}

/// Does the check count for what the axis uses?
bool concerns(const SettingCheck& check, const AxisConfig& axis);

/// The last thing that the boot writes to an object, by its name in the profile; nothing where that
/// is not a number, or follows the joint's zero.
std::optional<ResolvedWrite> lastWrite(const AxisConfig& axis, const std::string& object);

}  // namespace cia402::drive
