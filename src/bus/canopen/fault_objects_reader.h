// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "canopen/emcy/error_history.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// Reads the past faults that a drive keeps each in objects of its own (drive::FaultObjects), the
/// newest first, one transfer at a time.
class FaultObjectsReader {
 public:
  /// @param axis must outlive it. @param most to read
  FaultObjectsReader(drive::Axis& axis, unsigned most);
  /// Begins, looks whether an answer has come, asks for the next. @return true once history() is
  /// complete.
  bool step();
  const canopen::ErrorHistory& history() const { return history_; }

 private:
  const drive::FaultObjects& memory() const { return axis_->config().profile->fault_memory; }
  /// Of the fault that is read now, behind its code.
  const std::string& object() const;
  void read(const std::string& name);
  bool take();
  bool next();

  drive::Axis* axis_;
  std::size_t most_, fault_ = 0;
  std::size_t part_ = 0;  ///< 0: its code, n: the object n - 1 that was kept with it
  fieldbus::Ticket ticket_;
  canopen::ErrorHistory history_;
};

}  // namespace cia402::bus
