// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/node_values.h"

#include <algorithm>

namespace cia402::decode {

ValueText& NodeValues::of(fieldbus::ObjectId object) const {
  const auto owner = std::find_if(axes_.begin(), axes_.end(), [&](const auto& axis) {
    return drive::axisOf(object) == axis->axis().device_axis;
  });
  return owner != axes_.end() ? **owner : *axes_.front();
}

}  // namespace cia402::decode
