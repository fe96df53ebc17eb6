// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/drive/core.h"

namespace cia402::sim {

/// The encoder of one axis: what it knows after power-on, and the maker's objects in which it tells
/// more than 6064h can hold. Without AbsoluteEncoderDefinition::counts it does nothing.
class AbsoluteEncoder {
 public:
  /// All must outlive it, and stay where they are.
  AbsoluteEncoder(const DriveDefinition& definition, ObjectDictionary& dictionary, DriveCore& core);
  AbsoluteEncoder(const AbsoluteEncoder&) = delete;
  AbsoluteEncoder& operator=(const AbsoluteEncoder&) = delete;

  /// The axis has been started. @param cold it had no power
  void start(bool cold);
  /// What comes of it by itself: too many turns. Often.
  void look() {
    if (encoder_.counts != 0) lookAtTurns();
  }
  /// The object that resets it, which it wants to hear of.
  bool holds(fieldbus::ObjectId id) const { return encoder_.reset == id; }
  void written(const Entry& entry);

 private:
  using Object = std::optional<fieldbus::ObjectId>;
  void lookAtTurns();
  template <typename Number>
  void show(const Object& object, Number number);
  template <typename Number>
  void show(const AbsoluteEncoderDefinition::Wide& objects, Number number);
  void showAll();
  double number(const Object& object, double fallback) const;
  double wide(const AbsoluteEncoderDefinition::Wide& objects) const;
  EncoderKind kind() const;
  double turned() const;  ///< turns since its own zero, forward as from the factory
  double rotary() const;  ///< counts within a turn of the load
  double countsPerUnit() const;
  void forgetTurns();
  bool batteryLow() const;

  const AbsoluteEncoderDefinition& encoder_;
  Object gear_numerator_, gear_denominator_;                   ///< so many counts are so many units
  const FaultDefinition *overflow_, *battery_, *low_battery_;  ///< nullptr: it reports none
  ObjectDictionary& dictionary_;
  DriveCore& core_;
  double zero_ = 0.0;  ///< true turns where its own counter is 0
  bool homed_ = false, battery_low_ = false;
  bool battery_due_ = false;  ///< that it is lost is to be told
  bool told_ = false;         ///< that there are too many turns
};

}  // namespace cia402::sim
