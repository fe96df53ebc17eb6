// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "canopen/eds/eds.h"

namespace cia402::canopen {

/// A whole number of a file: decimal, hexadecimal (0x) or octal (leading 0).
struct EdsNumber {
  bool negative = false;
  bool pattern = false;  ///< hexadecimal or octal: bits rather than a value
  std::uint64_t magnitude = 0;
  std::string note;  ///< what is odd about it, e.g. that it is no octal number in spite of its 0
};
/// @return nothing if `text` is no whole number or has more than 64 bits.
std::optional<EdsNumber> parseEdsNumber(std::string_view text);

/// A value of a file, read as a data type.
struct EdsValue {
  std::optional<ObjectValue> bytes;  ///< nothing: see `error`
  bool adds_node_id = false;
  std::string note;   ///< what was repaired
  std::string error;  ///< why it cannot be taken, with what to write
};
/// Reads the text of DefaultValue, LowLimit, HighLimit and ParameterValue: UTF-8 without blanks
/// around it.
EdsValue parseEdsValue(std::string_view text, DataType type, NodeId node_id);

/// The same in the other direction; nothing if no line of text can hold it.
std::optional<std::string> formatEdsValue(const ObjectValue& value, DataType type);

}  // namespace cia402::canopen
