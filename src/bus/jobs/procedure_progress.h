// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bus/reply.h"

namespace cia402::bus {

/// How far a procedure is on one of the axes that it was asked for.
enum class ProcedureStage : std::uint8_t {
  waiting,  ///< for its turn
  running,
  succeeded,
  failed,     ///< or not begun at all
  restoring,  ///< is brought back to what it was, as another axis has failed
};

/// The stages of all axes in one job: written in the thread of the bus, read in any.
class ProcedureProgress {
 public:
  explicit ProcedureProgress(std::size_t axes) : stages_(axes) {}

  /// @param axis index in the configuration
  void set(std::size_t axis, ProcedureStage stage) {
    stages_[axis].store(stage, std::memory_order_relaxed);
  }
  ProcedureStage of(std::size_t axis) const {
    return stages_[axis].load(std::memory_order_relaxed);
  }

 private:
  std::vector<std::atomic<ProcedureStage>> stages_;
};

/// What a procedure on one or several axes came to.
struct ProcedureReport : Answer {
  struct Axis {
    std::size_t number = 0;  ///< its index in the configuration
    bool homed = false;      ///< its zero is known, whoever found it
    std::string message;     ///< what became of it
  };
  bool stopped = false;    ///< no success, as it was cancelled or an axis stopped, for nothing else
  std::vector<Axis> axes;  ///< on which it was to be done; empty where it was refused as a whole
};

}  // namespace cia402::bus
