// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/device.h"

namespace cia402::fieldbus {

const char* toString(Health health) {
  switch (health) {
    case Health::absent:
      return "absent";
    case Health::booting:
      return "booting";
    case Health::ready:
      return "ready";
    case Health::failed:
      return "failed";
    case Health::lost:
      break;
  }
  return "lost";
}

}  // namespace cia402::fieldbus
