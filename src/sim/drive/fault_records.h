// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/definition/drive_definition.h"
#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

/// The last faults where each stands in objects of its own, with what some objects held when it
/// came (DriveDefinition::fault_records). They stay without power.
class FaultRecords {
 public:
  /// Both must outlive it.
  FaultRecords(const DriveDefinition& definition, ObjectDictionary& dictionary)
      : definition_(definition),
        dictionary_(dictionary),
        records_(definition.fault_records.size()) {}

  /// Power-on or reset: shows what was kept.
  void start() { show(); }
  /// An error comes; warnings are not kept.
  void add(const FaultDefinition& fault);

 private:
  struct Record {
    std::uint64_t code = 0;
    std::vector<std::uint64_t> copies;  ///< in the order of FaultRecordObjects::copies
  };
  void show();

  const DriveDefinition& definition_;
  ObjectDictionary& dictionary_;
  std::vector<Record> records_;  ///< the newest first
};

}  // namespace cia402::sim
