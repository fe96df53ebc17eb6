// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/emcy/emergency.h"

namespace cia402::canopen {

std::optional<Emergency> decodeEmergency(const can::Frame& frame, Time stamp) {
  if (frame.size < 2) return std::nullopt;
  Emergency emergency;
  emergency.code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
  if (frame.size > 2) emergency.error_register = frame.data[2];
  for (std::size_t i = 3; i < frame.size; ++i) emergency.vendor[i - 3] = frame.data[i];
  emergency.size = frame.size;
  emergency.stamp = stamp;
  return emergency;
}

}  // namespace cia402::canopen
