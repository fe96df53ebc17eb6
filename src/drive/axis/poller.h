// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>

#include "drive/axis/signal.h"
#include "fieldbus/device.h"

namespace cia402::drive {

/// Reads objects that do not come in the cycle, one after the other, whenever nobody else uses the
/// channel. Never blocks; each value carries the time of its answer. A request allocates.
///
/// What the driver itself needs is read in turn without end; what is only shown is read once for
/// each look at it, so that nobody's curiosity costs nothing.
class AxisPoller {
 public:
  static constexpr Duration kInterval{std::chrono::milliseconds(50)};  ///< between two requests
  static constexpr Duration kStale{std::chrono::seconds(1)};  ///< older values are not believed
  /// The same for what is read for a look: diagnostics look once a second.
  static constexpr Duration kStaleLook{std::chrono::milliseconds(2500)};

  enum class Reading : std::uint8_t { never, always, when_looked_at };

  /// Adds `signal` unless the drive does not have it, or it is mapped; but what is read for looks
  /// is added then, too, for a drive may turn out not to map it. @return its number for value(), or
  /// -1.
  int add(const Signal& signal, Reading reading = Reading::always);
  /// Somebody is about to look at an item: if it is read for that only, it is asked for once more.
  /// @param item of add(), not -1
  void look(int item);
  /// Is there anything for advance() to do?
  bool due(Time now) const { return now >= wake_ || (ticket_ && ticket_->done()); }
  /// Takes an answer that has come and asks for the next value; what is too old is fresh no more.
  void advance(fieldbus::ObjectAccess& objects, Time now);
  /// The device lost its state: nothing is known any more.
  void reset();
  /// Takes a value that somebody else has read.
  void put(int item, std::uint64_t raw, Time now);
  /// What is known of an item, in a place that stays; fresh unless advance() has found it too old.
  /// @param item of add(), not -1
  const fieldbus::ProcessValue& value(int item) const {
    return items_[static_cast<std::size_t>(item)].value;
  }
  /// The value of an item, none where it is unknown or too old. @param item of add(); -1: no value.
  const fieldbus::ProcessValue* value(int item, Time now) const {
    if (item < 0) return nullptr;
    const Item& asked = items_[static_cast<std::size_t>(item)];
    return asked.value.fresh && now <= asked.value.stamp + asked.life() ? &asked.value : nullptr;
  }

 private:
  struct Item {
    fieldbus::ObjectId object;
    std::string name;
    fieldbus::ProcessValue value;
    bool refused = false;  ///< the drive aborted: it does not have the object after all
    bool for_looks = false, wanted = true;

    bool due() const { return wanted && !refused; }
    Duration life() const { return for_looks ? kStaleLook : kStale; }
  };
  void ask(fieldbus::ObjectAccess& objects, Time now);
  void store(Item& item, std::uint64_t raw, Time now);
  void forgetOld(Time now);
  void wakeBy(Time time) { wake_ = std::min(wake_, time); }

  std::deque<Item> items_;  ///< others keep their places
  std::size_t current_ = 0;
  fieldbus::Ticket ticket_;
  Time next_{};
  Time earliest_{};  ///< of the next request, after the last one
  Time wake_{};      ///< when advance() has something to do though no answer comes
};

}  // namespace cia402::drive
