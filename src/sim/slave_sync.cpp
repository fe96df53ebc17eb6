// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_sync.h"

#include "cia402_driver/canopen/abort_code.h"
#include "slave_cob_id.h"

namespace cia402::sim {

namespace abort_code = canopen::abort_code;

namespace {

constexpr ObjectId kCobId{0x1005, 0};
constexpr ObjectId kPeriod{0x1006, 0};
constexpr ObjectId kCounterOverflow{0x1019, 0};
constexpr std::uint16_t kUnexpectedLength = 0x8240;
constexpr std::uint16_t kSyncTimeout = 0x8201;

std::uint32_t checkSyncCobId(const Entry&, std::uint64_t number) {
  const auto cob_id = static_cast<std::uint32_t>(number);
  if ((cob_id & kCobIdGenerateSync) != 0) return abort_code::kInvalidValue;
  return checkCobId(kCobIdInvalid, cob_id & ~kCobIdInvalid, true);
}

}  // namespace

void SlaveSync::serveObjects() {
  context_.serveWrites(kCobId, checkSyncCobId, [this](const Entry&) { start(); });
  context_.serveWrites(kPeriod, nullptr, [this](const Entry&) { deadline_ = kNever; });
  context_.serveWrites(
      kCounterOverflow,
      [this](const Entry&, std::uint64_t number) {
        if (context_.value(kPeriod) != 0) return abort_code::kDeviceState;
        return number == 1 || number > 240 ? abort_code::kInvalidValue : 0U;
      },
      nullptr);
}

void SlaveSync::reset() {
  deadline_ = kNever;
  wrong_length_ = false;
  timed_out_ = false;
}

void SlaveSync::start() {
  cob_id_ = static_cast<std::uint32_t>(context_.value(kCobId, 0x80)) & kCobIdMask;
  overflow_ = context_.dictionary.find(kCounterOverflow);
  period_ = context_.dictionary.find(kPeriod);
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
  if (context_.behaviour.sync_timeout && period_ != nullptr && period_->number != 0) {
    const std::chrono::microseconds period(static_cast<std::int64_t>(period_->number));
    deadline_ = context_.now + Duration(period) * 3 / 2;
  }
  return frame.size == 0 ? std::uint8_t{0} : frame.data[0];
}

void SlaveSync::tick() {
  if (deadline_ > context_.now) return;
  deadline_ = kNever;
  emergency_.raise(timed_out_, kSyncTimeout);
}

}  // namespace cia402::sim
