// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/bus.h"

namespace cia402::can {

const char* toString(BusState state) {
  switch (state) {
    case BusState::missing:
      return "missing";
    case BusState::down:
      return "down";
    case BusState::error_active:
      return "error active";
    case BusState::error_warning:
      return "error warning";
    case BusState::error_passive:
      return "error passive";
    case BusState::bus_off:
      return "bus-off";
  }
  return "unknown";
}

}  // namespace cia402::can
