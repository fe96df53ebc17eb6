// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/active_mode.h"

#include <algorithm>

namespace cia402::drive {

ActiveMode::ActiveMode(AxisBasis& axis) : axis_(axis), mode_(&configured()) {
  std::size_t longest = 0;
  for (const ModeSpec& mode : axis.profile().modes) {
    longest = std::max(longest, mode.entry_writes.size());
  }
  held_.reserve(longest);
}

const ModeChannel& ActiveMode::working() const {
  if (bound_for_ != nullptr) return *bound_for_;
  if (braked_in_ != nullptr) return *braked_in_;
  return homing() ? configured() : *mode_;
}

void ActiveMode::select(const ModeChannel& mode) {
  mode_ = &mode;
  bound_for_ = braked_in_ = nullptr;
  override_.reset();
  held_.clear();
}

void ActiveMode::hold(fieldbus::Slot slot, std::uint64_t raw) {
  for (Held& held : held_) {
    if (held.slot == slot) {
      held.raw = raw;
      return;
    }
  }
  held_.push_back({slot, raw});
}

void ActiveMode::write() {
  const OutputObject& object = axis_.objects.mode;
  if (object.mapped()) {
    const int value = override_.value_or(spec().value);
    axis_.image.setOutput(object.slot, static_cast<std::uint64_t>(value));
  }
  for (const Held& held : held_) axis_.image.setOutput(held.slot, held.raw);
}

std::string ActiveMode::refusal(const ModeChannel& mode) const {
  const bool left_out =
      mode.refusal.empty() && mode.target.mapped() && axis_.image.outputLeftOut(mode.target.slot);
  if (!left_out) return mode.refusal;
  return "the drive does not have its target " + fieldbus::toString(mode.target.spec->id) + " " +
         mode.target.spec->name + ", or cannot map it";
}

}  // namespace cia402::drive
