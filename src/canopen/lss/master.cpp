// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/master.h"

#include <algorithm>
#include <utility>

#include "canopen/boot/text.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

std::string bytesText(const can::Frame& frame) { return hexBytes(frame.data.data(), frame.size); }

constexpr std::size_t kMostAnswers = 256;  // a babbling device must not fill the memory

}  // namespace

void LssMaster::begin(LssRequest request, Time now) {
  request_ = std::move(request);
  problem_.clear();
  attempt_ = 0;
  send(now);
}

void LssMaster::send(Time now) {
  ++attempt_;
  answers_.clear();
  for (const can::Frame& frame : request_.frames) sink_.send(frame);
  const bool short_wait = !request_.confirmed || request_.question;
  deadline_ = now + (short_wait ? options_.window : options_.timeout);
}

void LssMaster::receive(const can::Frame& frame, Time now) {
  if (frame.id != lss::kAnswerId || frame.extended || frame.remote || frame.error) return;
  const bool expected = busy() && request_.confirmed && frame.size == 8 &&
                        frame.data[0] == static_cast<std::uint8_t>(request_.answer) &&
                        answers_.size() < kMostAnswers;
  if (!expected) {
    ++stray_answers_;
    return;
  }
  answers_.push_back(frame);
  // Another device that was asked the same would answer about now.
  if (!request_.question) deadline_ = std::min(deadline_, now + options_.window);
}

bool LssMaster::asItShould() const {
  if (!request_.confirmed || request_.question) return true;
  return request_.many ? !answers_.empty() : answers_.size() == 1;
}

std::string LssMaster::problemText() const {
  std::string times = attempt_ > 1 ? ", asked " + std::to_string(attempt_) + " times" : "";
  if (answers_.empty()) return "nobody answered within " + secondsText(options_.timeout) + times;
  std::string text = std::to_string(answers_.size()) + " answers came where one device was asked";
  const auto other =
      std::find_if(answers_.begin(), answers_.end(),
                   [this](const can::Frame& frame) { return frame != answers_.front(); });
  if (other != answers_.end()) {
    text += " (" + bytesText(answers_.front()) + " and " + bytesText(*other) + ")";
  }
  return text + times;
}

void LssMaster::tick(Time now) {
  if (!busy() || now < deadline_) return;
  if (asItShould()) {
    deadline_ = kNever;
    return;
  }
  if (attempt_ < attempts()) {
    send(now);
    return;
  }
  deadline_ = kNever;
  problem_ = problemText();
}

}  // namespace cia402::canopen
