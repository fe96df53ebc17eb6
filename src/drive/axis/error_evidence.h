// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drive/axis/objects.h"
#include "fieldbus/emergency.h"
#include "fieldbus/object_access.h"

namespace cia402::drive {

/// Which error a drive reports, from all that tells of it: emergencies, 603Fh, which comes
/// in the cycle or is read after a fault, and the error register 1001h.
///
/// A fault is named by the newest of them that came with it: 603Fh may still tell of something
/// else, a standing warning or the last fault, and drives may send more emergencies after that of
/// the fault. Without a fault an emergency counts until the drive sends "error reset", or, as not
/// every drive does, until 1001h is 0.
class ErrorEvidence {
 public:
  /// An emergency so long after the statusword that shows the fault may still name it.
  static constexpr Duration kNaming{std::chrono::milliseconds(500)};
  /// A fault may be told so long before the statusword shows it.
  static constexpr Duration kAhead{std::chrono::milliseconds(100)};
  /// 1001h is read so long after an emergency that nothing has ended, and again after the same
  /// time.
  static constexpr Duration kLook{std::chrono::seconds(1)};

  /// @param excuse why this program itself has caused it, in words; empty: it has not
  /// @param shared the device has other axes, and nothing in an EMCY tells which of them it is
  /// about: it names a fault that this axis shows where nothing else does, and counts for nothing
  /// else
  void onEmergency(const fieldbus::Emergency& emergency, const std::string& excuse, bool shared,
                   Time now);

  /// What the drive shows in this cycle.
  struct Look {
    bool faulted = false, warning = false;
    std::optional<std::uint16_t> told;  ///< 603Fh as it came in the cycle
    bool of_warning = false;            ///< ... which is, with this statusword, a warning's
    const ObjectSpec* asked = nullptr;  ///< 603Fh where it does not come so
  };
  void update(const Look& look, fieldbus::ObjectAccess& objects, Time now);
  /// Nothing is known of any error: without fault and warning, and with 603Fh as it was, update()
  /// would change nothing.
  bool quiet() const { return code_ == 0 && pending_ == 0 && !faulted_; }
  /// That is what the cycle has told of 603Fh already.
  bool knows(std::uint16_t object) const { return object_known_ && object == object_.code; }

  /// Of the fault, of the warning, or of an emergency that still counts; 0: none.
  std::uint16_t code() const { return code_; }
  /// The emergency that has not ended; 0: none.
  std::uint16_t pending() const { return pending_; }
  /// Why this program has caused that one; nullptr: it has not.
  const std::string* excuse(std::uint16_t code) const;
  /// The fault was reset: what was told before it is over.
  void forget();

 private:
  struct Told {
    std::uint16_t code = 0;
    Time at = Time::min();
  };
  std::uint16_t nameOfFault() const;
  bool withFault(const Told& told) const;
  void readErrorCode(const Look& look, fieldbus::ObjectAccess& objects);
  void readErrorRegister(const Look& look, fieldbus::ObjectAccess& objects, Time now);

  bool shared_ = false;
  std::uint16_t code_ = 0, pending_ = 0;
  Told emergency_;  ///< the last that may name a fault
  Told object_;     ///< 603Fh, and since when it is that
  bool object_known_ = false, faulted_ = false;
  Time fault_since_ = Time::min();
  Time next_look_ = Time::min();       ///< at 1001h
  std::optional<std::uint16_t> read_;  ///< 603Fh as asked for since the fault
  fieldbus::Ticket code_ticket_, register_ticket_;
  bool register_missing_ = false;
  std::uint16_t excused_ = 0;  ///< an emergency that this program itself has caused; 0: none
  std::string excuse_;
};

}  // namespace cia402::drive
