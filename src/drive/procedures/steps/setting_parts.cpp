// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/setting_parts.h"

#include <algorithm>

namespace cia402::drive {

namespace {

/// Has the axis given one of the objects, or said that it keeps what the drive has?
bool isGiven(const SettingCheck& check, const AxisConfig& axis) {
  const auto writes = [&](const std::string& name) {
    return std::any_of(axis.writes.begin(), axis.writes.end(), [&](const NamedWrite& write) {
      const ObjectSpec* object = findObject(*axis.profile, write.object);
      return object != nullptr && object->name == name;
    });
  };
  return std::any_of(check.objects.begin(), check.objects.end(), [&](const std::string& name) {
    return writes(name) || contains(axis.keeps, name);
  });
}

}  // namespace

bool concerns(const SettingCheck& check, const AxisConfig& axis) {
  if (check.condition.kind == Condition::Kind::given && isGiven(check, axis)) return false;
  const bool modes = check.modes.empty() ||
                     std::any_of(check.modes.begin(), check.modes.end(),
                                 [&](const auto& mode) { return contains(axis.modes, mode); });
  const bool methods = check.methods.empty() || (axis.homing && axis.homing->method &&
                                                 contains(check.methods, *axis.homing->method));
  return modes && methods && isGiven(check.if_given, axis);
}

std::optional<ResolvedWrite> lastWrite(const AxisConfig& axis, const std::string& object) {
  const ObjectSpec* spec = axis.profile->find(object);
  std::optional<ResolvedWrite> last;
  for (const auto* list : {&axis.profile->startup, &axis.writes}) {
    for (const NamedWrite& write : *list) {
      if (spec == nullptr || findObject(*axis.profile, write.object) != spec || write.when_homed) {
        continue;
      }
      const auto resolved = resolveWrite(write, axis);
      if (resolved && *resolved && !(*resolved)->copied_from) last = **resolved;
    }
  }
  return last;
}

}  // namespace cia402::drive
