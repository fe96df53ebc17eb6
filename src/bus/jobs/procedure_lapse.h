// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "drive/axis/axis.h"

namespace cia402::bus {

/// Whether its answer tells what an axis is (its faults, mode or zero), for which its drive has to
/// be heard, and not what the axis does.
bool tellsWhatItIs(drive::ProcedureKind kind);
/// "it moves (velocity 0.3)", of an axis that is not known to stand.
std::string motionOf(const drive::AxisState& state);
/// Why what a procedure has achieved is not so any more; empty if it is.
/// @param replaced another one was called since
std::string lapse(const drive::ProcedureRequest& request, const drive::Axis& axis, bool replaced);

}  // namespace cia402::bus
