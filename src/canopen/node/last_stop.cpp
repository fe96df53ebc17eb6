// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/last_stop.h"

namespace cia402::canopen {
namespace {

constexpr unsigned kMotorStops = 5;  // by SDO, ...
constexpr Duration kMotorInterval = std::chrono::milliseconds(8);
constexpr unsigned kQuickStops = 5;  // ... then by NMT, ...
constexpr Duration kQuickInterval = std::chrono::milliseconds(20);
constexpr Duration kSlowInterval = std::chrono::milliseconds(100);  // ... and at last so often
constexpr Duration kPatience = std::chrono::milliseconds(500);
constexpr Duration kEnough = std::chrono::seconds(3);
constexpr Duration kOnItsWay = std::chrono::milliseconds(10);  // a heartbeat of before the command

}  // namespace

void LastStop::begin(Time now) {
  patience_end_ = now + kPatience;
  end_ = now + kEnough;
  restart(now);
}

void LastStop::restart(Time now) {
  said_ = 0;
  next_ = now;
  tick(now);
}

void LastStop::tick(Time now) {
  if (now < next_) return;
  if (now >= end_) return end();
  last_ = now;
  if (said_ < kMotorStops) {
    ++said_;
    next_ = now + kMotorInterval;
    if (stopMotor()) return;
    said_ = kMotorStops;
  }
  sink_.send(nmtFrame(NmtCommand::stop, config_.node_id));
  const bool quickly = ++said_ < kMotorStops + kQuickStops;
  next_ = now + (quickly ? kQuickInterval : kSlowInterval);
}

bool LastStop::stopMotor() {
  bool told = false;
  for (const StartupWrite& write : config_.writes) {
    if (write.always) told = sdo_.post(write.object, write.data) || told;
  }
  return told;
}

bool LastStop::insists(NmtState state, Time now) {
  if (next_ == kNever || state != NmtState::operational || now >= patience_end_) return false;
  if (now >= last_ + kOnItsWay) restart(now);
  return true;
}

}  // namespace cia402::canopen
