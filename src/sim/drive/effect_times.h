// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/effect.h"
#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

/// Lets what is written into some objects count later (Entry::waits).
class EffectTimes {
 public:
  /// Both must outlive it.
  EffectTimes(const Effects& effects, ObjectDictionary& dictionary)
      : effects_(effects), dictionary_(dictionary) {}

  /// A write to the object is about to be taken.
  void writing(ObjectId id);
  /// No motor has power.
  void stopped() { release(false); }
  void powerOff() { release(true); }
  /// Something that was written does not count yet.
  bool waits() const { return waits_; }

 private:
  void release(bool all);

  const Effects& effects_;
  ObjectDictionary& dictionary_;
  bool waits_ = false;
};

}  // namespace cia402::sim
