// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "campaign/scene.h"

namespace cia402::campaign {

/// Does a scene still show what it was kept for?
using Shows = std::function<bool(const Scene&)>;

/// Makes a scene smaller while it still `shows` the same: fewer actions, fewer and simpler axes,
/// shorter waits, rounder numbers. Calls `shows` at most `tries` times.
Scene shrink(Scene scene, const Shows& shows, int tries = 2000);

}  // namespace cia402::campaign
