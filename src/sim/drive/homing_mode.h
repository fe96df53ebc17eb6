// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/drive/homing_sequence.h"
#include "sim/drive/moving_axis.h"

namespace cia402::sim {

/// Homing mode (CiA 402-2): begun by controlword bit 4, or by an object where the drive has one for
/// that; a found home moves the frame of the axis.
class HomingMode {
 public:
  explicit HomingMode(MovingAxis& axis) : axis_(axis) {}

  /// A mode begins: what was found before says nothing any more, but by a quirk.
  void begin();
  /// A controlword in this mode.
  void control(bool bit_4, bool rising);
  void start();  ///< the search begins, whoever asks
  /// It begins where an object does that instead of bit 4, if this is the mode.
  void startByObject() {
    if (axis_.inMode(ModeBehaviour::homing)) start();
  }
  /// 607Ch was written.
  void offsetWritten();
  /// What was homed before says nothing of a later 607Ch.
  void forgetOffset() { offset_.reset(); }
  /// Nothing pushes harder in this mode now, rated torques.
  double mostTorque() const;
  /// One kDriveStep; the rotor was at `from`, true turns, before.
  void step(double from);

  /// An object begins to home instead of controlword bit 4.
  bool byObject() const { return axis_.values.entry(Role::homing_start) != nullptr; }
  bool searching() const { return sequence_.phase() == HomingSequence::Phase::searching; }
  /// The position that is shown next is 0, as some are while it homes by an object.
  bool readsNothing();
  /// Name of a fault that this mode has come to since it was asked last, or nullptr.
  const char* takeFault();
  /// Statusword bits 10, 12 and 13 of this mode; bit 15 where an object begins it.
  std::uint16_t statusBits(bool halted) const;

 private:
  bool terminalsAreRight(const HomingRoute& route) const;
  bool atHardStop();
  void standWhereItIs();
  void keepNear();
  void watchTime();
  void finish();
  bool movesOn() const;
  void arrive();
  void giveUp();
  double homeReads() const;
  bool illogical(const HomingRoute* route) const;
  void goToGoal();
  void search();

  MovingAxis& axis_;
  HomingSequence sequence_;
  bool attained_ = false;
  bool failed_ = false;
  bool returning_ = false;  ///< to goal_, which is home or lies the offset beyond it
  double goal_ = 0.0;       ///< true turns
  bool terminals_wrong_ = false, late_ = false, tells_failure_ = false, illogical_ = false;
  bool seeks_stop_ = false;  ///< somewhere on its way
  bool offset_wrong_ = false;
  std::optional<double> offset_;  ///< turns, that of a home found since the power came
  unsigned readings_ = 0;         ///< of positions, while it homes by an object
  double searched_s_ = 0.0;
  double pushed_s_ = 0.0;  ///< against a hard stop
};

}  // namespace cia402::sim
