// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/emergency.h"

#include "fieldbus/abort_code.h"
#include "sim/device/cob_id.h"
#include "sim/device/frame.h"

namespace cia402::sim {

namespace {

constexpr ObjectId kErrorRegister{0x1001, 0};
constexpr std::uint16_t kErrorHistory = 0x1003;
constexpr ObjectId kErrorCount{kErrorHistory, 0};
constexpr ObjectId kCobId{0x1014, 0};
constexpr ObjectId kInhibitTime{0x1015, 0};
constexpr Duration kInhibitUnit = std::chrono::microseconds(100);

constexpr std::uint64_t kGenericError = 0x01;
constexpr std::uint64_t kCommunicationError = 0x10;

}  // namespace

void SlaveEmergency::serveObjects() {
  context_.serveWrites(
      kCobId,
      [this](const Entry& entry, std::uint64_t number) {
        const std::uint64_t changed = (entry.number ^ number) & ~std::uint64_t{kCobIdInvalid};
        if (context_.behaviour.fixed_service_ids && changed != 0) {
          return fieldbus::abort_code::kInvalidValue;
        }
        return checkCobId(static_cast<std::uint32_t>(entry.number),
                          static_cast<std::uint32_t>(number), false);
      },
      nullptr);
  context_.serveWrites(
      kErrorCount,
      [](const Entry&, std::uint64_t number) {
        return number == 0 ? 0U : fieldbus::abort_code::kInvalidValue;
      },
      [this](const Entry&) { clearHistory(); });
  for (unsigned sub = 1; sub <= 0xFE; ++sub) {
    const ObjectId id{kErrorHistory, static_cast<std::uint8_t>(sub)};
    if (context_.dictionary.find(id) == nullptr) continue;
    context_.dictionary.onRead(id, [this](const Entry& entry) {
      return entry.id.subindex <= context_.value(kErrorCount) ? 0U : fieldbus::abort_code::kNoData;
    });
    context_.hooked.push_back(id);
  }
}

void SlaveEmergency::reset() {
  head_ = 0;
  waiting_ = 0;
  inhibited_until_ = Time::min();
  active_ = 0;
}

void SlaveEmergency::send(std::uint16_t code, std::uint8_t error_register,
                          const std::array<std::uint8_t, 5>& vendor) {
  if (Entry* entry = context_.dictionary.find(kErrorRegister)) entry->number = error_register;
  remember(code, vendor);
  queue(code, error_register, vendor);
}

void SlaveEmergency::remember(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor) {
  const std::uint32_t additional = vendor[0] | static_cast<std::uint32_t>(vendor[1]) << 8U;
  enterHistory(code | additional << 16U);
}

void SlaveEmergency::clear(std::uint8_t remaining) {
  if (Entry* entry = context_.dictionary.find(kErrorRegister)) entry->number = remaining;
  queue(0x0000, remaining, {});
}

void SlaveEmergency::raise(bool& active, std::uint16_t code) {
  if (active) return;
  active = true;
  ++active_;
  const std::uint64_t bits = context_.value(kErrorRegister) | kGenericError | kCommunicationError;
  send(code, static_cast<std::uint8_t>(bits), {});
}

void SlaveEmergency::resolve(bool& active) {
  if (!active) return;
  active = false;
  if (active_ > 0) --active_;
  if (active_ > 0) return;
  Entry* entry = context_.dictionary.find(kErrorRegister);
  if (entry == nullptr || (entry->number & kCommunicationError) == 0) return;
  entry->number &= ~kCommunicationError;
  if (context_.application.hasFault() || (entry->number & ~kGenericError) != 0) return;
  clear();
}

void SlaveEmergency::enterHistory(std::uint32_t field) {
  Entry* count = context_.dictionary.find(kErrorCount);
  if (count == nullptr) return;
  std::uint8_t last = 0;
  while (last < 0xFE &&
         context_.dictionary.find({kErrorHistory, static_cast<std::uint8_t>(last + 1)}))
    ++last;
  for (std::uint8_t sub = last; sub > 1; --sub) {
    context_.dictionary.find({kErrorHistory, sub})->number =
        context_.dictionary.find({kErrorHistory, static_cast<std::uint8_t>(sub - 1)})->number;
  }
  if (last == 0) return;
  context_.dictionary.find({kErrorHistory, 1})->number = field;
  if (count->number < last) ++count->number;
}

void SlaveEmergency::clearHistory() {
  for (std::uint8_t sub = 1; sub <= 0xFE; ++sub) {
    Entry* entry = context_.dictionary.find({kErrorHistory, sub});
    if (entry == nullptr) return;
    entry->number = 0;
  }
}

void SlaveEmergency::queue(std::uint16_t code, std::uint8_t error_register,
                           const std::array<std::uint8_t, 5>& vendor) {
  const auto cob_id = static_cast<std::uint32_t>(context_.value(kCobId, kCobIdInvalid));
  if ((cob_id & kCobIdInvalid) != 0 || waiting_ == kQueueSize) return;
  can::Frame frame = emptyFrame(cob_id & kCobIdMask, 8);
  putBytes(frame, 0, 2, code);
  frame.data[2] = error_register;
  for (std::size_t i = 0; i < vendor.size(); ++i) frame.data[3 + i] = vendor[i];
  queue_[(head_ + waiting_) % kQueueSize] = frame;
  ++waiting_;
  tick();
}

void SlaveEmergency::tick() {
  while (waiting_ > 0 && deadline() <= context_.now) {
    context_.sink.send(queue_[head_]);
    head_ = (head_ + 1) % kQueueSize;
    --waiting_;
    inhibited_until_ =
        context_.now + kInhibitUnit * static_cast<std::int64_t>(context_.value(kInhibitTime));
  }
}

Time SlaveEmergency::deadline() const {
  return waiting_ > 0 && context_.communicating() ? inhibited_until_ : kNever;
}

}  // namespace cia402::sim
