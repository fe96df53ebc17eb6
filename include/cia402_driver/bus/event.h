// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "cia402_driver/bus/fixed_text.h"
#include "cia402_driver/canopen/emergency.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

/// Something that happened on the bus and that people want to read about.
struct Event {
  enum class Severity : std::uint8_t { info, warning, error };
  Severity severity = Severity::info;
  Time stamp{};
  bool is_emergency = false;
  std::size_t axis = 0;          ///< valid if is_emergency
  canopen::Emergency emergency;  ///< valid if is_emergency
  FixedText<384> text;           ///< a sentence that names the axis
};

/// Takes events in the bus thread. Never blocks.
class EventSink {
 public:
  virtual ~EventSink() = default;
  virtual void onEvent(const Event& event) = 0;
};

}  // namespace cia402::bus
