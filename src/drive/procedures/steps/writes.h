// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "drive/procedures/procedure.h"
#include "drive/profile/named_write.h"

namespace cia402::drive {

/// Writes objects beside the cycle one after the other, copying what has to be copied. An abort by
/// the drive fails, unless the write is optional. What `lacks` of the axis names is not written;
/// what only a default asks for is left out with a warning where the drive does not have it.
class WriteStep {
 public:
  explicit WriteStep(const std::vector<NamedWrite>& writes) : writes_(&writes) {}
  /// Which of the writes: those whose NamedWrite::from is the name, or the others.
  enum class Part { named, others };
  WriteStep(const std::vector<NamedWrite>& writes, std::string name, Part part)
      : writes_(&writes), name_(std::move(name)), part_(part) {}
  Outcome advance(const Context& context);
  /// What was written to objects that are outputs, too.
  struct Mapped {
    fieldbus::Slot slot;
    std::uint64_t raw;
  };
  const std::vector<Mapped>& mapped() const { return mapped_; }
  /// Something may have been written.
  bool wrote() const { return wrote_; }
  /// Was the write of what NamedWrite::from calls `from` left out?
  bool leftOut(const std::string& from) const;

 private:
  bool mayLeaveOut(const Context& context, const fieldbus::Transfer& answer);
  std::string advice(const Context& context) const;
  const NamedWrite& chosen(const Context& context) const;
  bool begin(const Context& context, Outcome& problem);
  bool mayBeReadBack(const Context& context, const fieldbus::Transfer& answer) const;
  std::string difference(const Context& context, const fieldbus::Transfer& answer) const;
  bool copy(const Context& context, fieldbus::Bytes bytes);
  void write(const Context& context, fieldbus::Bytes bytes);

  const std::vector<NamedWrite>* writes_;  ///< in the profile, which outlives every procedure
  std::string name_;                       ///< empty: all are written
  Part part_ = Part::others;
  std::size_t next_ = 0;
  ResolvedWrite current_;
  fieldbus::Ticket ticket_;
  fieldbus::Bytes written_;  ///< what is read back at the moment; else empty
  std::vector<Mapped> mapped_;
  bool wrote_ = false;
  std::vector<std::string> left_out_;  ///< NamedWrite::from
};

}  // namespace cia402::drive
