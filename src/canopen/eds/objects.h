// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "canopen/eds/eds.h"
#include "canopen/eds/entry.h"
#include "canopen/eds/keys.h"
#include "canopen/eds/problems.h"
#include "canopen/eds/sections.h"

namespace cia402::canopen {

/// Turns the sections of objects and their sub-indices into an object dictionary, up to
/// kMostEdsEntries. Used once.
class EdsObjectReader {
 public:
  /// All must outlive it.
  EdsObjectReader(const EdsSections& sections, EdsEntryReader& entries, EdsKeys& keys,
                  EdsProblems& problems, ObjectDictionary& dictionary)
      : sections_(sections),
        entry_reader_(entries),
        keys_(keys),
        problems_(problems),
        dictionary_(dictionary) {}

  void read();
  /// There was no room for all entries.
  bool full() const { return full_; }

 private:
  void readObject(std::uint16_t index, const EdsSection& section);
  ObjectCode readCode(const EdsSection& section, bool has_entries);
  void readEntries(DictionaryObject& object, const EdsSection* section);
  void expandCompact(DictionaryObject& object, const EdsSection& section, unsigned count);
  void adoptOrphans();
  bool hasRoom(unsigned line);

  const EdsSections& sections_;
  EdsEntryReader& entry_reader_;
  EdsKeys& keys_;
  EdsProblems& problems_;
  ObjectDictionary& dictionary_;
  std::size_t entries_ = 0;
  bool full_ = false;
};

}  // namespace cia402::canopen
