// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fieldbus/bytes.h"
#include "fieldbus/object.h"

namespace cia402::bus {

/// What is to be read of a drive for a DCF, and what came of it. Goes to the bus thread with the
/// command and is left alone there from its reply on: never used by two threads at a time.
struct DcfReading {
  enum class Outcome : std::uint8_t {
    not_asked,
    read,
    absent,   ///< guessed, and the drive does not have it
    refused,  ///< or not answered, see `problem`
  };
  struct Item {
    fieldbus::ObjectId id;
    std::string name;
    bool guessed = false;  ///< not known to be there: that it is not is no failure
    Outcome outcome = Outcome::not_asked;
    fieldbus::Bytes data;  ///< that was read
    std::string problem;
  };
  std::vector<Item> items;  ///< by rising index and sub-index
  double bitrate = 0.0;     ///< of the bus in bit/s
};

}  // namespace cia402::bus
