// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/time.h"

#include "fieldbus/abort_code.h"
#include "sim/device/cob_id.h"
#include "sim/device/frame.h"

namespace cia402::sim {

namespace {

constexpr ObjectId kCobId{0x1012, 0};
constexpr std::uint32_t kConsumes = 0x80000000;
constexpr std::uint32_t kProduces = 0x40000000;
constexpr std::uint64_t kMillisecondBits = 0x0FFFFFFF;  // 28 bits, four more are reserved

// Nothing here produces TIME; an identifier stays while the object is in use.
std::uint32_t checkTimeCobId(const Entry& entry, std::uint64_t number) {
  const auto old = static_cast<std::uint32_t>(entry.number);
  const auto next = static_cast<std::uint32_t>(number);
  if ((next & kProduces) != 0) return fieldbus::abort_code::kInvalidValue;
  // checkCobId() takes bit 31 for "does not exist", here it says "listens".
  return checkCobId(old ^ kCobIdInvalid, next ^ kCobIdInvalid, true);
}

}  // namespace

void SlaveTime::serveObjects() {
  context_.serveWrites(kCobId, checkTimeCobId, [this](const Entry&) { start(); });
}

void SlaveTime::start() {
  const auto cob_id = static_cast<std::uint32_t>(context_.value(kCobId));
  cob_id_ = (cob_id & kConsumes) != 0 ? cob_id & kCobIdMask : kNoCanId;
}

void SlaveTime::receive(const can::Frame& frame) {
  if (frame.remote || frame.size != 6) return;
  last_ = ReceivedTime{static_cast<std::uint32_t>(takeBytes(frame, 0, 4) & kMillisecondBits),
                       static_cast<std::uint16_t>(takeBytes(frame, 4, 2)), context_.now};
}

}  // namespace cia402::sim
