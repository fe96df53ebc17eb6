// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/tpdo.h"

#include <algorithm>

#include "sim/device/cob_id.h"
#include "sim/device/frame.h"

namespace cia402::sim {

namespace {

constexpr std::uint16_t kCommunication = 0x1800;
constexpr std::uint16_t kMapping = 0x1A00;
constexpr Duration kInhibitUnit = std::chrono::microseconds(100);

// Transmission types (CiA 301, table 72).
constexpr unsigned kAcyclic = 0;
constexpr unsigned kMaxCyclic = 240;
constexpr unsigned kRequestSynchronous = 252;
constexpr unsigned kEventVendor = 254;
constexpr unsigned kEventProfile = 255;

}  // namespace

SlaveTpdo::SlaveTpdo(SlaveContext& context, unsigned number)
    : context_(context),
      records_{PdoDirection::transmit, static_cast<std::uint16_t>(kCommunication + number),
               static_cast<std::uint16_t>(kMapping + number)} {}

void SlaveTpdo::configure() {
  const std::uint16_t index = records_.communication;
  const auto number = [&](std::uint8_t sub, std::uint64_t missing) {
    return static_cast<std::int64_t>(context_.value({index, sub}, missing));
  };
  const auto cob_id = static_cast<std::uint32_t>(number(pdo_sub::kCobId, kCobIdInvalid));
  can_id_ = (cob_id & kCobIdInvalid) == 0 ? cob_id & kCobIdMask : kNoCanId;
  rtr_allowed_ = (cob_id & kCobIdNoRtr) == 0;
  type_ = static_cast<unsigned>(number(pdo_sub::kType, kEventProfile));
  inhibit_time_ = kInhibitUnit * number(pdo_sub::kInhibitTime, 0);
  event_time_ = std::chrono::milliseconds(number(pdo_sub::kEventTimer, 0));
  sync_start_ = static_cast<std::uint8_t>(number(pdo_sub::kSyncStart, 0));
  const bool fillers = context_.behaviour.fixed_map_entries != 0;
  mapping_.build(context_.dictionary, records_.mapping, records_.direction, fillers);
  if (running_) start();
}

void SlaveTpdo::start() {
  running_ = true;
  counting_ = false;
  syncs_ = 0;
  sent_ = false;
  words_.clear();
  sampled_ = false;
  waiting_ = false;
  inhibited_until_ = Time::min();
  event_deadline_ = eventDriven() && event_time_ > Duration::zero() && active()
                        ? context_.now + event_time_
                        : kNever;
}

void SlaveTpdo::stop() {
  running_ = false;
  waiting_ = false;
  event_deadline_ = kNever;
}

bool SlaveTpdo::eventDriven() const { return type_ >= kEventVendor && valid(); }

bool SlaveTpdo::sendsOnChange() const {
  const bool timer_only = type_ == kEventProfile && context_.behaviour.type255_event_timer_only;
  return running_ && eventDriven() && !timer_only;
}

bool SlaveTpdo::wantsSample(std::uint8_t counter) {
  if (!active()) return false;
  if (type_ == kAcyclic || type_ == kRequestSynchronous) return true;
  if (type_ > kMaxCyclic) return false;
  // The count begins with the SYNC that carries the start value (CiA 301, 7.5.2.37).
  if (!counting_ && sync_start_ != 0 && counter != 0 && counter != sync_start_) return false;
  counting_ = true;
  if (++syncs_ < type_) return false;
  syncs_ = 0;
  return true;
}

/// What a SYNC makes it send, with the statusword of a moment ago where the device is like that.
std::uint64_t SlaveTpdo::sample() {
  const std::uint64_t data = mapping_.pack();
  const auto place = mapping_.placeOf({0x6041, 0});
  const Duration lag = context_.behaviour.stale_statusword;
  if (lag == Duration::zero() || records_.mapping == kMapping || !place) return data;
  const std::uint64_t word = data >> *place & 0xFFFFU;
  if (words_.empty() || word != words_.back().word) words_.push_back({word, context_.now});
  while (words_.size() > 1 && context_.now - words_[1].since >= lag) words_.erase(words_.begin());
  return (data & ~(std::uint64_t{0xFFFF} << *place)) | words_.front().word << *place;
}

void SlaveTpdo::onSync() {
  const std::uint64_t data = sample();
  if (type_ == kRequestSynchronous) {
    sampled_data_ = data;
    sampled_ = true;
    return;
  }
  if (type_ != kAcyclic || isNew(data)) transmit(data);
}

void SlaveTpdo::onChange() {
  if (!sendsOnChange()) return;
  const std::uint64_t data = mapping_.pack();
  if (isNew(data)) trigger(data);
}

void SlaveTpdo::onStart() {
  if (sendsOnChange()) trigger(mapping_.pack());
}

void SlaveTpdo::onRequest() {
  if (!active()) return;
  if (type_ != kRequestSynchronous) return transmit(mapping_.pack());
  if (sampled_) transmit(sampled_data_);
}

void SlaveTpdo::trigger(std::uint64_t data) {
  if (context_.now < inhibited_until_) {
    waiting_ = true;
    return;
  }
  transmit(data);
}

void SlaveTpdo::transmit(std::uint64_t data) {
  const int size = int{mapping_.size()} + context_.behaviour.tpdo_size_error;
  can::Frame frame = emptyFrame(can_id_, static_cast<std::uint8_t>(std::clamp(size, 0, 8)));
  putBytes(frame, 0, frame.size, data);
  context_.sink.send(frame);
  last_ = data;
  sent_ = true;
  waiting_ = false;
  if (!eventDriven()) return;
  inhibited_until_ = context_.now + inhibit_time_;
  if (event_time_ > Duration::zero()) event_deadline_ = context_.now + event_time_;
}

void SlaveTpdo::tick() {
  if (event_deadline_ <= context_.now) {
    event_deadline_ = kNever;
    waiting_ = true;
  }
  if (waiting_ && inhibited_until_ <= context_.now) transmit(mapping_.pack());
}

Time SlaveTpdo::deadline() const {
  return waiting_ ? std::min(event_deadline_, inhibited_until_) : event_deadline_;
}

}  // namespace cia402::sim
