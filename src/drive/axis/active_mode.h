// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drive/axis/basis.h"

namespace cia402::drive {

/// Which mode of operation the axis is commanded to be in: the one whose value and target the
/// outputs carry.
class ActiveMode {
 public:
  /// @param axis must outlive this.
  explicit ActiveMode(AxisBasis& axis);

  const ModeChannel& channel() const { return *mode_; }
  const ModeSpec& spec() const { return *mode_->spec; }
  /// The mode to enable in: the selected one; or the configured one where a homing was cut off, or
  /// the one that the axis is bound for where the way there was, or the one that was braked.
  const ModeChannel& working() const;
  /// The one that the configuration names.
  const ModeChannel& configured() const { return *axis_.objects.channel(axis_.config.mode); }
  bool homing() const { return spec().kind == ControlKind::homing; }

  void select(const ModeChannel& mode);
  /// The selected mode only lies on the way to another one. Until a mode is selected.
  void bindFor(const ModeChannel& mode) { bound_for_ = &mode; }
  /// The selected mode only brakes what moved in another one. Until a mode is selected.
  void brakeFor(const ModeChannel& mode) { braked_in_ = &mode; }
  bool brakes() const { return braked_in_ != nullptr; }
  /// The drive may hold what another mode needs (ModeSpec::entry_writes): a change of the mode
  /// began and was cut off. Until it was entered with all that it needs.
  bool prepared() const { return prepared_; }
  void setPrepared(bool prepared) { prepared_ = prepared; }
  /// Another value of 6060h is sent instead of the mode's, where it travels in the cycle; until it
  /// is taken back, another mode is selected, or the axis leaves operation.
  void overrideValue(std::optional<int> value) { override_ = value; }
  /// Keeps `raw` in an output object while the mode is active (ModeSpec::entry_writes).
  void hold(fieldbus::Slot slot, std::uint64_t raw);

  /// 6060h travels in the cycle; else it is written.
  bool travels() const {
    const OutputObject& object = axis_.objects.mode;
    return object.mapped() && !axis_.image.outputLeftOut(object.slot);
  }
  /// Puts the mode, and what it holds, into the process image.
  void write();
  /// Why a mode cannot be used with this drive; empty: it can.
  std::string refusal(const ModeChannel& mode) const;

 private:
  struct Held {
    fieldbus::Slot slot;
    std::uint64_t raw;
  };

  AxisBasis& axis_;
  const ModeChannel* mode_;
  const ModeChannel* bound_for_ = nullptr;
  const ModeChannel* braked_in_ = nullptr;
  bool prepared_ = true;
  std::optional<int> override_;
  std::vector<Held> held_;
};

}  // namespace cia402::drive
