// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/nmt/heartbeat.h"

namespace cia402::canopen {

void HeartbeatConsumer::arm(Time now) {
  allowed_ = true;
  deadline_ = now + timeout_;
}

void HeartbeatConsumer::disarm() {
  allowed_ = false;
  deadline_ = kNever;
}

void HeartbeatConsumer::heard(Time now) {
  if (allowed_) deadline_ = now + timeout_;
}

void HeartbeatProducer::start(can::Sink& sink, Time now) {
  send(sink, NmtState::boot_up);
  if (period_ <= Duration::zero()) return;
  send(sink, NmtState::operational);
  deadline_ = now + period_;
}

void HeartbeatProducer::tick(can::Sink& sink, Time now) {
  if (now < deadline_) return;
  send(sink, NmtState::operational);
  deadline_ += period_;
  if (deadline_ <= now) deadline_ = now + period_;  // woken late: no burst to catch up
}

void HeartbeatProducer::send(can::Sink& sink, NmtState state) const {
  sink.send(can::Frame(0x700U + node_, {static_cast<std::uint8_t>(state)}));
}

}  // namespace cia402::canopen
