// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>

#include "sim/definition/memory.h"
#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

/// Store and restore parameters (1010h, 1011h; CiA 301, 7.5.2.13 and 7.5.2.14): sub 1 all, 2
/// communication, 3 profile, 4 manufacturer. "save" makes the present values those after power-on,
/// "load" brings the factory's back at the next power-on or reset. Other signatures are refused
/// with 0x08000020, and everything while the drive is enabled with 0x08000022. Controlword and
/// set-points are never stored. A write that changes a parameter sets 1020h, the date and time of
/// the configuration, to 0 (7.5.2.18).
class ParameterStore {
 public:
  /// Installs itself where `dictionary` has 1010h and 1011h; both must outlive it.
  /// @param memory of its own; must outlive it. @param axes of the device. @param enabled whether
  /// one of them is.
  /// @param stored is called after a "save".
  ParameterStore(ObjectDictionary& dictionary, const MemoryDefinition& memory, unsigned axes,
                 std::function<bool()> enabled, std::function<void()> stored);
  /// What a "load" into the sub-index does.
  void restore(std::uint8_t subindex);
  /// The default of an object moves with the node-ID; what was saved in its place stays.
  void moveDefault(ObjectId id, std::int64_t by);
  /// A write is about to be taken, which stays where MemoryDefinition::keeps says so.
  void keep(const Entry& entry, std::uint64_t number);
  /// By what it was switched on with it neither hears the bus nor is heard.
  bool silent() const;
  ParameterStore(const ParameterStore&) = delete;
  ParameterStore& operator=(const ParameterStore&) = delete;

 private:
  void changed(const Entry& entry);
  void install(std::uint16_t index, std::uint64_t signature);
  void store(std::uint8_t subindex);

  bool isParameter(const Entry& entry) const;
  void resetByObject();

  ObjectDictionary& dictionary_;
  const MemoryDefinition& memory_;
  unsigned axes_;
  std::function<bool()> enabled_;
  std::function<void()> stored_;
  std::map<ObjectId, std::uint64_t> factory_;
};

}  // namespace cia402::sim
