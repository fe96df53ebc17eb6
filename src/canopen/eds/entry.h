// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "canopen/eds/eds.h"
#include "canopen/eds/keys.h"
#include "canopen/eds/problems.h"
#include "canopen/eds/sections.h"
#include "canopen/eds/text.h"

namespace cia402::canopen {

/// Reads the keys that describe one sub-index of an object, or an object without sub-indices (CiA
/// 306): type, access, values.
class EdsEntryReader {
 public:
  /// @param sections where the file defines types of its own. @param node_id for $NODEID
  /// All must outlive it.
  EdsEntryReader(const EdsSections& sections, EdsKeys& keys, EdsProblems& problems, NodeId node_id)
      : sections_(sections), keys_(keys), problems_(problems), node_id_(node_id) {}

  DictionaryEntry read(const EdsSection& section, ObjectId id, ObjectCode code);
  /// The value behind a key that may be missing; nothing and a problem if it is none.
  std::optional<ObjectValue> readValue(const EdsKey* key, DataType type,
                                       bool* adds_node_id = nullptr);

 private:
  DataType readType(const EdsSection& section, ObjectCode code);
  DataType definedType(const EdsKey& key, std::uint16_t code);
  Access readAccess(const EdsSection& section, DataType type);
  void readValues(const EdsSection& section, DictionaryEntry& entry);
  void checkLimits(const EdsSection& section, DictionaryEntry& entry);
  void readFiles(const EdsSection& section, DictionaryEntry& entry);

  const EdsSections& sections_;
  EdsKeys& keys_;
  EdsProblems& problems_;
  NodeId node_id_;
};

}  // namespace cia402::canopen
