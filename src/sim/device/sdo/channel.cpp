// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/sdo/channel.h"

#include "fieldbus/abort_code.h"
#include "sim/device/frame.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

constexpr std::uint8_t kAborted = 0x80;

}  // namespace

ObjectId sdoObjectOf(const can::Frame& request) {
  return {static_cast<std::uint16_t>(takeBytes(request, 1, 2)), request.data[3]};
}

void SdoChannel::begin(const can::Frame& request) {
  object = sdoObjectOf(request);
  transfer = SdoTransfer::none;
}

void SdoChannel::answer(std::uint8_t command, std::uint32_t value) {
  can::Frame frame = emptyFrame(answer_id, 8);
  frame.data[0] = command;
  putBytes(frame, 1, 2, object.index);
  frame.data[3] = object.subindex;
  putBytes(frame, 4, 4, value);
  context.sink.send(frame);
}

void SdoChannel::abort(std::uint32_t code) {
  transfer = SdoTransfer::none;
  const bool missing = code == abort_code::kNoSuchObject || code == abort_code::kNoSuchSubindex;
  if (missing && context.behaviour.silent_on_missing) return;
  const bool length = code == abort_code::kLengthTooHigh || code == abort_code::kLengthTooLow;
  answer(kAborted,
         length && context.behaviour.generic_length_abort ? abort_code::kLengthMismatch : code);
}

void SdoChannel::abortInvalid() { abort(abort_code::kInvalidCommand); }

}  // namespace cia402::sim
