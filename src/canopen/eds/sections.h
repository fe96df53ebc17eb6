// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "canopen/eds/problems.h"
#include "canopen/eds/text.h"

namespace cia402::canopen {

/// The sections of an EDS by what they describe (CiA 306): objects, sub-indices of objects, lists
/// of what the sub-indices of a compact object are called or hold.
class EdsSections {
 public:
  /// Sections that are unknown, or describe something a second time, become problems.
  /// @param text must outlive it
  EdsSections(const EdsText& text, EdsProblems& problems);

  using SubSections = std::map<std::uint8_t, const EdsSection*>;
  using CompactLists = std::map<std::pair<std::uint16_t, char>, const EdsSection*>;

  /// [1018], by index.
  const std::map<std::uint16_t, const EdsSection*>& objects() const { return objects_; }
  /// [1018sub1] and so on, by index.
  const std::map<std::uint16_t, SubSections>& subSections() const { return sub_sections_; }
  /// The same of one object; nullptr if it has none.
  const SubSections* subSectionsOf(std::uint16_t index) const;
  /// [1018Name], [1018Value], [1018Denotation]: index and first letter of the word.
  const CompactLists& compactLists() const { return compact_lists_; }

 private:
  std::map<std::uint16_t, const EdsSection*> objects_;
  std::map<std::uint16_t, SubSections> sub_sections_;
  CompactLists compact_lists_;
};

}  // namespace cia402::canopen
