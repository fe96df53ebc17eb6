// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/object_value.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "common/text.h"
#include "fieldbus/bytes.h"
#include "fieldbus/float_codec.h"

namespace cia402::drive {
namespace {

/// real32 is one without `encoding`, too: nobody has to say twice that it is a float.
Encoding codingOf(DataType type, Encoding encoding) {
  return type == DataType::real32 ? Encoding::float32 : encoding;
}

}  // namespace

bool holdsFloat(DataType type, Encoding encoding) {
  return type == DataType::real64 || codingOf(type, encoding) != Encoding::integer;
}

double floatOf(DataType type, Encoding encoding, std::uint64_t raw) {
  if (type != DataType::real64) return decodeFloat(codingOf(type, encoding), raw);
  double value = 0.0;
  std::memcpy(&value, &raw, sizeof value);
  return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
}

std::optional<std::uint64_t> floatBits(DataType type, Encoding encoding, double value) {
  if (!std::isfinite(value)) return {};
  std::uint64_t raw = 0;
  if (type == DataType::real64) {
    const double positive_zero = value == 0.0 ? 0.0 : value;
    std::memcpy(&raw, &positive_zero, sizeof raw);
    return raw;
  }
  if (!encodeFloat(codingOf(type, encoding), value, raw)) return {};
  return raw;
}

std::int64_t wholeNumber(DataType type, const fieldbus::Bytes& bytes) {
  const std::uint64_t raw = fieldbus::toUnsigned(bytes);
  const auto bits = static_cast<unsigned>(8 * std::min<std::size_t>(bytes.size(), 8));
  return fieldbus::isSigned(type) ? fieldbus::toSigned(raw, bits) : static_cast<std::int64_t>(raw);
}

std::optional<std::uint64_t> sendable(DataType type, Encoding encoding, std::uint64_t raw) {
  if (!holdsFloat(type, encoding)) return raw;
  const double value = floatOf(type, encoding, raw);
  if (std::isnan(value)) return {};
  return value == 0.0 ? 0 : raw;
}

bool ObjectSpec::takes(std::uint64_t raw) const {
  if (!range) return true;
  if (holdsFloat(type, encoding)) return range->holds(floatOf(type, encoding, raw));
  const unsigned bits = fieldbus::sizeBits(type);
  const std::uint64_t number = raw & (~std::uint64_t{0} >> (64 - bits));
  return range->holds(fieldbus::isSigned(type)
                          ? static_cast<double>(fieldbus::toSigned(number, bits))
                          : static_cast<double>(number));
}

std::string ObjectSpec::rangeText() const {
  return range ? numberText(range->low) + " to " + numberText(range->high) : std::string();
}

std::string notFinite(DataType type, std::uint64_t raw) {
  return hexText(raw, static_cast<int>(fieldbus::sizeBits(type) / 4)) +
         " is no finite number in an object that holds a float, and is never sent; give the number "
         "itself, such as 1.5";
}

}  // namespace cia402::drive
