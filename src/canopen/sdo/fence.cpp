// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/fence.h"

#include "canopen/sdo/frames.h"

namespace cia402::canopen {
namespace {

// Both never change while the device runs, so that even a late answer would be right.
constexpr ObjectId kDeviceType{0x1000, 0}, kIdentityCount{0x1018, 0};

}  // namespace

void SdoFence::abandon(ObjectId object, bool looks_like_anything) {
  abandoned_ = object;
  reads_left_ = looks_like_anything ? 2 : 1;
  other_ = false;
}

void SdoFence::expectNothingOf(ObjectId object) {
  if (!isUp()) abandon(object, false);
}

bool SdoFence::expectMore() {
  const ObjectId before = object();
  other_ = !other_;
  if (object() != before) return true;
  ++reads_left_;
  return false;
}

ObjectId SdoFence::object() const {
  if (abandoned_->index == kIdentityCount.index) return kDeviceType;
  if (abandoned_->index == kDeviceType.index) return kIdentityCount;
  return other_ != (reads_left_ > 1) ? kIdentityCount : kDeviceType;
}

bool SdoFence::isAnswer(const can::Frame& frame) const {
  const bool answer =
      sdo::commandOf(frame) == sdo::kUploadInitiated || frame.data[0] == sdo::kAbort;
  return answer && sdo::names(frame, object());
}

bool SdoFence::pass() {
  if (--reads_left_ > 0) return false;
  clear();
  return true;
}

}  // namespace cia402::canopen
