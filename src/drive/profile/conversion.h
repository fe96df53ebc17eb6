// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cia402_driver/common/result.h"
#include "drive/profile/profile.h"

namespace cia402::drive {

/// What turns device values into joint values (design: "units once").
struct AxisGeometry {
  enum class Type : std::uint8_t { revolute, prismatic, continuous };
  Type type = Type::revolute;
  bool prismatic() const { return type == Type::prismatic; }
  double counts_per_turn = 0.0;  ///< device position counts per motor turn (unit `count` only)
  double gear_ratio = 1.0;       ///< motor turns per joint turn (or per screw turn, prismatic)
  double lead = 0.0;             ///< m per turn, prismatic only
  int direction = 1;             ///< +1 or -1
  double position_offset = 0.0;  ///< rad or m: joint position where the device says 0
  double rated_torque = 0.0;     ///< N m at the motor shaft, for per_mille_of_rated; 0: unknown
};

/// Converts one object's raw wire number to a joint value in SI units and back. A plain value
/// prepared at configuration; both directions are a multiplication, an addition and a range check.
///
/// Unsigned objects hold magnitudes (a profile velocity, a window): direction and offset do not
/// touch them, and negative values do not fit. Signed ones follow the axis' direction; the offset
/// belongs to positions only.
class Conversion {
 public:
  Conversion() = default;
  /// @return an error sentence if the geometry lacks what the unit needs (counts_per_turn, lead,
  /// rated torque), the unit does not suit the quantity, or the object holds no number.
  static Result<Conversion> create(const ObjectSpec& object, const DriveProfile& profile,
                                   const AxisGeometry& geometry);

  /// Joint value (rad, m, per s, N m, N) of a raw number as wide as the object. NaN if the device
  /// sent NaN or infinity. Always inlined, as it is called for each value of each cycle.
  [[gnu::always_inline]] double toJoint(std::uint64_t raw) const {
    if (!plain_) return otherToJoint(raw);
    const std::uint64_t top = raw << shift_;  // the object's own sign bit becomes the top one
    const double device = signed_ ? static_cast<double>(static_cast<std::int64_t>(top) >> shift_)
                                  : static_cast<double>(top >> shift_);
    return device * factor_ + offset_;
  }
  /// Raw number of a joint value, rounded to the nearest device unit. NaN, infinity and what does
  /// not fit the object, or lies outside its range, give `false` and leave `raw` untouched.
  [[nodiscard]] bool toDevice(double value, std::uint64_t& raw) const;
  /// What may be sent of what was received: `raw`, but +0.0 for -0.0.
  std::uint64_t sendable(std::uint64_t raw) const {
    return encoding_ == Encoding::integer ? raw : sendableFloat(raw);
  }
  /// Smallest and largest joint value that the object takes.
  double lowest() const;
  double highest() const;
  /// Smallest and largest number that it takes, as it is on the wire.
  std::uint64_t lowestRaw() const;
  std::uint64_t highestRaw() const;
  /// Joint units per device unit (resolution); 0 for floats and times.
  double resolution() const;
  /// The number of the largest joint value, as it is on the wire: of a time the shortest.
  std::uint64_t mostRaw() const { return time_ ? lowestRaw() : highestRaw(); }
  /// True if positive device numbers are negative joint values.
  bool reversed() const { return factor_ < 0.0; }
  /// Joint units of all numbers that the object has, after which it begins anew; 0 for floats and
  /// times, which do not.
  double span() const;
  /// The same for a joint that turns without end: what does not fit the object wraps around, as the
  /// drive's own counting does. Floats do not.
  Conversion wrapping() const;
  /// The same with all joint values larger by `amount`: the zero was declared elsewhere.
  Conversion shifted(double amount) const;

 private:
  std::uint64_t wire(double device) const;
  bool toOther(double value, std::uint64_t& raw) const;
  double otherToJoint(std::uint64_t raw) const;
  std::uint64_t sendableFloat(std::uint64_t raw) const;

  double factor_ = 1.0;   ///< joint value = factor * device value + offset; of times factor / value
  double inverse_ = 1.0;  ///< 1 / factor
  double offset_ = 0.0;
  double low_ = -2147483648.0, high_ = 2147483647.0;  ///< device values that it takes
  double first_ = low_, last_ = high_;                ///< all that its type has
  std::uint64_t mask_ = 0xFFFFFFFF;                   ///< bits of the object
  std::uint8_t shift_ = 32;                           ///< 64 - bits
  bool plain_ = true;                                 ///< a whole number, and no time
  bool signed_ = true, wraps_ = false;
  bool time_ = false;  ///< UnitSpec::to
  Encoding encoding_ = Encoding::integer;
};

}  // namespace cia402::drive
