// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/write_guard.h"

#include <algorithm>

#include "fieldbus/abort_code.h"
#include "sim/dictionary/axis_objects.h"

namespace cia402::sim {
namespace {

namespace abort_code = fieldbus::abort_code;

std::int64_t valueOf(const Entry& entry, std::uint64_t number) {
  if (!fieldbus::isSigned(entry.type)) return static_cast<std::int64_t>(number);
  Entry candidate = entry;
  candidate.number = number;
  return asSigned(candidate);
}

std::uint32_t refuseMode(const DriveDefinition& definition, const WriteSituation& situation,
                         std::int64_t mode) {
  if (definition.mode(mode) == nullptr) return abort_code::kInvalidValue;
  const bool locked = situation.enabled && !definition.mode_change_while_enabled;
  return mode != situation.mode && locked ? abort_code::kDeviceState : 0;
}

}  // namespace

std::uint32_t refuseWrite(const DriveDefinition& definition, const DriveValues& values,
                          const WriteSituation& situation, const Entry& entry,
                          std::uint64_t number) {
  const std::int64_t value = valueOf(entry, number);
  if (values.entry(Role::mode) == &entry) return refuseMode(definition, situation, value);
  const ObjectId id = ofFirstAxis(entry.id, definition.axisCount());
  const bool of_homing = id.index == 0x6098 || id.index == 0x6099;
  if (definition.quirks.homing_is_fixed && of_homing) return abort_code::kReadOnly;
  if (values.entry(Role::homing_method) == &entry) {
    const auto among = [value](const std::vector<std::int64_t>& methods) {
      return std::find(methods.begin(), methods.end(), value) != methods.end();
    };
    return among(definition.homing.methods) || among(definition.homing.inert)
               ? 0
               : abort_code::kInvalidValue;
  }
  if (values.entry(Role::save_zero) == &entry && situation.powered) {
    return abort_code::kDeviceState;
  }
  const auto& locked = definition.locked_while_enabled;
  const bool is_locked = std::find(locked.begin(), locked.end(), id) != locked.end();
  return is_locked && situation.enabled ? abort_code::kDeviceState : 0;
}

}  // namespace cia402::sim
