// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "bus/canopen/dcf_command.h"
#include "bus/jobs/job.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// Reads the objects that a DCF is to hold, see DcfDraft. One SDO transfer at a time, so that
/// others get their turn; nothing is written to the drive.
class DcfJob final : public Job {
 public:
  /// @param axis must outlive the job. @param bitrate of the bus in bit/s, for the file.
  DcfJob(drive::Axis& axis, const SaveDcfCommand& command, double bitrate, Reply<> reply);

  bool step(Time now) override;
  void abandon(const std::string& why) override;

 private:
  void take(const fieldbus::Transfer& transfer);
  bool askNext();
  bool finish(const Answer& answer);
  bool fail(const std::string& why);

  drive::Axis* axis_;
  Reply<> reply_;
  std::shared_ptr<DcfReading> reading_;
  std::size_t next_ = 0;  ///< item to be asked for; the one before it has been
  fieldbus::Ticket ticket_;
  unsigned silent_ = 0;  ///< transfers in a row without an answer
};

}  // namespace cia402::bus
