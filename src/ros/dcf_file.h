// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/canopen/dcf_draft.h"
#include "cia402_driver/common/result.h"

namespace cia402::ros_node {

/// What a DCF says of itself: the file's name and the present date and time.
/// An error if `path` does not end in .dcf or its folder does not exist.
Result<bus::DcfStamp> dcfStamp(const std::string& axis, const std::string& path);

/// Writes the file as a whole: a reader finds the old one or the new one, never half of it.
/// @return its absolute path.
Result<std::string> writeDcfFile(const std::string& path, const std::string& text);

/// A file that was read.
struct DcfText {
  std::string name;  ///< without its folders
  std::string text;
};
/// An error if `path` does not end in .dcf, cannot be read, or is longer than any DCF.
Result<DcfText> readDcfFile(const std::string& axis, const std::string& path);

}  // namespace cia402::ros_node
