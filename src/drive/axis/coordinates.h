// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "drive/axis/axis.h"
#include "drive/axis/position_unwrap.h"
#include "drive/axis/signals.h"

namespace cia402::drive {

/// So long a drive may take until it tells positions in coordinates that it was just given.
inline constexpr Duration kZeroSettles{std::chrono::milliseconds(250)};

/// Where the joint's zero lies in what the drive counts: by the drive's own zero, or shifted in
/// software by what was declared or found; and how often a joint that turns without end has gone
/// around. Writes `homed`, `zero_changes` and, when the zero moves, `position` of the state.
class Coordinates {
 public:
  /// @param position the drive's actual position. All must outlive this.
  Coordinates(const AxisConfig& config, const Signal& position, AxisState& state);

  /// Takes the drive's number for the actual position.
  void follow(std::uint64_t raw) {
    if (unwrap_.update(raw)) place();
  }
  /// The joint's position in rad or m.
  double toJoint(std::uint64_t raw) const { return position_.toJoint(raw); }
  /// The same of another object that counts as the actual position does and was taken at another
  /// time. Of a joint that turns without end it is the place nearest to where that is, of all that
  /// read so; NaN where this is not known.
  /// @param by_drive by the drive's own zero, as the object's Conversion has it
  double placeOf(double by_drive) const;
  /// The conversion of a position target, which counts from the joint's zero. Targets need no whole
  /// wraps: they wrap around themselves.
  Conversion ofTarget(const Conversion& target) const;
  /// Beyond half of what the drive can count, what is sent means a place on the other side.
  bool reaches(double position) const {
    if (!unwrap_.counting()) return true;
    return std::fabs(position - state_.position) < 0.5 * std::fabs(drive_.span());
  }
  /// Joint value, rad or m, that is added to what the drive's own zero says.
  double shift() const { return shift_; }
  /// Positions mean something without homing: none is required, and the zero was not lost.
  bool absolute() const;

  // Each returns by how much the joint's zero has moved, rad or m.
  /// The present position shall read `value` from now on. Nothing where it is not known.
  std::optional<double> declare(double value);
  /// The drive has found its home by itself: what was declared before is void.
  /// @param homing the drive is in homing mode: what its number does meanwhile is no motion
  double adopt(double shift, bool homing);
  /// Positions count from the drive's own zero.
  double returnToDrive(bool homing);
  /// The drive's zero may be another than before, and nobody has said where it lies: not homed,
  /// also where no homing is required, until a position is declared or found.
  double lose();

  /// Another drive may be there: what was declared or found is void where it has to be. Nothing
  /// where the zero stays.
  std::optional<double> forget(bool homing);

  /// What the drive says of its home counts (HomingOptions::kept_by_drive).
  bool followsHome() const { return home_mask_ != 0; }
  /// Homed while the drive says so. To be asked outside homing mode. Nothing where nothing changes.
  std::optional<double> followHome(std::uint16_t statusword) {
    const bool known = (statusword & home_mask_) != 0;
    return known == home_known_ ? std::nullopt : takeHome(known);
  }

  /// What was counted before was in other coordinates.
  void countAnew(bool homing);
  /// The drive has left homing mode.
  void resumeCounting() { unwrap_.resume(); }

 private:
  double set(double shift);
  [[gnu::cold]] std::optional<double> takeHome(bool known);
  void place();

  const AxisConfig& config_;
  const Conversion& drive_;  ///< by the drive's own zero
  AxisState& state_;
  Conversion position_;  ///< with shift and wraps
  double shift_ = 0.0;
  bool lost_ = false;        ///< and not declared or found since
  unsigned home_mask_ = 0;   ///< of the statusword; 0: what the drive says of its home is nothing
  bool home_known_ = false;  ///< by the drive
  bool by_drive_ = false;    ///< homed as the drive knows its home
  double kept_shift_ = 0.0;  ///< then: the offset of homing, where the driver counts it
  PositionUnwrap unwrap_;
};

}  // namespace cia402::drive
