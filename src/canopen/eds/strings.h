// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "canopen/eds/text.h"
#include "canopen/eds/value.h"

namespace cia402::canopen {

/// "-1.5e3" independent of the locale; nothing if it is no finite number.
std::optional<double> parseEdsReal(std::string_view text);

/// The text of a value of any length: strings as they are (UNICODE_STRING: UTF-16 on the wire),
/// OCTET_STRING and DOMAIN as hexadecimal bytes with or without blanks. `text` must be UTF-8.
EdsValue stringText(std::string_view text, DataType type);
std::optional<std::string> formatString(const ObjectValue& value, DataType type);

}  // namespace cia402::canopen
