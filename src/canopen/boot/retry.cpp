// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/boot/retry.h"

#include <algorithm>

#include "canopen/boot/text.h"
#include "common/text.h"

namespace cia402::canopen {

void BootRetry::reset() {
  attempt_ = 1;
  searches_ = 0;
  searching_ = given_up_ = false;
  due_ = kNever;
}

void BootRetry::failed(BootFailure failure, Time now) {
  searching_ = given_up_ = false;
  due_ = kNever;
  if (failure != BootFailure::timed_out) return;
  given_up_ = attempt_ > policy_.retries;
  if (given_up_) return;
  ++attempt_;
  due_ = now + policy_.retry_delay;
}

void BootRetry::search(Time now, Time earliest) {
  reset();
  if (policy_.search_period <= Duration::zero()) return;
  searching_ = true;
  period_ = policy_.search_period;
  due_ = std::max(now + period_, earliest);
}

void BootRetry::look(Time at) {
  searching_ = true;
  period_ = policy_.search_period;
  due_ = at;
}

void BootRetry::notFound(Time now) {
  if (!searching_) return;
  searching_ = policy_.search_period > Duration::zero();
  if (!searching_) return;
  period_ = std::min(2 * period_, std::max(policy_.search_period, policy_.search_period_max));
  due_ = now + period_;
}

void BootRetry::begun() {
  due_ = kNever;
  if (searching_) ++searches_;
}

std::string BootRetry::outlook() const {
  const std::string attempts = std::to_string(policy_.retries + 1);
  if (given_up_ && policy_.retries > 0) return "; given up after " + attempts + " attempts";
  if (searching_ || due_ == kNever) return {};
  return "; it is tried again in " + secondsText(policy_.retry_delay) + " (attempt " +
         std::to_string(attempt_) + " of " + attempts + ")";
}

std::string BootRetry::attemptText() const {
  if (attempt_ == 1) return {};
  return "attempt " + std::to_string(attempt_) + " of " + std::to_string(policy_.retries + 1) +
         ": ";
}

std::string BootRetry::searchText() const {
  if (!searching_) return {};
  return "looked for " + std::to_string(searches_) + " times, again every " + secondsText(period_);
}

}  // namespace cia402::canopen
