// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "canopen/object.h"

namespace cia402::canopen::test {

constexpr ObjectId kStatusword{0x6041, 0}, kControlword{0x6040, 0}, kTarget{0x607A, 0};

}  // namespace cia402::canopen::test
