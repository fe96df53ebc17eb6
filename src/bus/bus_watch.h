// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bus/event.h"
#include "bus/fixed_text.h"
#include "bus/network.h"
#include "bus/repeat_limiter.h"
#include "can/bus.h"

namespace cia402::bus {

/// Watches the CAN interface for a network: starts it once the bus is there, tells it when the
/// bus is lost and when it is back, and puts every change into words. Changes that come too fast to
/// be read are summed up.
class BusWatch {
 public:
  explicit BusWatch(EventSink& events) : events_(events) {}

  /// To be called often; allocates only when something has changed, or is not well.
  /// @return the state in which the bus was lost and came back since the last call, unseen but for
  /// the interface's counters; usually none.
  std::optional<can::BusState> update(const can::Interface& interface, Network& network, Time now);
  /// The interface in words, as of at most 0.2 s ago.
  std::string_view text() const { return text_.view(); }

 private:
  std::optional<can::BusState> unseenLoss(const can::Interface& interface);
  void onUnseenLoss(can::BusState through, const can::Interface& interface, Network& network,
                    Time now);
  void onChange(const can::Interface& interface, Network& network, Time now);
  void tell(Event::Severity severity, const std::string& text, Time now);

  EventSink& events_;
  can::BusState state_ = can::BusState::missing;
  bool known_ = false;                                 // state_ is
  std::uint64_t bus_offs_ = 0, interface_losses_ = 0;  // counted at the last look
  RepeatLimiter limit_;
  FixedText<512> text_;
  FixedText<256> remedy_;  // told last
  Time refreshed_{};
};

}  // namespace cia402::bus
