// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/definition/effect.h"
#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

/// Lets what is written into some objects count later (Entry::waits) or never (Entry::deaf).
class EffectTimes {
 public:
  /// Both must outlive it.
  EffectTimes(const Effects& effects, ObjectDictionary& dictionary);

  /// A write to the object is about to be taken.
  void writing(ObjectId id);
  /// look() may have something to do.
  bool watches() const { return waits_ || ignores_; }
  /// @param powered a motor of the drive has power. @return numbers count from now on that did not
  bool look(bool powered);
  void powerOff();

 private:
  bool release(bool all);
  void hear(bool any);

  const Effects& effects_;
  ObjectDictionary& dictionary_;
  const bool ignores_;  ///< there is Effect::never among them
  bool waits_ = false;  ///< something that was written does not count yet
  bool deaf_ = false;   ///< to the objects of Effect::never
};

}  // namespace cia402::sim
