// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "bus/canopen/dcf_load.h"
#include "bus/jobs/job.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// Brings a drive to what a DCF says, object by object: reads it, writes it where it differs, and
/// reads it back. Meanwhile the axis takes no procedure but those that stop.
class DcfLoadJob final : public Job {
 public:
  /// @param axis must outlive the job.
  DcfLoadJob(drive::Axis& axis, const LoadDcfCommand& command, Reply<> reply);

  bool step(Time now) override;
  void abandon(const std::string& why) override { (void)fail(why); }

 private:
  enum class Stage : std::uint8_t { identifying, reading, writing, comparing, settling };

  bool identify();
  bool compare(Time now);
  bool write(const DcfLoading::Item& item);
  bool takeWritten(Time now);
  bool takeReadBack(Time now);
  /// The next object, or the end.
  bool next(Time now);
  bool ask(const DcfLoading::Item& item, Stage stage);
  void note(DcfLoading::Outcome outcome, std::string problem = {});
  /// The drive seems to be gone.
  bool silent();
  bool finish(const Answer& answer);
  bool fail(const std::string& why);

  drive::Axis* axis_;
  std::shared_ptr<DcfLoading> loading_;
  bool confirmed_;
  Reply<> reply_;
  Stage stage_ = Stage::identifying;
  std::size_t at_ = 0;
  unsigned silent_ = 0;  ///< transfers in a row without an answer
  std::size_t written_ = 0;
  bool moved_ = false;  ///< something was written that may have moved the zero
  Time since_{};        ///< of the stage `settling`
  fieldbus::Ticket ticket_;
};

}  // namespace cia402::bus
