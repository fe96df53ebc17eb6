// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "drive/axis/basis.h"
#include "drive/axis/error_evidence.h"
#include "drive/axis/fault_details.h"

namespace cia402::drive {

/// Faults, warnings and emergencies of the drive: which counts, in words, and when it may be reset.
/// Writes `error_code` of the state.
class FaultWatch {
 public:
  explicit FaultWatch(AxisBasis& axis) : axis_(axis) {}  ///< @param axis must outlive this

  /// Once a cycle, after the statusword was decoded.
  void read(Time now) {
    if (!nothingNew()) readError(now);
  }
  /// @param excuse why this program itself has caused it; empty: it has not
  void onEmergency(const fieldbus::Emergency& emergency, const std::string& excuse, Time now) {
    errors_.onEmergency(emergency, excuse, axis_.neighbours.any(), now);
    details_.renew();
  }
  /// An emergency whose end the drive has not told; 0: none.
  std::uint16_t pendingEmergency() const { return errors_.pending(); }
  /// What the drive does at the warning that stands.
  enum class Warning : std::uint8_t {
    goes_on,
    stops,  ///< as at a fault
    holds,  ///< it brings the motor to rest and holds it; told once for each warning
  };
  Warning warning() const;
  /// By a warning that stands, known to people or not, the drive holds its motor and may let it go.
  bool holdsMotor() const;
  /// Nothing more is to be done about the warning that stands.
  void acknowledgeWarning() { acknowledged_ = axis_.state.warning ? axis_.state.error_code : 0; }
  /// The fault was reset: what was told before is over.
  void forgetFault();
  /// Another drive may be there: nothing is known.
  void forget();

  /// When the next edge of the fault reset bit is allowed (guard against storms of resets).
  Time nextReset() const { return next_reset_; }
  void noteReset(Time next_allowed) { next_reset_ = next_allowed; }

  /// Why a reset of the present fault would be in vain now, with what helps; empty: it may help.
  std::string resetRefusal(Time now) const;

  /// What the drive says more of the present error is on its way: text() will be another one.
  bool textAwaited() const { return details_.awaited(axis_.state.error_code); }
  /// The present fault in words with cause and remedy; empty if none.
  std::string text() const;
  /// "last EMCY 0x8130 ...", or that none is pending.
  std::string emergencyText() const;
  /// An error code in words, with its excuse where it has one.
  std::string codeText(std::uint16_t code) const;

 private:
  bool nothingNew() const;
  std::string detailText() const;
  void readError(Time now);

  AxisBasis& axis_;
  ErrorEvidence errors_;
  FaultDetails details_;
  Time next_reset_ = Time::min();
  Time faulted_since_ = kNever;  ///< with that code:
  std::uint16_t faulted_by_ = 0;
  std::uint16_t acknowledged_ = 0;  ///< a warning; 0: none
};

/// As in nearly every cycle: readError() would change nothing.
inline bool FaultWatch::nothingNew() const {
  const bool calm = errors_.quiet() && !axis_.state.warning && !axis_.faulted();
  if (!calm || faulted_by_ != 0 || !details_.idle()) return false;
  const Signals& signals = axis_.objects.signals;
  return !signals[SignalId::error_code].mapped() || !signals.fresh(SignalId::error_code) ||
         errors_.knows(static_cast<std::uint16_t>(signals.image(SignalId::error_code).raw));
}

}  // namespace cia402::drive
