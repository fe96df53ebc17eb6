// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/sync_producer.h"

namespace cia402::sim {

void SyncProducer::start(const SyncSchedule& schedule, Time now) {
  schedule_ = schedule;
  slot_ = now;
  due_ = slot_ + lateness();
  counter_ = 1;
}

Duration SyncProducer::lateness() {
  const double share = static_cast<double>(generator_() >> 11) * 0x1p-53;
  return Duration(static_cast<std::int64_t>(share * static_cast<double>(schedule_.jitter.count())));
}

void SyncProducer::tick(Time now) {
  if (due_ > now || sink_ == nullptr) return;
  can::Frame frame(schedule_.cob_id, {});
  if (schedule_.counter_overflow != 0) {
    frame = can::Frame(schedule_.cob_id, {counter_});
    counter_ = counter_ >= schedule_.counter_overflow ? std::uint8_t{1}
                                                      : static_cast<std::uint8_t>(counter_ + 1);
  }
  sink_->send(frame);
  ++sent_;
  slot_ += schedule_.period;
  due_ = slot_ + lateness();
}

}  // namespace cia402::sim
