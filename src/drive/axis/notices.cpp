// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/notices.h"

#include <algorithm>
#include <utility>

namespace cia402::drive {

void Notices::notify(std::string text) {
  text_ = std::move(text);
  warns_ = false;
  ++count_;
}

void Notices::warnOnce(std::string text) {
  if (std::find(warned_.begin(), warned_.end(), text) != warned_.end()) return;
  warned_.push_back(text);
  warn(std::move(text));
}

void Notices::warn(std::string text) {
  notify(std::move(text));
  warns_ = true;
}

void Notices::fail(std::string text, bool tell) {
  failure_ = std::move(text);
  if (tell) notify(failure_);
}

std::string Notices::takeFailure() { return std::exchange(failure_, std::string()); }

}  // namespace cia402::drive
