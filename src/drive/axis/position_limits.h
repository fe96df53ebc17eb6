// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drive/profile/named_write.h"
#include "fieldbus/object_access.h"

namespace cia402::drive {

/// The joint's limits in the drive (607Dh, and what else the profile names), which count in the
/// drive's own coordinates: a drive that holds those of another zero clamps targets to where nobody
/// wants to go. So they are written only while the zero is known, and anew whenever it changes;
/// until then they stand open. A side beyond which the axis stands is open, too, until it has come
/// back: enabling would move it.
///
/// The writes go beside the cycle; who is about to move the axis waits until settled().
class PositionLimits {
 public:
  explicit PositionLimits(const AxisConfig& config);

  /// The joint's limits are others: has them worked out anew. aim() must follow.
  void adopt(const AxisConfig& config);
  /// Another drive may be there, or the same with other parameters.
  void forget();
  /// Decides anew what the drive shall hold, and tries again what it refused before.
  /// @param known the drive's coordinates are the joint's
  /// @param shift joint value added to what the drive's own zero says
  void aim(bool known, double shift, double position);
  /// Closes a side that was left open, once `position` and `target` are inside. NaN is nowhere.
  void closeIfInside(double position, double target);
  /// Reads and writes; to be called in every cycle of a device that is ready.
  void advance(fieldbus::ObjectAccess& objects);

  bool settled() const;
  /// Neither closeIfInside() nor advance() has anything to do until aim() or forget().
  bool idle() const { return idle_; }
  /// Why the axis must not be enabled: the drive holds narrower limits than it should and refuses
  /// others. Empty: nothing.
  std::string problem() const;
  /// What else the drive did not take, as the end of a sentence. Empty: nothing.
  std::string remark() const;

 private:
  struct Side {
    ResolvedLimit limit;
    std::uint64_t wanted = 0;
    std::uint64_t closed = 0;  ///< what it is when the axis stands inside
    bool left_open = false;    ///< the axis stands outside
    bool asked = false;        ///< the drive was asked what it holds
    bool absent = false;       ///< it has no such object
    bool checking = false;     ///< what was written is read back
    std::uint64_t wrote = 0;
    bool aimed = false;                 ///< `wanted` was worked out
    std::optional<std::uint64_t> held;  ///< by the drive, as far as known
    std::string refusal;
  };
  bool reached(const Side& side) const;
  bool narrower(const Side& side) const;
  void take(Side& side, const fieldbus::Transfer& answer);
  static void compare(Side& side);

  const bool read_back_;
  std::vector<Side> sides_;  ///< one for each object that holds a limit
  bool idle_ = false;
  std::size_t busy_ = 0;  ///< whose transfer `ticket_` is
  std::uint64_t sent_ = 0;
  fieldbus::Ticket ticket_;
};

}  // namespace cia402::drive
