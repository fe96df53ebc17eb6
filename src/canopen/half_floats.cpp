// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/half_floats.h"

#include <algorithm>

namespace cia402::canopen {
namespace {

constexpr unsigned kHalf = 2, kWhole = 4;  // bytes

}  // namespace

std::uint16_t halfOf(fieldbus::Encoding encoding, std::uint32_t bits) {
  std::uint64_t word = 0;
  const auto value = static_cast<double>(fieldbus::floatFromBits(bits));
  return fieldbus::encodeFloat(encoding, value, word) ? static_cast<std::uint16_t>(word)
                                                      : std::uint16_t{0};
}

std::uint32_t wholeOf(fieldbus::Encoding encoding, std::uint16_t word) {
  return fieldbus::bitsFromFloat(static_cast<float>(fieldbus::decodeFloat(encoding, word)));
}

const HalfFloat* HalfFloats::find(ObjectId object) const {
  const auto half = std::find_if(found_.begin(), found_.end(),
                                 [object](const HalfFloat& h) { return h.object == object; });
  return half == found_.end() ? nullptr : &*half;
}

Bytes HalfFloats::narrowed(ObjectId object, Bytes data) const {
  const HalfFloat* half = data.size() == kWhole ? find(object) : nullptr;
  if (half == nullptr) return data;
  return toBytes(halfOf(half->encoding, static_cast<std::uint32_t>(toUnsigned(data))), kHalf);
}

Bytes HalfFloats::widened(ObjectId object, Bytes data) const {
  const HalfFloat* half = data.size() == kHalf ? find(object) : nullptr;
  if (half == nullptr) return data;
  return toBytes(wholeOf(half->encoding, static_cast<std::uint16_t>(toUnsigned(data))), kWhole);
}

}  // namespace cia402::canopen
