// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/rpdo.h"

#include "sim/device/cob_id.h"
#include "sim/device/frame.h"

namespace cia402::sim {

namespace {

constexpr std::uint16_t kCommunication = 0x1400;
constexpr std::uint16_t kMapping = 0x1600;
constexpr std::uint64_t kMaxSync = 240;
constexpr std::uint32_t kNoCanId = 0xFFFFFFFF;

constexpr std::uint16_t kTooShort = 0x8210;
constexpr std::uint16_t kTooLong = 0x8220;
constexpr std::uint16_t kTimeout = 0x8250;

}  // namespace

SlaveRpdo::SlaveRpdo(SlaveContext& context, SlaveEmergency& emergency, unsigned number)
    : context_(context),
      emergency_(emergency),
      records_{PdoDirection::receive, static_cast<std::uint16_t>(kCommunication + number),
               static_cast<std::uint16_t>(kMapping + number)},
      can_id_(kNoCanId) {}

void SlaveRpdo::configure() {
  const std::uint16_t index = records_.communication;
  const auto cob_id = static_cast<std::uint32_t>(context_.value({index, pdo_sub::kCobId}));
  can_id_ = isValid(context_, records_) ? cob_id & kCobIdMask : kNoCanId;
  synchronous_ =
      context_.value({index, pdo_sub::kType}, 255) <= kMaxSync && !context_.behaviour.rpdos_at_once;
  event_time_ = std::chrono::milliseconds(
      static_cast<std::int64_t>(context_.value({index, pdo_sub::kEventTimer})));
  const bool fillers = context_.behaviour.fixed_map_entries != 0;
  mapping_.build(context_.dictionary, records_.mapping, records_.direction, fillers);
  stop();
}

void SlaveRpdo::stop() {
  waiting_ = false;
  deadline_ = kNever;
  emergency_.resolve(too_short_);
  emergency_.resolve(too_long_);
  emergency_.resolve(timed_out_);
}

void SlaveRpdo::receive(const can::Frame& frame) {
  if (frame.remote || mapping_.empty()) return;
  if (!lengthFits(frame)) return;
  if (event_time_ > Duration::zero()) deadline_ = context_.now + event_time_;
  emergency_.resolve(timed_out_);
  const std::uint64_t data = takeBytes(frame, 0, mapping_.size());
  if (!synchronous_) return apply(data);
  if (context_.now > context_.sync_window_end) return;  // too late, to be discarded (1007h)
  data_ = data;
  waiting_ = true;
}

// One report until a frame of the right length comes.
bool SlaveRpdo::lengthFits(const can::Frame& frame) {
  if (frame.size < mapping_.size()) {
    emergency_.raise(too_short_, kTooShort);
    return false;
  }
  emergency_.resolve(too_short_);
  if (frame.size > mapping_.size()) {
    emergency_.raise(too_long_, kTooLong);
  } else {
    emergency_.resolve(too_long_);
  }
  return true;
}

void SlaveRpdo::onSync() {
  if (!waiting_) return;
  waiting_ = false;
  apply(data_);
}

void SlaveRpdo::apply(std::uint64_t data) {
  mapping_.unpack(data, context_.dictionary);
  context_.application.onRpdo(context_.now);
}

void SlaveRpdo::tick() {
  if (deadline_ > context_.now) return;
  deadline_ = kNever;
  emergency_.raise(timed_out_, kTimeout);
  context_.otherCommunicationError();
}

}  // namespace cia402::sim
