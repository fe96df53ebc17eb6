// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/sync.h"

namespace cia402::canopen {
namespace {

constexpr std::uint32_t kSyncCobId = 0x080;  // default of 1005h

}  // namespace

can::Frame SyncProducer::next() {
  if (overflow_ == 0) return can::Frame(kSyncCobId, {});
  counter_ = counter_ >= overflow_ ? std::uint8_t{1} : static_cast<std::uint8_t>(counter_ + 1);
  return can::Frame(kSyncCobId, {counter_});
}

}  // namespace cia402::canopen
