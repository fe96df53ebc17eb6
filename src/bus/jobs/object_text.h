// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "cia402_driver/common/result.h"
#include "drive/axis/config.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {

/// An object's value for people.
struct ObjectText {
  std::string value;  ///< "1234 (0x000004D2) = 0.0118 rad", "\"DM\""
  double number = std::numeric_limits<double>::quiet_NaN();  ///< in device units
};

/// Words what a drive sent for an object. @param spec nullptr: the profile does not list it.
ObjectText describeObject(const drive::ObjectSpec* spec, const drive::AxisConfig& axis,
                          const fieldbus::Bytes& data);

/// "0.0118 rad", where the profile knows what the object measures; else empty.
std::string inJointUnits(const drive::ObjectSpec& spec, const drive::AxisConfig& axis,
                         const fieldbus::Bytes& data);

/// Bytes in wire order of a number in device units or a text, by the object's type; or why the
/// value cannot be written. An object that holds a float takes the float, or its bits in
/// hexadecimal; NaN and infinity are refused. Octets are given as "01 2A FF".
Result<fieldbus::Bytes> encodeObject(const drive::ObjectSpec& spec, const std::string& value);
/// The same for an object that the profile does not list and whose value is `size` bytes long.
Result<fieldbus::Bytes> encodeUnlisted(const std::string& value, std::size_t size);

/// Bytes as a quoted text if they are printable, else in hexadecimal.
std::string textOf(const fieldbus::Bytes& data);

}  // namespace cia402::bus
