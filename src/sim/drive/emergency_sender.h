// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/drive_definition.h"
#include "sim/device/device.h"

namespace cia402::sim {

/// Error register bits of a code's class (CiA 301, 7.2.7.1 and 7.5.2.2).
std::uint8_t registerFor(std::uint16_t code);

/// How a drive tells of its errors by EMCY: once each, or with the chatter that some drives make,
/// and a storm where a test injects one.
class EmergencySender {
 public:
  EmergencySender(const DriveDefinition& definition, Device& device)
      : definition_(definition), device_(device) {}

  /// @param error_register 1001h of the device from now on.
  void report(const FaultDefinition& fault, std::uint8_t error_register, Time now);
  /// The errors of an axis are gone. @param error_register what those of other axes leave.
  void errorsGone(std::uint8_t error_register, Time now);
  /// An EMCY a millisecond that changes nothing else, until stopStorm().
  void storm(Time now);
  void stopStorm() { storm_at_ = kNever; }

  /// Sends what is due.
  void tick(Time now);
  /// When tick() must be called next.
  Time nextEvent() const;

 private:
  void tickStorm(Time now);
  void tickChatter(Time now);

  /// The EMCY of a fault ends and comes again though the fault stays, at last it stands.
  struct Chatter {
    const FaultDefinition* fault = nullptr;
    std::uint8_t error_register = 0;
    unsigned left = 0;
    Time at = kNever;
  };

  const DriveDefinition& definition_;
  Device& device_;
  Chatter chatter_;
  Time storm_at_ = kNever;
  unsigned storm_count_ = 0;
};

}  // namespace cia402::sim
