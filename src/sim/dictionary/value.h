// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/common/result.h"
#include "sim/dictionary/object_dictionary.h"

namespace YAML {
class Node;
}

namespace cia402::sim {

/// A default as the file gives it; the node-ID is still to be added where asked for.
struct DefaultValue {
  std::uint64_t number = 0;
  std::vector<std::uint8_t> bytes;
  bool add_node_id = false;
};

/// The text of a scalar; empty for anything else.
std::string textOf(const YAML::Node& node);
/// "0x6040:00", for messages.
std::string hexId(ObjectId id);
/// An integer, decimal or 0x..., with sign. Values up to 2^64 - 1 come as their bit pattern.
std::optional<std::int64_t> parseInteger(const YAML::Node& node);
/// Whether an integer can stand in an object of this type, signed or unsigned.
bool fits(std::int64_t value, DataType type);
/// Whether the number lies within the entry's lowest and highest value.
bool inRange(const Entry& entry);
/// Reads a default for an object of this type (forms: dictionary_yaml.h).
Result<DefaultValue> parseDefault(const YAML::Node& node, DataType type);

}  // namespace cia402::sim
