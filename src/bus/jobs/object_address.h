// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cia402_driver/common/result.h"
#include "drive/axis/config.h"

namespace cia402::bus {

/// An object of a drive as a person has asked for it.
struct AddressedObject {
  fieldbus::ObjectId id;
  std::optional<drive::ObjectSpec> spec;  ///< as profile, EDS or the person name its type
  std::string title;                      ///< "6041:00 statusword"
};

/// Finds "statusword", a name of the EDS, or an index (fieldbus::parseObjectAddress()); for an
/// object that neither profile nor EDS names its type may follow: "2003h:2 u32"
/// (fieldbus::parseTypeWord()). An error, without the axis' name, if there is no such object, or
/// its type is another one, or an index of four digits may be one that YAML has made a number of
/// (fieldbus::isAmbiguousIndex()).
Result<AddressedObject> findObject(const drive::AxisConfig& axis, const std::string& text);

}  // namespace cia402::bus
