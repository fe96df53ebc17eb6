// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "canopen/eds/eds.h"
#include "canopen/eds/keys.h"
#include "canopen/eds/problems.h"
#include "canopen/eds/text.h"

namespace cia402::canopen {

/// Reads [FileInfo], [DeviceInfo], [DeviceComissioning], [DummyUsage] and [Comments].
void readEdsInfo(const EdsText& text, EdsKeys& keys, EdsProblems& problems, EdsInfo& info);

}  // namespace cia402::canopen
