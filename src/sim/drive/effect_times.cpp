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

void EffectTimes::look(bool powered) {
  if (!powered) release(false);
  if (powered != deaf_) hear(!powered);
}

void EffectTimes::powerOff() {
  release(true);
  hear(true);
}

void EffectTimes::release(bool all) {
  if (!waits_) return;
  waits_ = false;
  for (const auto& [id, effect] : effects_) {
    Entry* entry = dictionary_.find(id);
    if (entry == nullptr) continue;
    if (all || effect == Effect::stop) entry->waits = false;
    waits_ = waits_ || entry->waits;
  }
}

void EffectTimes::hear(bool any) {
  deaf_ = !any;
  for (const auto& [id, effect] : effects_) {
    Entry* entry = effect == Effect::never ? dictionary_.find(id) : nullptr;
    if (entry != nullptr) entry->deaf = deaf_;
  }
}

}  // namespace cia402::sim
