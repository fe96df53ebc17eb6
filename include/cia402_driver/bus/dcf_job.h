// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "cia402_driver/bus/command.h"
#include "cia402_driver/canopen/eds.h"
#include "cia402_driver/drive/axis.h"

namespace cia402::bus {

/// Reads everything that a drive holds now and words it as a DCF (CiA 306): the readable objects of
/// its EDS, or, without one, those that the profile names and the communication objects of CiA 301.
/// One SDO transfer at a time, so that others get their turn; nothing is written to the drive.
class DcfJob {
 public:
  /// @param axis must outlive the job. @param bitrate of the bus in bit/s, for the file.
  DcfJob(drive::Axis& axis, const SaveDcfCommand& command, double bitrate, Reply reply);

  /// @return true once the reply was given: its text is the file, its message tells how many
  /// objects were read and what could not be.
  bool step();
  /// Gives a failed reply; for the end of the program.
  void abandon(const std::string& why);

 private:
  struct Item {
    canopen::ObjectId id;
    std::string name;
    bool guessed = false;  ///< not known to be there: that it is not is no failure
  };

  void plan(const drive::AxisConfig& config);
  void addProfileObjects(const drive::DriveProfile& profile);
  void addCommunicationObjects(const drive::DriveProfile& profile);
  void addRecord(std::uint16_t index, const char* name, const std::vector<canopen::DataType>& types,
                 const std::vector<const char*>& names, canopen::Access count,
                 canopen::Access others);
  void setIdentity();
  void take(const canopen::SdoTransfer& transfer);
  void store(const canopen::Bytes& data);
  bool askNext();
  bool finish();
  bool fail(const std::string& why);

  drive::Axis* axis_;
  std::string who_;
  Reply reply_;
  canopen::EdsInfo info_;
  canopen::ObjectDictionary dictionary_;
  std::deque<Item> items_;
  Item item_;
  canopen::SdoTicket ticket_;
  std::size_t read_ = 0, unwritable_ = 0;
  std::vector<std::string> unread_;
  unsigned silent_ = 0;  ///< transfers in a row without an answer
};

}  // namespace cia402::bus
