// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sync.h"

#include "fieldbus/abort_code.h"
#include "sim/device/cob_id.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

constexpr ObjectId kCobId{0x1005, 0};
constexpr ObjectId kPeriod{0x1006, 0};
constexpr ObjectId kWindow{0x1007, 0};
constexpr ObjectId kCounterOverflow{0x1019, 0};
constexpr std::uint16_t kUnexpectedLength = 0x8240;
constexpr std::uint16_t kSyncTimeout = 0x8201;

}  // namespace

void SlaveSync::serveObjects() {
  context_.serveWrites(
      kCobId, [this](const Entry& entry, std::uint64_t number) { return check(entry, number); },
      [this](const Entry&) { start(); });
  context_.serveWrites(kPeriod, nullptr, [this](const Entry&) {
    deadline_ = kNever;
    start();
  });
  context_.serveWrites(
      kCounterOverflow,
      [this](const Entry&, std::uint64_t number) {
        if (context_.value(kPeriod) != 0) return abort_code::kDeviceState;
        return number == 1 || number > 240 ? abort_code::kInvalidValue : 0U;
      },
      nullptr);
}

void SlaveSync::reset() {
  deadline_ = next_ = kNever;
  produced_.reset();
  context_.sync_window_end = kNever;
  wrong_length_ = false;
  timed_out_ = false;
}

void SlaveSync::start() {
  cob_id_ = static_cast<std::uint32_t>(context_.value(kCobId, 0x80)) & kCobIdMask;
  overflow_ = context_.dictionary.find(kCounterOverflow);
  period_ = context_.dictionary.find(kPeriod);
  const bool produces = (context_.value(kCobId) & kCobIdGenerateSync) != 0;
  next_ = produces && period() > Duration::zero() ? context_.now + period() : kNever;
  counter_ = 1;
}

// The identifier stays while SYNC is produced (CiA 301, 7.5.2.5).
std::uint32_t SlaveSync::check(const Entry& entry, std::uint64_t number) const {
  const auto cob_id = static_cast<std::uint32_t>(number);
  const bool produces = (cob_id & kCobIdGenerateSync) != 0;
  if (produces && !context_.behaviour.sync_producer) return abort_code::kInvalidValue;
  if (context_.behaviour.fixed_service_ids) {
    if (((entry.number ^ number) & ~std::uint64_t{kCobIdGenerateSync}) != 0) {
      return abort_code::kInvalidValue;
    }
    if (produces && period() <= Duration::zero()) return abort_code::kDeviceState;
  }
  const bool was_producing = (entry.number & kCobIdGenerateSync) != 0;
  if (was_producing && produces && entry.number != number) return abort_code::kInvalidValue;
  return checkCobId(kCobIdInvalid, cob_id & ~(kCobIdInvalid | kCobIdGenerateSync), true);
}

Duration SlaveSync::period() const {
  return std::chrono::microseconds(static_cast<std::int64_t>(context_.value(kPeriod)));
}

void SlaveSync::produce() {
  const std::uint64_t overflow = context_.value(kCounterOverflow);
  can::Frame frame(cob_id_, {});
  if (overflow != 0) {
    frame = can::Frame(cob_id_, {counter_});
    counter_ = counter_ >= overflow ? std::uint8_t{1} : static_cast<std::uint8_t>(counter_ + 1);
  }
  next_ += period();
  if (next_ <= context_.now) next_ = context_.now + period();
  if (!context_.communicating()) return;
  context_.sink.send(frame);
  produced_ = frame;
}

std::optional<can::Frame> SlaveSync::takeProduced() {
  const auto frame = produced_;
  produced_.reset();
  return frame;
}

std::optional<std::uint8_t> SlaveSync::accept(const can::Frame& frame) {
  if (frame.remote) return std::nullopt;
  const bool counted = overflow_ != nullptr && overflow_->number != 0;
  const bool plain_taken = counted && frame.size == 0 && context_.behaviour.accepts_plain_sync;
  if (frame.size != (counted ? 1 : 0) && !plain_taken) {
    emergency_.raise(wrong_length_, kUnexpectedLength);
    return std::nullopt;
  }
  emergency_.resolve(wrong_length_);
  emergency_.resolve(timed_out_);
  const std::chrono::microseconds window(static_cast<std::int64_t>(context_.value(kWindow)));
  context_.sync_window_end = window.count() > 0 ? context_.now + window : kNever;
  if (context_.behaviour.sync_timeout && period_ != nullptr && period_->number != 0) {
    const std::chrono::microseconds period(static_cast<std::int64_t>(period_->number));
    deadline_ = context_.now + Duration(period) * 3 / 2;
  }
  return frame.size == 0 ? std::uint8_t{0} : frame.data[0];
}

void SlaveSync::tick() {
  if (next_ <= context_.now) produce();
  if (deadline_ > context_.now) return;
  deadline_ = kNever;
  emergency_.raise(timed_out_, kSyncTimeout);
}

}  // namespace cia402::sim
