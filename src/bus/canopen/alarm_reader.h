// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canopen/emcy/error_history.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// Reads the alarms that a drive keeps by objects of its maker (drive::AlarmMemory), the newest
/// first, one transfer at a time; the newest one is selected again afterwards.
class AlarmReader {
 public:
  /// @param axis must outlive it. @param most to read
  AlarmReader(drive::Axis& axis, unsigned most);
  /// Begins, looks whether an answer has come, asks for the next. @return true once history() is
  /// complete.
  bool step();
  const canopen::ErrorHistory& history() const { return history_; }

 private:
  enum class Stage : std::uint8_t { begin, selecting, code, time, closing };

  const drive::DriveProfile& profile() const { return *axis_->config().profile; }
  void select(unsigned number, Stage stage);
  void read(const std::string& object, Stage stage);
  bool take();
  bool next();

  drive::Axis* axis_;
  unsigned most_, number_ = 0;
  Stage stage_ = Stage::begin;
  fieldbus::Ticket ticket_;
  canopen::ErrorHistory history_;
};

}  // namespace cia402::bus
