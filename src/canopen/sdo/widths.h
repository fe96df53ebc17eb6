// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "canopen/object.h"

namespace cia402::canopen {

/// A whole number that a drive holds in more bytes than its profile assumes.
struct LearnedWidth {
  ObjectId object;
  std::size_t assumed = 1, actual = 1;  ///< bytes
  bool is_signed = false;
};

/// Those that were found out of one drive: what is written is made as long as the drive has it,
/// what is read as short as the rest of the program knows it.
class ObjectWidths {
 public:
  void clear() { learned_.clear(); }
  void add(const LearnedWidth& width) { learned_.push_back(width); }

  Bytes toDrive(ObjectId object, Bytes data) const {
    const LearnedWidth* width = find(object);
    if (width == nullptr || data.size() != width->assumed) return data;
    const bool negative = width->is_signed && !data.empty() && (data.back() & 0x80U) != 0;
    data.resize(width->actual, static_cast<std::uint8_t>(negative ? 0xFF : 0));
    return data;
  }
  Bytes fromDrive(ObjectId object, Bytes data) const {
    const LearnedWidth* width = find(object);
    if (width != nullptr && data.size() == width->actual) data.resize(width->assumed);
    return data;
  }

 private:
  const LearnedWidth* find(ObjectId object) const {
    const auto found = std::find_if(learned_.begin(), learned_.end(),
                                    [&](const LearnedWidth& w) { return w.object == object; });
    return found == learned_.end() ? nullptr : &*found;
  }

  std::vector<LearnedWidth> learned_;
};

}  // namespace cia402::canopen
