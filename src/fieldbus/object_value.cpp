// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/text.h"
#include "fieldbus/object_dictionary.h"

namespace cia402::fieldbus {
namespace {

std::uint64_t numberOf(const ObjectValue& value) {
  std::uint64_t number = 0;
  for (std::size_t i = std::min<std::size_t>(value.size(), 8); i-- > 0;) {
    number = number << 8 | value[i];
  }
  return number;
}

std::int64_t signedNumberOf(const ObjectValue& value) {
  const std::uint64_t number = numberOf(value);
  if (value.empty() || value.size() >= 8) return static_cast<std::int64_t>(number);
  const std::uint64_t sign = std::uint64_t{1} << (8 * value.size() - 1);
  return static_cast<std::int64_t>(number ^ sign) - static_cast<std::int64_t>(sign);
}

}  // namespace

double realOf(const ObjectValue& value) {
  const std::uint64_t pattern = numberOf(value);
  if (value.size() == 4) {
    const auto narrow = static_cast<std::uint32_t>(pattern);
    float number = 0.0F;
    std::memcpy(&number, &narrow, sizeof number);
    return static_cast<double>(number);
  }
  double number = 0.0;
  std::memcpy(&number, &pattern, sizeof number);
  return number;
}

namespace {

bool isReal(DataType type) { return type == DataType::real32 || type == DataType::real64; }

template <typename Number>
int order(Number a, Number b) {
  return a < b ? -1 : (b < a ? 1 : 0);
}

}  // namespace

int compareValues(DataType type, const ObjectValue& a, const ObjectValue& b) {
  if (sizeBits(type) == 0) return 0;
  if (isReal(type)) return order(realOf(a), realOf(b));
  if (isSigned(type)) return order(signedNumberOf(a), signedNumberOf(b));
  return order(numberOf(a), numberOf(b));
}

std::string describeValue(DataType type, const ObjectValue& value) {
  if (sizeBits(type) != 0 && value.size() == (sizeBits(type) + 7) / 8) {
    if (isReal(type)) {
      return numberText(realOf(value), 9);
    }
    return isSigned(type) ? std::to_string(signedNumberOf(value)) : std::to_string(numberOf(value));
  }
  const bool printable = std::all_of(value.begin(), value.end(),
                                     [](std::uint8_t byte) { return byte >= ' ' && byte <= '~'; });
  if (printable) return "\"" + std::string(value.begin(), value.end()) + "\"";
  return hexBytes(value.data(), value.size());
}

Result<void> checkWrite(const DictionaryEntry& entry, const ObjectValue& value,
                        const std::string& source) {
  if (!isWritable(entry.access)) {
    return Error{source + " says that it is " + toString(entry.access) + ", not to be written"};
  }
  const unsigned bits = sizeBits(entry.type);
  if (bits == 0) return {};
  if (value.size() != (bits + 7) / 8) {
    return Error{source + " says that it is " + toString(entry.type) + ", not " +
                 std::to_string(value.size()) + " bytes long"};
  }
  if (isReal(entry.type) && !std::isfinite(realOf(value))) {
    return Error{describeValue(entry.type, value) + " is no finite number, and " + source +
                 " says that it is " + toString(entry.type) + "; it is never sent"};
  }
  const bool low = entry.low && compareValues(entry.type, value, *entry.low) < 0;
  const bool high = entry.high && compareValues(entry.type, value, *entry.high) > 0;
  if (!low && !high) return {};
  return Error{describeValue(entry.type, value) + " is " + (low ? "below" : "above") +
               " the limit " + describeValue(entry.type, low ? *entry.low : *entry.high) + " of " +
               source};
}

}  // namespace cia402::fieldbus
