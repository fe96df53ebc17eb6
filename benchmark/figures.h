// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cia402::benchmark {

/// Prints a figure: `name value unit`.
void print(const std::string& name, double value, const std::string& unit);

// Each measures one figure and prints it. @return exit status.
int virtualTimeSpeed();
int virtualTimeRepeatable();
int cycleCost();
int groupCost();
int syncLateness();
int sdoBlockDownload();
int sdoBlockUpload();
int bootNodes();

/// Runs `cycles` cycles of `axes` enabled axes for an instruction counter that only looks at
/// cia402_measured_cycle; prints nothing. @return exit status.
int countedCycles(int axes, int cycles);

}  // namespace cia402::benchmark
