// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cia402_driver/drive/profile.h"
#include "cia402_driver/drive/yaml_reader.h"

namespace cia402::drive {

/// Where a list of writes stands; decides what its entries may do.
enum class WriteList : std::uint8_t {
  boot,     ///< fixed before the drive is asked anything: values, no copies of other objects
  running,  ///< done by the axis: may copy another object
};

/// Reads a list of writes (docs/drive_profiles.md, "Writes"); what is wrong adds problems. By index
/// (`object: "6065:00"`) a value is the drive's own whole number; by name it is in SI units.
std::vector<NamedWrite> readWrites(const YamlValue& list, const DriveProfile& profile,
                                   WriteList kind);

/// May two PDOs of one direction carry the same object?
enum class Sharing : std::uint8_t { refused, allowed };

/// Reads a PDO layout (docs/drive_profiles.md, "PDOs") against the objects and limits of a profile.
std::vector<PdoLayout> readPdos(const YamlValue& value, const DriveProfile& profile,
                                Sharing sharing = Sharing::refused);

/// Reads a list of sub-indices of 1010h or 1011h into `subindices`, which keeps what it has if the
/// key is missing or wrong.
void readSubindices(YamlSection& section, const std::string& key,
                    std::vector<std::uint8_t>& subindices);

/// Reads a list of the profile's modes; canonical names.
std::vector<std::string> readModeNames(const YamlValue& list, const DriveProfile& profile);
/// Reads a list of objects that can be in a TPDO; their profile names.
std::vector<std::string> readFeedbackNames(const YamlValue& list, const DriveProfile& profile);

/// The object that a name or an index ("6041:00") means; nullptr if the profile has none.
const ObjectSpec* findObject(const DriveProfile& profile, const std::string& name);

/// "profile generic_cia402", and the EDS that it was widened by.
std::string sourceOf(const DriveProfile& profile);

/// Names of all objects, for suggestions.
std::vector<std::string> objectNames(const DriveProfile& profile);

}  // namespace cia402::drive
