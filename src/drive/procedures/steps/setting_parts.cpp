// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/setting_parts.h"

namespace cia402::drive {

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
