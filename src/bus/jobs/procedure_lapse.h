// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "drive/axis/axis.h"

namespace cia402::bus {

/// What is told of an axis as it is, and not of what it does, takes its word.
bool tellsWhatItIs(drive::ProcedureKind kind);
/// Why what a procedure has achieved is not so any more; empty if it is.
/// @param replaced another one was called since
std::string lapse(const drive::ProcedureRequest& request, const drive::Axis& axis, bool replaced);

}  // namespace cia402::bus
