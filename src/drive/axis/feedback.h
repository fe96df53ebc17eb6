// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "drive/axis/active_mode.h"
#include "drive/axis/basis.h"
#include "drive/axis/coordinates.h"
#include "drive/axis/standstill.h"

namespace cia402::drive {

/// A drive may act on a set-point so many cycles after it was computed.
inline constexpr int kReactionCycles = 2;

/// What the axis knows of its drive: signals decoded into the state, and whether it stands.
class Feedback {
 public:
  /// All must outlive this.
  Feedback(AxisBasis& axis, Coordinates& coordinates, const ActiveMode& mode);

  /// What is commanded while the drive is looked at.
  struct Commanded {
    double position = kUnknown;  ///< rad or m; NaN: none
    bool handing_over = false;   ///< target reached still speaks of the set-point before
  };
  /// Decodes what has come. Everything is unknown while the device is not ready.
  /// @return whether it is
  bool read(Time now, const Commanded& commanded);
  /// Nothing is known any more: the device is not ready, or another one.
  void forget();
  /// The same of position and what is measured with it.
  void forgetMotion();
  /// The position that was told is of other coordinates: unknown until it comes again.
  void forgetPosition();

  /// The newest feedback is as new as it can be: none that was due has failed to come. Of a drive
  /// that sends only what changes nothing is due.
  bool heardLately(Time now) const;
  /// Axis::positionBy().
  double positionBy(const ObjectSpec& object, std::uint64_t raw) const;
  /// A statusword that no state fits has come for no longer than is put up with.
  bool maybeDecodable(Time now) const {
    return axis_.state.state == State::unknown &&
           now - known_state_ <= axis_.config.undecodable_timeout;
  }

  /// What the statusword says that forbids motion; nullptr: nothing, or it is not known.
  const StatusNeed* unmet() const { return axis_.state.feedback_valid ? unmet_ : nullptr; }
  /// There was none by the statusword that came last.
  bool needsMet() const { return unmet_ == nullptr; }

  /// The value that 6061h shows, if known.
  std::optional<int> shownMode() const { return shown_mode_; }
  bool shows(const ModeSpec& mode) const { return shown_mode_ == mode.value; }
  /// Takes what somebody else has read of 6061h.
  void putShownMode(std::uint64_t raw, Time now);

  /// The drive's own number for where it is, fit to be sent back. @return false if it is unknown
  bool rawPosition(std::uint64_t& raw) const {
    raw = raw_position_;
    return raw_known_;
  }

  const Standstill& standstill() const { return standstill_; }
  /// Of the measured position, rad or m.
  double positionResolution() const { return signals_[SignalId::position].conversion.resolution(); }
  /// What is measured says that it stands, whatever the drive may do the next moment.
  bool measuredStill() const { return standstill_.still(); }
  /// Measured over a window that lies wholly after `from` and the drive's reaction to it.
  bool seenStill(Time from) const {
    return standstill_.still() &&
           standstill_.stillFrom() >= from + kReactionCycles * axis_.config.cycle;
  }
  /// The same after the last that could have moved it.
  bool atStandstill() const { return seenStill(axis_.moved_at); }
  /// The same by feedback that is no older than it must be, for answers: what comes late may tell
  /// that it has begun to move.
  bool seenToStand(Time now) const { return atStandstill() && heardLately(now); }
  /// Is not known to stand. Without feedback one that stood without power still does.
  bool mayMove() const {
    return axis_.state.feedback_valid ? !atStandstill() : !stood_without_power_;
  }
  /// Counts as moving until it has been watched for a while: its coordinates have changed.
  void watchAnew() { standstill_.reset(); }

  /// "statusword 0x0233 (switched on: ...)".
  std::string stateText() const;
  /// Why there is no feedback: "TPDO 1 (COB-ID 0x183) did not come for 11 cycles".
  std::string text() const;
  /// Why an axis without power is not known to stand.
  std::string coastingText() const;
  /// Axis::unknownText().
  std::string unknownText() const;

 private:
  void readMotion(Time now, double commanded);
  void readFollowingError(double commanded);
  void readState(Time now, bool handing_over);
  void readDigitalInputs();
  void readMode();
  void showMode(std::uint64_t raw);

  AxisBasis& axis_;
  Signals& signals_;
  Coordinates& coordinates_;
  const ActiveMode& mode_;
  Standstill standstill_;
  bool stood_without_power_ = false;   ///< when its feedback ended
  const StatusNeed* unmet_ = nullptr;  ///< by the last statusword
  Time known_state_{};
  std::optional<int> shown_mode_;
  std::uint64_t shown_raw_ = 0;  ///< of 6061h, for which shown_mode_ was decoded
  std::uint64_t raw_position_ = 0;
  bool raw_known_ = false;
};

}  // namespace cia402::drive
