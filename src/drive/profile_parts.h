// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cia402_driver/drive/profile_reader.h"

// The parts of a profile file, each read by a function of its own into the profile.
namespace cia402::drive {

/// A unit such as "count/s" or "turn/min"; adds a problem if it does not suit the quantity.
std::optional<UnitSpec> readUnit(const YamlValue& value, Quantity quantity);
void readUnits(const YamlValue& value, DriveProfile& profile);
void readObjects(const YamlValue& value, DriveProfile& profile);
void readEncodings(const YamlValue& value, DriveProfile& profile);
void readCoordinates(const YamlValue& value, DriveProfile& profile);
void readModes(const YamlValue& value, DriveProfile& profile);
void readHoming(const YamlValue& value, DriveProfile& profile);
void readErrors(const YamlValue& value, DriveProfile& profile);

/// The words of `encoding`.
std::optional<Encoding> readEncodingWord(const YamlValue& value);
/// The encoding of ObjectRanges at this place, where the type is as wide; real32 is a float
/// anywhere.
Encoding encodingAt(const DriveProfile& profile, ObjectId id, DataType type);

/// "position"; the words of profiles.
std::optional<Quantity> readQuantity(const YamlValue& value);

/// Smallest and largest whole number that an integer type holds (64 bits: as far as int64 goes).
std::int64_t lowestOf(DataType type);
std::int64_t highestOf(DataType type);

}  // namespace cia402::drive
