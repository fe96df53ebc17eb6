// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sim/dictionary/template.h"

namespace cia402::sim {

/// Collects the objects of a dictionary file and all that is wrong with it.
class DictionaryReader {
 public:
  /// Notes a problem at the line of `where`.
  void problem(const YAML::Node& where, const std::string& what);
  /// Takes an object, after checks that need no look at the file.
  void add(const YAML::Node& where, Entry entry, bool add_node_id);
  /// One item of the list.
  void readItem(const YAML::Node& item);

  /// Each reads one field, notes a problem and returns false where it is wrong.
  bool readIndex(const YAML::Node& node, std::uint16_t& index);
  bool readType(const YAML::Node& node, DataType& type);
  bool readAccess(const YAML::Node& node, Access& access);
  bool readPdo(const YAML::Node& node, Entry& entry);
  /// Needs the entry's type.
  bool readDefault(const YAML::Node& node, Entry& entry, bool& add_node_id);
  bool readLimit(const YAML::Node& node, DataType type, std::optional<std::int64_t>& limit);

  /// The dictionary, or every problem, one a line.
  Result<DictionaryTemplate> finish() &&;

 private:
  void readObject(const YAML::Node& row);
  bool readSubindex(const YAML::Node& node, std::uint8_t& subindex);
  void checkEntry(const YAML::Node& where, const Entry& entry, bool add_node_id);

  DictionaryTemplate template_;
  std::set<ObjectId> seen_;
  std::vector<std::string> problems_;
};

}  // namespace cia402::sim
