// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bus/reply.h"
#include "canopen/device_profile.h"
#include "cia402_driver/common/result.h"
#include "cia402_driver/common/time.h"
#include "drive/axis/config.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {

class AxisCycle;

/// What of a DCF is to be in a drive, and what came of it. Goes to the bus thread with the command
/// and is left alone there from its reply on: never used by two threads at a time.
struct DcfLoading {
  enum class Outcome : std::uint8_t {
    not_asked,
    same,     ///< the drive had it already
    differs,  ///< and nothing was written
    written,  ///< and read back
    refused,  ///< or not answered, or not shown afterwards: see `problem`
  };
  struct Item {
    fieldbus::ObjectId id;
    std::string name;
    fieldbus::Bytes data;     ///< as it is in the file
    bool moves_zero = false;  ///< the axis is not homed any more
    Outcome outcome = Outcome::not_asked;
    std::string problem;
  };
  std::string file;            ///< its name without folders
  std::vector<Item> identity;  ///< objects that must be the same, or it is another drive's
  std::vector<Item> items;     ///< in the order in which they are written
  std::vector<std::string> left_out;
};

/// Compares a drive with a DCF and, where that is confirmed, writes what differs and reads it back.
/// The axis is disabled and stands all the time. A drive of another identity is left alone.
struct LoadDcfCommand {
  using Answer = bus::Answer;
  std::string axis;
  std::shared_ptr<DcfLoading> loading;  ///< not nullptr
  bool confirm = false;

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

/// What a DCF (CiA 306) has for a drive: its ParameterValues that can be written, but for the
/// objects of communication, those that command something, and those that the driver or the bus
/// needs otherwise. An error where the text is no sound DCF or does not say whose it is.
/// @param file its name, for messages
Result<std::shared_ptr<DcfLoading>> planDcf(std::string_view text, const std::string& file,
                                            const drive::AxisConfig& axis,
                                            const canopen::DeviceProfile& device);

/// What came of it, once the command was answered with success.
Answer dcfOutcome(const DcfLoading& loading, const drive::AxisConfig& axis);

}  // namespace cia402::bus
