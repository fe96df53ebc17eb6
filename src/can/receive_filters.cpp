// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/receive_filters.h"

#include <cstddef>

namespace cia402::can {
namespace {

using Identifiers = std::bitset<2048>;
constexpr std::size_t kMost = 512;  // CAN_RAW_FILTER_MAX of linux/can/raw.h
constexpr std::uint32_t kAllBits = 0x7FF;

/// The largest block of identifiers, a power of two long and aligned to it, that begins at `first`
/// and of which all are in the set.
std::size_t blockAt(std::size_t first, const Identifiers& identifiers) {
  std::size_t size = 1, known = 1;
  while (first % (2 * size) == 0 && first + 2 * size <= identifiers.size()) {
    while (known < 2 * size && identifiers[first + known]) ++known;
    if (known < 2 * size) break;
    size *= 2;
  }
  return size;
}

std::vector<ReceiveFilter> exactFilters(const Identifiers& identifiers) {
  std::vector<ReceiveFilter> filters;
  for (std::size_t id = 0; id < identifiers.size();) {
    if (!identifiers[id]) {
      ++id;
      continue;
    }
    const std::size_t size = blockAt(id, identifiers);
    filters.push_back(
        {static_cast<std::uint32_t>(id), kAllBits & ~static_cast<std::uint32_t>(size - 1), false});
    id += size;
  }
  return filters;
}

/// Every block of `size` of which one is in the set, as a whole.
Identifiers widened(const Identifiers& identifiers, std::size_t size) {
  Identifiers wide;
  for (std::size_t id = 0; id < identifiers.size(); ++id) {
    if (!identifiers[id]) continue;
    for (std::size_t i = id - id % size; i < id - id % size + size; ++i) wide.set(i);
  }
  return wide;
}

}  // namespace

std::vector<ReceiveFilter> receiveFilters(const std::bitset<2048>& identifiers) {
  if (identifiers.all()) return {};
  std::vector<ReceiveFilter> filters = exactFilters(identifiers);
  for (std::size_t size = 2; filters.size() > kMost; size *= 2) {
    filters = exactFilters(widened(identifiers, size));
  }
  return filters;
}

}  // namespace cia402::can
