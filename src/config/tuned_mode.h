// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "drive/axis/config.h"
#include "yaml/reader.h"

namespace cia402::config {

/// The axis starts in the mode or is brought into it.
inline bool canBeIn(const drive::AxisConfig& axis, const drive::ModeSpec& mode) {
  return axis.mode == mode.name ||
         std::find(axis.modes.begin(), axis.modes.end(), mode.name) != axis.modes.end();
}

/// The mode of the axis' profile that has `what`, a member of ModeSpec, which a section of the axis
/// tunes. @return nullptr: none has it; where there is the section, `value`, that is a problem:
/// "profile ... has no mode `lacking`; remove the section"
template <typename Member>
const drive::ModeSpec* tunedMode(const drive::AxisConfig& axis, Member what,
                                 const std::optional<yaml::Value>& value, const char* lacking) {
  const auto& modes = axis.profile->modes;
  const auto mode = std::find_if(modes.begin(), modes.end(), [&](const drive::ModeSpec& candidate) {
    return (candidate.*what).has_value();
  });
  if (mode != modes.end()) return &*mode;
  if (value) {
    value->problem("profile " + axis.profile->name + " has no mode " + lacking +
                   "; remove the section");
  }
  return nullptr;
}

}  // namespace cia402::config
