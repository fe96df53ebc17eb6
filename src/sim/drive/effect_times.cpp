// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/effect_times.h"

#include <algorithm>

namespace cia402::sim {

EffectTimes::EffectTimes(const Effects& effects, ObjectDictionary& dictionary)
    : effects_(effects),
      dictionary_(dictionary),
      ignores_(std::any_of(effects.begin(), effects.end(),
                           [](const auto& pair) { return pair.second == Effect::never; })) {}

void EffectTimes::writing(ObjectId id) {
  const auto found = effects_.find(id);
  if (found == effects_.end() || found->second == Effect::never) return;
  Entry* entry = dictionary_.find(id);
  if (entry == nullptr) return;
  if (!entry->waits) entry->goes_by = entry->number;
  entry->waits = true;
  waits_ = true;
}

bool EffectTimes::look(bool powered) {
  const bool released = !powered && release(false);
  if (powered != deaf_) hear(!powered);
  return released;
}

void EffectTimes::powerOff() {
  release(true);
  hear(true);
}

bool EffectTimes::release(bool all) {
  if (!waits_) return false;
  bool released = false;
  waits_ = false;
  for (const auto& [id, effect] : effects_) {
    Entry* entry = dictionary_.find(id);
    if (entry == nullptr) continue;
    const bool counts = entry->waits && (all || effect == Effect::stop);
    if (counts) entry->waits = false;
    released = released || counts;
    waits_ = waits_ || entry->waits;
  }
  return released;
}

void EffectTimes::hear(bool any) {
  deaf_ = !any;
  for (const auto& [id, effect] : effects_) {
    Entry* entry = effect == Effect::never ? dictionary_.find(id) : nullptr;
    if (entry != nullptr) entry->deaf = deaf_;
  }
}

}  // namespace cia402::sim
