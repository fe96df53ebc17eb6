// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "cia402_driver/common/time.h"

namespace cia402::drive {

/// Commands that people stream to an axis (`~<axis>/command`), as its mode follows them.
struct Stream {
  std::optional<double> command;  ///< the last one, in joint units; nothing: there is none
  Time clock{};                   ///< one period a cycle, however late the cycle is
  Time commanded{};               ///< when the command came, in bus time
  /// A velocity or an effort other than zero was not renewed in time: it is being brought to rest,
  /// or was.
  bool dried_up = false;
  bool at_rest = true;  ///< what the commands lead does not move, or there are none
};

}  // namespace cia402::drive
