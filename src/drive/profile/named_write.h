// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/common/result.h"
#include "drive/axis/config.h"

namespace cia402::drive {

/// A NamedWrite of a profile or of the user, worked out for one axis.
struct ResolvedWrite {
  ObjectId object;
  std::string name;  ///< "profile_velocity (6081:00)"
  DataType type = DataType::uint32;
  std::uint64_t raw = 0;                ///< as wide as the type
  std::optional<ObjectId> copied_from;  ///< read this object and write what it says; raw is unused
  bool asked_for = false;  ///< by the axis' configuration, not by a default of the profile alone
  bool optional = false;
};

/// Works out a write. @return nothing if what it takes its value from is not configured, or if it
/// is optional and cannot be converted (no rated_torque); an error sentence if the object is
/// unknown or the value does not fit it.
Result<std::optional<ResolvedWrite>> resolveWrite(const NamedWrite& write, const AxisConfig& axis);

/// Does the configuration of the axis have the value that NamedWrite::from calls so? Empty: yes.
bool isGiven(const std::string& name, const AxisConfig& axis);

/// A write with NamedWrite::when_homed, worked out for one axis.
struct ResolvedLimit {
  ResolvedWrite write;
  Conversion conversion;   ///< of the object, under the configured zero
  double value = 0.0;      ///< of the joint, rad or m
  bool lower = false;      ///< the joint may not be below it; else not above it
  std::uint64_t open = 0;  ///< raw: limits nothing
};
/// @return nothing where the axis has no such limit; an error as resolveWrite() gives it.
Result<std::optional<ResolvedLimit>> resolveLimit(const NamedWrite& write, const AxisConfig& axis);

/// The number of an integer object with the other sign.
std::uint64_t negated(std::uint64_t raw, DataType type);

/// `raw` as the bytes that are written: little-endian, as long as the type.
std::vector<std::uint8_t> wireBytes(std::uint64_t raw, DataType type);

/// A period as 60C2h holds it: period = value * 10^exponent s.
struct InterpolationPeriod {
  std::uint8_t value = 0;
  std::int8_t exponent = 0;
};
/// @return nothing if no value 1..255 with an exponent -6..0 gives exactly this period.
std::optional<InterpolationPeriod> interpolationPeriod(Duration period);

}  // namespace cia402::drive
