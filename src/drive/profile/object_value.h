// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drive/profile/profile.h"
#include "fieldbus/bytes.h"

namespace cia402::drive {

/// The whole number in an object of that type, as it came over the wire; more than eight bytes give
/// nothing that means anything.
std::int64_t wholeNumber(DataType type, const fieldbus::Bytes& bytes);
/// Does an object hold a float, whatever the drive calls its type?
bool holdsFloat(DataType type, Encoding encoding);
/// The float in an object that holds one, in device units; NaN for NaN and infinity.
double floatOf(DataType type, Encoding encoding, std::uint64_t raw);
/// The bits of a float, in device units. @return nothing for NaN, infinity and what does not fit
std::optional<std::uint64_t> floatBits(DataType type, Encoding encoding, double value);

/// What may be sent of `raw`: itself, but +0.0 for -0.0, and nothing for NaN and infinity in an
/// object that holds a float.
std::optional<std::uint64_t> sendable(DataType type, Encoding encoding, std::uint64_t raw);
/// Why sendable() gives nothing: "0xFFFFFFFF is no finite number in an object that holds a float,
/// ...".
std::string notFinite(DataType type, std::uint64_t raw);

}  // namespace cia402::drive
