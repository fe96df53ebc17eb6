// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace cia402::fieldbus {

/// A value as it travels: little-endian (CiA 301, 7.1.4).
using Bytes = std::vector<std::uint8_t>;

/// A little-endian unsigned number from up to eight bytes; what follows is not looked at.
std::uint64_t toUnsigned(const Bytes& bytes);
/// The number of so many bits, with its sign. @param bits 0 or more than 63: all
std::int64_t toSigned(std::uint64_t raw, unsigned bits);
/// `size` little-endian bytes of `value`, at most eight.
Bytes toBytes(std::uint64_t value, unsigned size);

}  // namespace cia402::fieldbus
