// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "fieldbus/object.h"

namespace cia402::drive {

/// A stretch of the object dictionary, both ends included.
struct ObjectRange {
  fieldbus::ObjectId first, last;

  bool holds(fieldbus::ObjectId id) const { return !(id < first) && !(last < id); }
  /// How many sub-indices lie between the ends.
  std::uint32_t width() const { return place(last) - place(first); }

 private:
  static std::uint32_t place(fieldbus::ObjectId id) { return id.index * 256U + id.subindex; }
};

/// Reads "2004" (all its sub-indices), "2004:01", "2004:01-03", "2004:01-2006:02" or "2004-2006",
/// hexadecimal. @return nothing for what is none of these or ends before it begins.
std::optional<ObjectRange> parseObjectRange(std::string_view text);

/// What is said of stretches of the dictionary. Where several hold an object, the narrowest counts,
/// of equally narrow ones the last.
template <typename Value>
class ObjectRanges {
 public:
  void add(ObjectRange range, Value value) { entries_.emplace_back(range, value); }
  bool empty() const { return entries_.empty(); }
  /// Moves those that lie in `among` as a whole by `indices`.
  void shift(const ObjectRange& among, std::uint16_t indices) {
    for (auto& [range, value] : entries_) {
      if (!among.holds(range.first) || !among.holds(range.last)) continue;
      range.first.index = static_cast<std::uint16_t>(range.first.index + indices);
      range.last.index = static_cast<std::uint16_t>(range.last.index + indices);
    }
  }
  /// @return nullptr where nothing is said
  const Value* find(fieldbus::ObjectId id) const {
    const std::pair<ObjectRange, Value>* best = nullptr;
    for (const auto& entry : entries_) {
      if (!entry.first.holds(id)) continue;
      if (best == nullptr || entry.first.width() <= best->first.width()) best = &entry;
    }
    return best == nullptr ? nullptr : &best->second;
  }

 private:
  std::vector<std::pair<ObjectRange, Value>> entries_;
};

}  // namespace cia402::drive
