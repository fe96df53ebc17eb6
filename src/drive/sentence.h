// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cia402_driver/common/time.h"

namespace cia402::drive {

/// "0.35 s", "2 s".
std::string seconds(Duration duration);
/// A number with three decimals: "-3.050".
std::string number(double value);
/// "-3.050 rad" or "0.120 m".
std::string length(double value, bool prismatic);

}  // namespace cia402::drive
