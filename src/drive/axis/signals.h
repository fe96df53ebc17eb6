// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "drive/axis/axis.h"
#include "drive/axis/poller.h"
#include "drive/axis/signal.h"

namespace cia402::drive {

/// What the drive tells of itself, a row each: those of SignalId, then those that the profile names
/// in `signals`, which are only shown. A row that does not come in the cycle is asked for beside
/// the cycle.
class Signals {
 public:
  /// @throws std::invalid_argument if statusword or actual position are not mapped.
  Signals(const AxisConfig& config, fieldbus::Device& device);
  Signals(const Signals&) = delete;  ///< its rows point into it
  Signals& operator=(const Signals&) = delete;

  const Signal& operator[](SignalId id) const { return rows_[static_cast<std::size_t>(id)]; }
  /// The rows of the profile's `signals`, in its order; of those that the drive lacks spec is
  /// nullptr.
  std::vector<ShownSignal> shown(Time now) const;

  /// Has come, and in time. @pre it is mapped
  bool fresh(SignalId id) const { return (*this)[id].value->fresh; }
  /// What the process image holds of it. @pre it is mapped
  const fieldbus::ProcessValue& image(SignalId id) const { return *(*this)[id].value; }
  /// The raw value of a row that is mapped or asked for without end; none where it is unknown or
  /// too old.
  static const fieldbus::ProcessValue* told(const Signal& row) {
    return row.value->fresh ? row.value : nullptr;
  }
  const fieldbus::ProcessValue* told(SignalId id) const { return told((*this)[id]); }
  /// The same in joint units; NaN where it is unknown. @param stamp of the value, if it is known
  double read(SignalId id, Time& stamp) const {
    const Signal& row = (*this)[id];
    const fieldbus::ProcessValue* value = told(row);
    if (value == nullptr) return kUnknown;
    stamp = value->stamp;
    return row.conversion.toJoint(value->raw);
  }
  /// Somebody is about to look at what is only shown: it is asked for once more where it does not
  /// travel.
  void look();
  /// Asks for what is due; what was asked for too long ago is fresh no more.
  void poll(Time now) {
    if (poller_.due(now)) poller_.advance(device_.objects(), now);
  }
  /// The drive lost its state: nothing that was asked for is known any more.
  void forget() { poller_.reset(); }
  /// Takes a value that somebody else has asked for.
  void put(SignalId id, std::uint64_t raw, Time now) { poller_.put((*this)[id].polled, raw, now); }

 private:
  Signal make(const AxisConfig& config, const ObjectSpec* spec, AxisPoller::Reading reading);
  bool travels(const Signal& row) const;

  fieldbus::Device& device_;
  const fieldbus::ProcessImage& image_;
  std::array<Signal, kSignalIds> rows_;  ///< of SignalId
  std::vector<Signal> named_;            ///< by the profile
  AxisPoller poller_;
};

}  // namespace cia402::drive
