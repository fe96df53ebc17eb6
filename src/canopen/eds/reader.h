// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "canopen/eds/text.h"
#include "canopen/eds/value.h"

namespace cia402::canopen {

/// Turns the sections of an EDS into an object dictionary; a part of CiA 306 a function. Used once.
class EdsReader {
 public:
  EdsReader(const EdsText& text, EdsProblems& problems, Eds& eds, std::optional<NodeId> node_id);
  void read();

 private:
  // eds_info.cpp
  void readFileInfo();
  void readDeviceInfo();
  void readCommissioning();
  void readDummies();
  void readComments();
  const EdsSection* require(const char* name);
  /// The number of a key that is 0 to `highest`; nothing and a problem if it is none.
  std::optional<std::uint64_t> number(const EdsSection& section, const char* key,
                                      std::uint64_t highest);
  std::uint64_t numberOr0(const EdsSection& section, const char* key, std::uint64_t highest);
  bool flag(const EdsSection& section, const char* key) { return numberOr0(section, key, 1) != 0; }
  std::optional<std::uint64_t> numberOf(const EdsKey& key, std::uint64_t highest);

  // eds_objects.cpp
  void sortSections();
  void readObjects();
  void readObject(std::uint16_t index, const EdsSection& section);
  ObjectCode readCode(const EdsSection& section, bool has_entries);
  void readEntries(DictionaryObject& object, const EdsSection* section);
  void adoptOrphans();
  bool hasRoom(unsigned line);

  // eds_entry.cpp
  DictionaryEntry readEntry(const EdsSection& section, ObjectId id, ObjectCode code);
  DataType readType(const EdsSection& section, ObjectCode code);
  DataType definedType(const EdsKey& key, std::uint16_t code);
  Access readAccess(const EdsSection& section, DataType type);
  std::optional<ObjectValue> readValue(const EdsKey* key, DataType type,
                                       bool* adds_node_id = nullptr);
  void readValues(const EdsSection& section, DictionaryEntry& entry);
  void checkLimits(const EdsSection& section, DictionaryEntry& entry);
  void readFiles(const EdsSection& section, DictionaryEntry& entry);

  // eds_compact.cpp
  void expandCompact(DictionaryObject& object, const EdsSection& section, unsigned count);
  void readCompactLists();
  void readCompactList(DictionaryObject& object, const EdsSection& section, char what);
  void addCompactPdos();
  void addCompactPdos(std::uint16_t parameters, std::uint16_t mappings, unsigned wanted);
  void addCompactParameters(std::uint16_t index, unsigned pdo);
  void addCompactMapping(std::uint16_t index, unsigned pdo);

  // eds_lists.cpp
  void readLists();
  void readList(const char* name, std::set<std::uint16_t>& listed);
  void checkListed(const std::set<std::uint16_t>& listed);

  const EdsText& text_;
  EdsProblems& problems_;
  Eds& eds_;
  std::optional<NodeId> wanted_node_id_;
  NodeId node_id_ = 0;
  std::size_t entries_ = 0;
  bool full_ = false;
  std::map<std::uint16_t, const EdsSection*> objects_;
  std::map<std::uint16_t, std::map<std::uint8_t, const EdsSection*>> sub_sections_;
  /// [1018Name], [1018Value], [1018Denotation]: index and first letter of the word.
  std::map<std::pair<std::uint16_t, char>, const EdsSection*> compact_lists_;
};

}  // namespace cia402::canopen
