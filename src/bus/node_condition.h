// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/condition.h"
#include "bus/snapshot.h"

namespace cia402::bus {

/// How well a node is.
/// @param axis the first one in it
Summary nodeSummaryOf(const AxisSnapshot& axis);

}  // namespace cia402::bus
