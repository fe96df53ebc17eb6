// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

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
  bool due(Time now) const { return ticket_ ? ticket_->done() : now >= next_ && !items_.empty(); }
  /// Takes an answer that has come and asks for the next value.
  void advance(fieldbus::ObjectAccess& objects, Time now);
  /// The device lost its state: nothing is known any more.
  void reset();
  /// Takes a value that somebody else has read.
  void put(int item, std::uint64_t raw, Time now);
  /// The value of an item, none where it is unknown or too old. @param item of add(); -1: no value.
  const fieldbus::ProcessValue* value(int item, Time now) const {
    if (item < 0) return nullptr;
    const Item& asked = items_[static_cast<std::size_t>(item)];
    if (!asked.value.valid) return nullptr;
    return now - asked.value.stamp <= (asked.for_looks ? kStaleLook : kStale) ? &asked.value
                                                                              : nullptr;
  }

 private:
  struct Item {
    fieldbus::ObjectId object;
    std::string name;
    fieldbus::ProcessValue value;
    bool refused = false;  ///< the drive aborted: it does not have the object after all
    bool for_looks = false, wanted = true;

    bool due() const { return wanted && !refused; }
  };
  void ask(fieldbus::ObjectAccess& objects, Time now);

  std::vector<Item> items_;
  std::size_t current_ = 0;
  fieldbus::Ticket ticket_;
  Time next_{};
  Time earliest_{};  ///< of the next request, after the last one
};

}  // namespace cia402::drive
