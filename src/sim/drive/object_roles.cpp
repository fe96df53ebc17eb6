// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/object_roles.h"

#include "sim/dictionary/axis_objects.h"

namespace cia402::sim {

std::optional<Role> roleOf(const DriveDefinition& definition, ObjectId object) {
  const ObjectId id = ofFirstAxis(object, definition.axisCount());
  for (const auto& moved : definition.objects) {
    if (moved.second == id) return moved.first;
  }
  return findRole(id);
}

Encoding encodingOf(const DriveDefinition& definition, ObjectId object) {
  const auto special = definition.encodings.find(ofFirstAxis(object, definition.axisCount()));
  if (special != definition.encodings.end()) return special->second;
  const auto role = roleOf(definition, object);
  return role && roleInfo(*role).quantity != Quantity::none ? definition.encoding
                                                            : Encoding::integer;
}

}  // namespace cia402::sim
