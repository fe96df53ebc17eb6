// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/drive/axis_config.h"

namespace cia402::drive {
namespace {

constexpr double kDefaultDeceleration = 5.0;        // rad/s²
constexpr double kDefaultLinearDeceleration = 0.5;  // m/s²

}  // namespace

double stopDeceleration(const AxisConfig& axis) {
  if (axis.limits.acceleration) return *axis.limits.acceleration;
  return axis.geometry.type == AxisGeometry::Type::prismatic ? kDefaultLinearDeceleration
                                                             : kDefaultDeceleration;
}

}  // namespace cia402::drive
