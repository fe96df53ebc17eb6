// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cia402_driver/drive/named_write.h"
#include "procedure.h"

namespace cia402::drive {

/// Writes objects by SDO one after the other, copying what has to be copied. An abort by the drive
/// fails, unless the write is optional.
class WriteStep {
 public:
  explicit WriteStep(const std::vector<NamedWrite>& writes) : writes_(&writes) {}
  Outcome advance(const Context& context);
  /// What was written to objects that an RPDO carries, too.
  struct Mapped {
    canopen::Slot slot;
    std::uint64_t raw;
  };
  const std::vector<Mapped>& mapped() const { return mapped_; }

 private:
  bool begin(const Context& context, Outcome& problem);
  bool copy(const Context& context, canopen::Bytes bytes);
  void write(const Context& context, canopen::Bytes bytes);

  const std::vector<NamedWrite>* writes_;  ///< in the profile, which outlives every procedure
  std::size_t next_ = 0;
  ResolvedWrite current_;
  canopen::SdoTicket ticket_;
  std::vector<Mapped> mapped_;
};

}  // namespace cia402::drive
