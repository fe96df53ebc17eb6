// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/profile_position.h"

#include <cmath>

namespace cia402::sim {
namespace {

// Controlword bits of this mode.
constexpr std::uint16_t kImmediately = 0x0020;
constexpr std::uint16_t kRelative = 0x0040;

}  // namespace

bool ProfilePosition::ofThisMode() const {
  return axis_.mode != nullptr && axis_.mode->behaviour == ModeBehaviour::profile_position &&
         axis_.mode->handshake;
}

void ProfilePosition::begin() {
  const Demand& demand = axis_.demand;
  active_ = {demand.position, {}, {}};
  buffered_.reset();
  acknowledged_ = false;
  bit_ = false;
  if (!ofThisMode()) return;
  active_.limits = axis_.limits.profile(axis_.mode);
  if (active_.limits.deceleration > 0.0) {
    active_.target +=
        demand.velocity * std::fabs(demand.velocity) / (2.0 * active_.limits.deceleration);
  }
}

bool ProfilePosition::control(std::uint16_t controlword, std::uint16_t previous) {
  if (!ofThisMode()) return false;
  const unsigned mask = 1U << axis_.mode->set_point_bit;
  bit_ = (controlword & mask) != 0;
  const bool accepts = bit_ && (previous & mask) == 0 && !acknowledged_;
  if (accepts) accept(controlword);
  if (!bit_) acknowledged_ = buffered_.has_value();
  return accepts;
}

void ProfilePosition::accept(std::uint16_t controlword) {
  const bool immediately = (controlword & kImmediately) != 0;
  const bool relative = (controlword & kRelative) != 0;
  const SetPoint& last = buffered_ ? *buffered_ : active_;
  const double turns = axis_.values.get(Role::target_position, 0.0);
  const double commanded = relative ? last.target - axis_.frame + turns : turns;
  const SetPoint next{axis_.trueTarget(commanded), axis_.limits.profile(axis_.mode), commanded};
  acknowledged_ = true;
  const TrapezoidProfile& profile = axis_.demand.profile;
  const bool busy = profile.position() != active_.target || profile.velocity() != 0.0;
  if (immediately || !busy) {
    active_ = next;
    buffered_.reset();
  } else {
    buffered_ = next;
  }
}

void ProfilePosition::step() {
  TrapezoidProfile& profile = axis_.demand.profile;
  if (!axis_.mode->handshake) {
    active_ = {axis_.trueTarget(axis_.values.get(Role::target_position, 0.0)),
               axis_.limits.profile(axis_.mode),
               {}};
  }
  if (active_.commanded)
    axis_.limits.clamped(*active_.commanded);  // a limit goes on to be in the way
  if (axis_.blocked(active_.target - profile.position())) {
    profile.stop(axis_.limits.deceleration(Ramp::quick_stop, axis_.mode));
  } else {
    profile.step(active_.target, active_.limits);
  }
  if (buffered_ && profile.position() == active_.target && profile.velocity() == 0.0) {
    active_ = *buffered_;
    buffered_.reset();
    if (!bit_) acknowledged_ = false;
  }
  axis_.demand.followProfile();
  axis_.motor.followPosition(axis_.demand.position);
}

}  // namespace cia402::sim
