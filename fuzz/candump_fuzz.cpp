// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <sstream>
#include <string>

#include "can/candump_log.h"
#include "input.h"

// The reader of candump logs on any bytes. What it takes for an entry must read back equal, but for
// the nanoseconds that candump does not write.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cia402;
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::istringstream stream(text);
  can::LogReader reader(stream);
  while (const auto entry = reader.next()) {
    if (!*entry) {
      fuzz::require(!entry->error().message.empty(), "a wrong line is told");
      continue;
    }
    const can::LogEntry& first = **entry;
    fuzz::require(first.frame.size <= 8, "a frame has at most 8 bytes");
    fuzz::require(first.stamp.count() >= 0, "a stamp is not before 1970");
    const auto again = can::parseLogLine(can::formatLogLine(first));
    fuzz::require(again.ok(), "what was read can be written and read");
    fuzz::require(again->frame == first.frame && again->interface == first.interface &&
                      again->direction == first.direction,
                  "it reads back equal");
    fuzz::require(
        first.stamp - again->stamp < std::chrono::microseconds(1) && first.stamp >= again->stamp,
        "the stamp reads back equal to the microsecond");
  }
  return 0;
}
