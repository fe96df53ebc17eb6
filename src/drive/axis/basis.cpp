// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/basis.h"

#include <utility>

namespace cia402::drive {

AxisBasis::AxisBasis(AxisConfig axis_config, fieldbus::Device& its_device)
    : config(std::move(axis_config)),
      device(its_device),
      image(its_device.image()),
      objects(config, its_device) {}

}  // namespace cia402::drive
