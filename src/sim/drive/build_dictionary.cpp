// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/build_dictionary.h"

#include <optional>

namespace cia402::sim {

ObjectDictionary buildDictionary(const DriveDefinition& definition, canopen::NodeId node,
                                 const DriveIdentity& identity) {
  ObjectDictionary built = definition.dictionary.build(node, definition.axisCount());
  const std::optional<std::uint32_t> numbers[] = {identity.vendor, identity.product,
                                                  identity.revision, identity.serial};
  for (std::uint8_t i = 0; i < 4; ++i) {
    Entry* entry = built.find({0x1018, static_cast<std::uint8_t>(i + 1)});
    if (entry == nullptr || !numbers[i]) continue;
    entry->number = entry->initial_number = *numbers[i];
  }
  for (const fieldbus::ObjectId id : definition.own.clamped) {
    if (Entry* entry = built.find(id)) entry->clamps = true;
  }
  return built;
}

}  // namespace cia402::sim
