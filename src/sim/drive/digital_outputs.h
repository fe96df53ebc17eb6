// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canopen/nmt/nmt.h"
#include "sim/definition/drive_definition.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// What outputs can tell of an axis.
struct OutputSituation {
  canopen::NmtState nmt;
  std::uint16_t statusword;
  bool powered;     ///< its motor
  double velocity;  ///< turns/s
};

/// Digital outputs that are on at their terminals, in the bits of 60FEh: what is commanded, where
/// the terminal shows that, and what functions and the maker's parameters make of it.
std::uint32_t outputsAtTerminals(const DriveDefinition& definition, const DriveValues& values,
                                 const OutputSituation& situation);

}  // namespace cia402::sim
