// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "can/frame.h"
#include "cia402_driver/common/result.h"

namespace cia402::can {

/// Which way a logged frame went, where the log says so.
enum class Direction { unknown, received, transmitted };

/// One frame of a log in the format of `candump -L`.
struct LogEntry {
  std::chrono::nanoseconds stamp{};  ///< since 1970 (UTC), as logged; not the time of BusClock
  std::string interface;             ///< e.g. "can0"; no blanks
  Frame frame;
  Direction direction = Direction::unknown;
};

/// `(1700000000.123456) can0 123#DEADBEEF`, without the end of line: 3 digits for an 11-bit, 8 for
/// a 29-bit identifier, `#R` and the length for a remote frame, 8 digits with 0x20000000 for an
/// error frame, then ` R` or ` T` if the direction is known. Microseconds, cut, as candump writes
/// them.
std::string formatLogLine(const LogEntry& entry);

/// Reads one line. A carriage return at the end, several blanks, 1 to 9 decimals, a missing
/// fraction, dots between the data bytes and a `_D` length suffix are accepted. CAN FD frames
/// (`##`) are not.
/// @return the entry, or what is wrong with the line and where.
Result<LogEntry> parseLogLine(std::string_view line);

/// Writes entries to a stream, one a line.
class LogWriter {
 public:
  explicit LogWriter(std::ostream& out) : out_(out) {}
  /// @return false if the stream has failed (disk full).
  bool write(const LogEntry& entry);

 private:
  std::ostream& out_;
};

/// Reads a log line by line; blank lines and those that start with '#' are skipped.
class LogReader {
 public:
  explicit LogReader(std::istream& in) : in_(in) {}
  /// The next entry; an Error ("line 7: ...") for a line that is none, after which reading goes on;
  /// nothing at the end.
  std::optional<Result<LogEntry>> next();
  /// Number of the line read last, from 1.
  std::size_t line() const { return line_; }

 private:
  std::istream& in_;
  std::size_t line_ = 0;
};

}  // namespace cia402::can
