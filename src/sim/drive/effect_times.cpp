// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/effect_times.h"

namespace cia402::sim {

void EffectTimes::writing(ObjectId id) {
  Entry* entry = effects_.count(id) == 0 ? nullptr : dictionary_.find(id);
  if (entry == nullptr) return;
  if (!entry->waits) entry->goes_by = entry->number;
  entry->waits = true;
  waits_ = true;
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

}  // namespace cia402::sim
