// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "cia402_driver/common/time.h"

namespace cia402::bus {

class AxisCycle;

/// The orderly end of all axes on a bus: motion is ramped down, the axes are disabled, the devices
/// are taken out of operation. Done after 1.8 s at the latest.
class Shutdown {
 public:
  bool begun() const { return stage_ != Stage::no; }
  bool done() const { return stage_ == Stage::done; }

  /// It is asked for: nothing new is to begin. @param started false: nothing may be sent
  void begin(bool started, Time now) {
    stage_ = started ? Stage::stopping : Stage::done;
    began_ = now;
  }
  /// Begins to bring the axes to rest.
  static void endMotion(AxisCycle& cycle, Time now);
  /// Once a cycle. @return true once the axes are disabled, or have had their time for it: the
  /// devices are to be released, then finish() is to be called.
  bool step(AxisCycle& cycle, Time now);
  void finish() { stage_ = Stage::done; }

 private:
  enum class Stage : std::uint8_t { no, stopping, disabling, done };

  Stage stage_ = Stage::no;
  Time began_{};
};

}  // namespace cia402::bus
