// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "bus/fixed_text.h"
#include "cia402_driver/common/time.h"
#include "fieldbus/emergency.h"

namespace cia402::bus {

/// Something that happened on the bus and that people want to read about. What repeats quickly is
/// summed up (RepeatLimiter).
struct Event {
  enum class Severity : std::uint8_t { info, warning, error };
  Severity severity = Severity::info;
  Time stamp{};
  FixedText<384> text;  ///< a sentence that names the axis
};

/// One emergency message, for programs: every single one is handed on.
struct EmergencyEvent {
  std::size_t axis = 0;  ///< index in the configuration
  fieldbus::Emergency emergency;
};

/// Takes events in the bus thread. Never blocks. Emergencies go their own way: a storm of them
/// leaves other news alone.
class EventSink {
 public:
  virtual ~EventSink() = default;
  virtual void onEvent(const Event& event) = 0;
  virtual void onEmergency(const EmergencyEvent&) {}
};

inline void tell(EventSink& events, Event::Severity severity, std::string_view text, Time now) {
  Event event;
  event.severity = severity;
  event.stamp = now;
  event.text.assign(text);
  events.onEvent(event);
}

}  // namespace cia402::bus
