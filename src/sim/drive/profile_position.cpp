// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/profile_position.h"

#include <algorithm>
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
  waiting_.clear();
  smooth_.reset(demand.position);
  acknowledged_ = false;
  bit_ = false;
  if (!ofThisMode()) return;
  active_.limits = axis_.limits.profile(axis_.mode);
  if (active_.limits.deceleration > 0.0) {
    active_.target +=
        demand.velocity * std::fabs(demand.velocity) / (2.0 * active_.limits.deceleration);
  }
}

void ProfilePosition::stopped() {
  if (!ofThisMode() || !axis_.mode->stop_empties_queue) return;
  waiting_.clear();
  if (!bit_) acknowledged_ = false;
}

bool ProfilePosition::full() const {
  return waiting_.size() >= static_cast<std::size_t>(axis_.mode->queue);
}

bool ProfilePosition::control(std::uint16_t controlword, std::uint16_t previous) {
  if (!ofThisMode()) return false;
  const unsigned mask = 1U << axis_.mode->set_point_bit;
  bit_ = (controlword & mask) != 0;
  const bool replaces = axis_.mode->replaces_queue && (controlword & kImmediately) != 0;
  const bool accepts = bit_ && (previous & mask) == 0 && (!acknowledged_ || replaces);
  if (accepts) accept(controlword);
  if (!bit_) acknowledged_ = full();
  return accepts;
}

/// What a relative set-point counts from, true turns (60F2h).
double ProfilePosition::base() const {
  switch (axis_.values.raw(Role::positioning_option, 0)) {
    case 1:
      return axis_.demand.position;
    case 2:
      return axis_.motor.position();
    default:
      return waiting_.empty() ? active_.target : waiting_.back().target;
  }
}

void ProfilePosition::accept(std::uint16_t controlword) {
  const bool immediately = (controlword & kImmediately) != 0;
  const bool relative = (controlword & kRelative) != 0;
  const double turns = axis_.commanded(Role::target_position);
  const double commanded = relative ? base() - axis_.frame + turns : turns;
  const SetPoint next{axis_.trueTarget(commanded), axis_.limits.profile(axis_.mode), commanded};
  acknowledged_ = true;
  const TrapezoidProfile& profile = axis_.demand.profile;
  const bool busy = profile.position() != active_.target || profile.velocity() != 0.0;
  if (immediately || !busy) {
    active_ = next;
    waiting_.clear();
  } else {
    waiting_.push_back(next);
  }
}

/// The demand is where the profile is, or comes there with limited jerk.
void ProfilePosition::follow() {
  Demand& demand = axis_.demand;
  const double before = demand.position;
  demand.followProfile();
  const double corners = axis_.limits.cornerTime(active_.limits);
  if (corners == 0.0) return smooth_.reset(demand.position);
  smooth_.limit(corners);
  demand.position = smooth_.step(demand.profile.position());
  demand.velocity = (demand.position - before) / kDriveStepS;
}

void ProfilePosition::beginNext() {
  const TrapezoidProfile& profile = axis_.demand.profile;
  const bool there = profile.position() == active_.target && profile.velocity() == 0.0;
  if (waiting_.empty() || !there || axis_.demand.velocity != 0.0) return;
  active_ = waiting_.front();
  waiting_.pop_front();
  if (!bit_) acknowledged_ = false;
}

void ProfilePosition::step() {
  TrapezoidProfile& profile = axis_.demand.profile;
  if (!axis_.mode->handshake) {
    active_ = {axis_.trueTarget(axis_.commanded(Role::target_position)),
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
  follow();
  beginNext();
  axis_.motor.followPosition(axis_.demand.position);
}

}  // namespace cia402::sim
