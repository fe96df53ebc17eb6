// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/bus/faults.h"

#include <algorithm>

namespace cia402::sim {

BusFaults::BusFaults(std::uint64_t seed) : generator_(seed) {}

void BusFaults::setRates(const FaultRates& rates) {
  rates_ = rates;
  active_ = !rules_.empty() || rates.loss > 0 || rates.duplicate > 0 || rates.corrupt > 0 ||
            rates.delay > 0;
}

void BusFaults::add(const FaultRule& rule) {
  rules_.push_back(rule);
  active_ = true;
}

void BusFaults::remove(const FaultRule& rule) {
  const auto place = std::find_if(rules_.begin(), rules_.end(), [&](const FaultRule& other) {
    return other.kind == rule.kind && other.id == rule.id && other.mask == rule.mask &&
           other.receiver == rule.receiver;
  });
  if (place != rules_.end()) rules_.erase(place);
}

void BusFaults::clear() {
  rules_.clear();
  setRates({});
}

double BusFaults::uniform() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

bool BusFaults::chance(double probability) { return probability > 0 && uniform() < probability; }

const FaultRule* BusFaults::use(FaultKind kind, const can::Frame& frame,
                                std::string_view receiver) {
  for (FaultRule& rule : rules_) {
    if (rule.count == 0 || rule.kind != kind || rule.receiver != receiver) continue;
    if (((rule.id ^ frame.id) & rule.mask) != 0) continue;
    --rule.count;
    return &rule;
  }
  return nullptr;
}

std::optional<Duration> BusFaults::delayOf(const can::Frame& frame) {
  if (const FaultRule* rule = use(FaultKind::delay, frame)) return rule->delay;
  if (!chance(rates_.delay)) return std::nullopt;
  const double share = uniform();
  return Duration(
      static_cast<std::int64_t>(share * static_cast<double>(rates_.longest_delay.count())));
}

bool BusFaults::corrupts(const can::Frame& frame) {
  return use(FaultKind::corrupt, frame) != nullptr || chance(rates_.corrupt);
}

bool BusFaults::duplicates(const can::Frame& frame) {
  return use(FaultKind::duplicate, frame) != nullptr || chance(rates_.duplicate);
}

bool BusFaults::losesForAll(const can::Frame& frame) {
  return use(FaultKind::lose, frame) != nullptr;
}

bool BusFaults::losesAt(std::string_view receiver, const can::Frame& frame) {
  return use(FaultKind::lose, frame, receiver) != nullptr || chance(rates_.loss);
}

}  // namespace cia402::sim
