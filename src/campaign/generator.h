// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/scene.h"

namespace cia402::campaign {

/// A random robot with a random history of so many seconds; the same seed, the same scene.
Scene makeScene(std::uint64_t seed, double seconds);

}  // namespace cia402::campaign
