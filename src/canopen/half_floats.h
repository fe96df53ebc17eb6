// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canopen/object.h"
#include "fieldbus/float_codec.h"

namespace cia402::canopen {

/// An object that holds a float in the 32 bits of an integer, but in 16 in some devices of its
/// family.
struct HalfFloat {
  ObjectId object;
  std::string name;                                            ///< for messages
  fieldbus::Encoding encoding = fieldbus::Encoding::bfloat16;  ///< of the 16 bits
};

/// The floats that the device at hand has in 16 bits. Everybody in this program knows them in 32;
/// only on the wire they are short.
class HalfFloats {
 public:
  void clear() { found_.clear(); }
  void add(const HalfFloat& half) { found_.push_back(half); }
  const std::vector<HalfFloat>& found() const { return found_; }
  bool has(ObjectId object) const { return find(object) != nullptr; }

  /// What to write for a value of four bytes, in wire order; others stay as they are.
  Bytes narrowed(ObjectId object, Bytes data) const;
  /// What a value of two bytes means in four, in wire order; others stay as they are.
  Bytes widened(ObjectId object, Bytes data) const;

 private:
  const HalfFloat* find(ObjectId object) const;

  std::vector<HalfFloat> found_;
};

/// The 16-bit word of a float's bits; what it cannot hold is 0.
std::uint16_t halfOf(fieldbus::Encoding encoding, std::uint32_t bits);
/// The float's bits of a 16-bit word.
std::uint32_t wholeOf(fieldbus::Encoding encoding, std::uint16_t word);

}  // namespace cia402::canopen
