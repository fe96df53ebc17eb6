// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "decode/value_text.h"

namespace cia402::decode {

/// Words for the values of a node's objects, by the axis that each belongs to: those of CiA 402-2
/// tell it by their index, all others are the first one's.
class NodeValues {
 public:
  /// Adds an axis that sits in the node.
  void add(const drive::AxisConfig& axis) { axes_.push_back(std::make_unique<ValueText>(axis)); }
  /// @pre add() was called. @return that of the axis that has the object, else of the first axis
  ValueText& of(fieldbus::ObjectId object) const;
  /// The first one added. @pre add() was called
  const drive::AxisConfig& axis() const { return axes_.front()->axis(); }

  /// As ValueText has them.
  bool lists(fieldbus::ObjectId object) const { return of(object).lists(object); }
  std::string title(fieldbus::ObjectId object) const { return of(object).title(object); }
  std::string describe(fieldbus::ObjectId object, const fieldbus::Bytes& data) const {
    return of(object).describe(object, data);
  }

 private:
  std::vector<std::unique_ptr<ValueText>> axes_;
};

}  // namespace cia402::decode
