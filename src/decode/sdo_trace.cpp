// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/sdo_trace.h"

#include <algorithm>

namespace cia402::decode {

void SdoTrace::begin(fieldbus::ObjectId object, Transfer transfer) {
  transfer_ = transfer;
  object_ = object;
  known_ = true;
  in_block_ = false;
  data_.clear();
  received_ = block_began_ = 0;
  last_segment_seen_ = false;
}

void SdoTrace::abort() {
  transfer_ = Transfer::none;
  in_block_ = known_ = false;
}

void SdoTrace::collect(const can::Frame& frame, std::size_t count) {
  received_ += count;
  for (std::size_t i = 1; i <= count && data_.size() < kKept; ++i) data_.push_back(frame.data[i]);
}

void SdoTrace::collectBlockSegment(const can::Frame& frame, bool last) {
  collect(frame, 7);
  last_segment_seen_ = last_segment_seen_ || last;
}

void SdoTrace::acknowledge(std::uint8_t segments) {
  const std::size_t taken =
      std::min<std::size_t>(received_, block_began_ + std::size_t{7} * segments);
  const bool complete = taken == received_;
  in_block_ = in_block_ && !(complete && last_segment_seen_);
  last_segment_seen_ = last_segment_seen_ && complete;
  block_began_ = taken;
  cut(taken);
}

void SdoTrace::endBlocks(std::size_t unused) {
  in_block_ = false;
  if (received_ >= unused) cut(received_ - unused);
}

/// Only so many bytes have come after all.
void SdoTrace::cut(std::size_t size) {
  received_ = size;
  if (data_.size() > size) data_.resize(size);
}

}  // namespace cia402::decode
