// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/notices.h"

#include <algorithm>
#include <utility>

namespace cia402::drive {

void Notices::add(std::string text, NoticeKind kind) {
  ++count_;
  kept_[count_ % kKept] = {std::move(text), kind};
}

void Notices::notify(std::string text) { add(std::move(text), NoticeKind::error); }

bool Notices::isNew(const std::string& text) {
  if (std::find(once_.begin(), once_.end(), text) != once_.end()) return false;
  once_.push_back(text);
  return true;
}

void Notices::warnOnce(std::string text) {
  if (isNew(text)) warn(std::move(text));
}

void Notices::informOnce(std::string text) {
  if (isNew(text)) add(std::move(text), NoticeKind::information);
}

void Notices::warn(std::string text) { add(std::move(text), NoticeKind::warning); }

void Notices::fail(std::string text, bool tell) {
  failure_ = std::move(text);
  if (tell) notify(failure_);
}

std::string Notices::takeFailure() { return std::exchange(failure_, std::string()); }

}  // namespace cia402::drive
