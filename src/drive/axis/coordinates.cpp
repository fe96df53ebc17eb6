// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/coordinates.h"

#include <algorithm>

namespace cia402::drive {

Coordinates::Coordinates(const AxisConfig& config, const Signal& position, AxisState& state)
    : config_(config), drive_(position.conversion), state_(state), position_(drive_) {
  const bool continuous = config.geometry.type == AxisGeometry::Type::continuous;
  if (continuous && position.spec->encoding == Encoding::integer) {
    unwrap_ = {fieldbus::sizeBits(position.spec->type), fieldbus::isSigned(position.spec->type)};
  }
  if (config.homing && config.homing->kept_by_drive && config.profile->homed_bit) {
    home_mask_ = 1U << static_cast<unsigned>(*config.profile->homed_bit);
    const auto& writes = config.profile->homing.writes;
    const bool offset_in_drive =
        std::any_of(writes.begin(), writes.end(),
                    [](const NamedWrite& write) { return write.from == "homing.offset"; });
    if (!offset_in_drive) kept_shift_ = config.homing->atHome() - drive_.toJoint(0);
  }
  state_.homed = absolute();
}

std::optional<double> Coordinates::takeHome(bool known) {
  home_known_ = known;
  if (!known) {
    if (!by_drive_) return {};
    return lose();
  }
  if (state_.homed || lost_) return {};
  by_drive_ = true;
  return set(kept_shift_);
}

bool Coordinates::absolute() const {
  return !lost_ && (!config_.homing || !config_.homing->required);
}

double Coordinates::placeOf(double by_drive) const {
  const double place = by_drive + shift_;
  if (!unwrap_.counting()) return place;
  const double range = std::fabs(drive_.span());
  return place + std::round((state_.position - place) / range) * range;
}

Conversion Coordinates::ofTarget(const Conversion& target) const {
  const Conversion shifted = target.shifted(shift_);
  return unwrap_.counting() ? shifted.wrapping() : shifted;
}

std::optional<double> Coordinates::declare(double value) {
  if (!state_.feedback_valid) return {};
  lost_ = by_drive_ = false;
  return set(shift_ + (value - state_.position));
}

double Coordinates::adopt(double shift, bool homing) {
  lost_ = false;
  by_drive_ = home_mask_ != 0;
  home_known_ = true;
  unwrap_.restart(homing);
  return set(shift);
}

double Coordinates::returnToDrive(bool homing) {
  unwrap_.restart(homing);
  return set(0.0);
}

double Coordinates::lose() {
  const double moved = returnToDrive(true);
  lost_ = true;
  by_drive_ = false;
  state_.homed = false;
  return moved;
}

std::optional<double> Coordinates::forget(bool homing) {
  std::optional<double> moved;
  home_known_ = by_drive_ = false;
  if (!absolute()) moved = returnToDrive(homing);
  state_.homed = absolute();
  return moved;
}

void Coordinates::countAnew(bool homing) {
  unwrap_.restart(homing);
  place();
}

double Coordinates::set(double shift) {
  const double moved = shift - shift_;
  shift_ = shift;
  place();
  state_.position += moved;
  state_.homed = true;
  ++state_.zero_changes;
  return moved;
}

void Coordinates::place() {
  position_ = drive_.shifted(shift_ + static_cast<double>(unwrap_.wraps()) * drive_.span());
}

}  // namespace cia402::drive
