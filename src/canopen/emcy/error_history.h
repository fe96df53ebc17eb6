// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fieldbus/object_access.h"

namespace cia402::canopen {

/// One entry of the pre-defined error field 1003h (CiA 301, 7.5.2.4).
struct ErrorHistoryEntry {
  std::uint16_t code = 0;      ///< low word: emergency error code
  std::uint16_t info = 0;      ///< high word: additional information of the manufacturer
  std::optional<double> time;  ///< s since power-on, where the drive tells it
  std::string with;            ///< what the drive has kept with it, in words
};

/// What a drive remembers of its errors.
struct ErrorHistory {
  bool readable = false;                   ///< 1003:00 was read
  unsigned recorded = 0;                   ///< number of errors that the drive says it holds
  std::vector<ErrorHistoryEntry> entries;  ///< newest first; at most as many as were asked for
  /// What is odd or missing, e.g. "the drive keeps no error history: 1003:00 does not exist";
  /// empty if nothing is.
  std::string remark;
};

/// Reads 1003h step by step over SDO: the number of entries, then the entries, one transfer at a
/// time. Sans-IO: whoever owns the client moves time on.
class ErrorHistoryReader {
 public:
  static constexpr unsigned kAll = 254;  ///< more sub-indices there are not

  /// @param most entries to read, the newest ones; 1 to kAll.
  explicit ErrorHistoryReader(unsigned most = kAll) : most_(most) {}

  /// Begins, looks whether an answer has come, asks for the next. @param sdo the client of the
  /// node, always the same. @return true once history() is complete.
  bool step(fieldbus::ObjectAccess& objects);
  const ErrorHistory& history() const { return history_; }

 private:
  bool takeCount(fieldbus::ObjectAccess& objects);
  bool takeEntry(fieldbus::ObjectAccess& objects);
  void ask(fieldbus::ObjectAccess& objects, unsigned sub_index);
  bool end(std::string remark);

  unsigned most_;
  unsigned sub_index_ = 0;  // asked for at the moment
  fieldbus::Ticket ticket_;
  ErrorHistory history_;
};

}  // namespace cia402::canopen
