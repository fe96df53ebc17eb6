// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cia402_driver/drive/axis_config.h"

namespace cia402::drive {

/// `profile` with the objects of an EDS: those that it does not name get the EDS' names and types
/// and count in device units; those that it does can be called by the EDS' names, too.
DriveProfile withEds(DriveProfile profile, const AxisEds& eds);

/// Where a profile and an EDS contradict each other. Each sentence names both sources.
struct EdsContradictions {
  std::vector<std::string> problems;  ///< another length: nothing can be sent
  std::vector<std::string> warnings;  ///< another sign, maker or PDO mapping, objects missing
};
/// @param pdos layout that is to be mapped.
EdsContradictions compareWithEds(const DriveProfile& profile, const std::vector<PdoLayout>& pdos,
                                 const AxisEds& eds);

}  // namespace cia402::drive
