// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/limit_keeper.h"

#include <utility>

namespace cia402::drive {

LimitKeeper::LimitKeeper(AxisBasis& axis, const Coordinates& coordinates)
    : axis_(axis), coordinates_(coordinates), limits_(axis.config) {}

void LimitKeeper::open(bool open) {
  if (open_ == open) return;
  open_ = open;
  renew();
}

void LimitKeeper::adopt() {
  limits_.adopt(axis_.config);
  renew();
}

void LimitKeeper::forget() {
  limits_.forget();
  renew();
}

void LimitKeeper::work(double target) {
  const bool known = belong();
  const AxisState& state = axis_.state;
  if (state.feedback_valid) {
    if (std::exchange(due_, false) || known != known_) {
      known_ = known;
      limits_.aim(known, coordinates_.shift(), state.position);
    }
    limits_.closeIfInside(state.position, target);
  }
  limits_.advance(axis_.device.objects());
  homed_ = state.homed;
  works_ = !limits_.idle() || due_ || known != known_;
}

}  // namespace cia402::drive
