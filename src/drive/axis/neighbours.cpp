// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/neighbours.h"

#include "drive/axis/core.h"

namespace cia402::drive {
namespace {

/// Is it known that the device can be taken from it? A device that is not ready has no power stage
/// that anybody commands.
bool mayLoseDevice(const AxisCore& axis) {
  return !axis.deviceReady() ||
         (axis.objects().signals.fresh(SignalId::statusword) && axis.powerOff());
}

}  // namespace

std::string Neighbours::refusal() const {
  std::string names;
  for (const AxisCore* axis : all_) {
    if (mayLoseDevice(*axis)) continue;
    names += (names.empty() ? "" : ", ") + jointName(axis->config());
  }
  if (names.empty()) return {};
  return names + ", in the same drive, may be under power: disable it first";
}

std::string Neighbours::text() const {
  std::string text;
  for (const AxisCore* axis : all_) {
    text += (text.empty() ? "; in the same drive: " : ", ") + jointName(axis->config()) + " (" +
            (axis->state().state == State::unknown ? "no statusword yet"
                                                   : toString(axis->state().state)) +
            ")";
  }
  return text;
}

void Neighbours::loseZero() {
  for (AxisCore* axis : all_) axis->loseZero();
}

void Neighbours::measureAnew() {
  for (AxisCore* axis : all_) axis->measureAnew();
}

void Neighbours::wantPowerCycle(const std::string& why) {
  for (AxisCore* axis : all_) axis->control().wantPowerCycle(why);
}

}  // namespace cia402::drive
