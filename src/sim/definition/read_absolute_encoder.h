// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/absolute_encoder.h"
#include "sim/definition/reader.h"

namespace cia402::sim {

/// The section `absolute_encoder` of a simulated drive's file.
void readAbsoluteEncoder(DefinitionReader& reader, AbsoluteEncoderDefinition& out);

}  // namespace cia402::sim
