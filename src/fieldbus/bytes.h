// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace cia402::fieldbus {

/// A value as it travels: little-endian (CiA 301, 7.1.4).
using Bytes = std::vector<std::uint8_t>;

/// A little-endian unsigned number from up to eight bytes; what follows is not looked at.
std::uint64_t toUnsigned(const Bytes& bytes);
/// `size` little-endian bytes of `value`, at most eight.
Bytes toBytes(std::uint64_t value, unsigned size);

}  // namespace cia402::fieldbus
