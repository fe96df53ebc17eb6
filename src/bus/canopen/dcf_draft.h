// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/canopen/dcf_command.h"
#include "canopen/device_config.h"
#include "canopen/eds/eds.h"
#include "drive/axis/config.h"

namespace cia402::bus {

/// A file and what is to be said of it.
struct DcfAnswer : Answer {
  std::string text;  ///< the file
};

/// What a DCF says of itself: the date ("11-21-2026") and time ("03:40PM") as CiA 306 writes them.
struct DcfStamp {
  std::string file_name, date, time;
};

/// A DCF (CiA 306) of all that a drive holds: the readable objects of its EDS, or, without one,
/// those that the profile names and the communication objects of CiA 301. The bus thread only reads
/// the objects; planning and wording, which take tens of milliseconds, belong to the thread that
/// wants the file.
///
///     DcfDraft draft(config, stamp);
///     const Answer read = call(runner, draft.command());
///     if (read.success) write(draft.finish().text);
class DcfDraft {
 public:
  /// @param others that sit in the device, too
  DcfDraft(const drive::AxisConfig& axis, const canopen::DeviceConfig& device,
           const DcfStamp& stamp, const std::vector<const drive::AxisConfig*>& others = {});

  /// Has the objects read; to be given once.
  SaveDcfCommand command() const { return {axis_, reading_}; }
  /// Once the command was answered with success. @return with the file as its text; its message
  /// tells how many objects were read and what could not be.
  DcfAnswer finish();

 private:
  void plan();
  void addProfileObjects(const drive::DriveProfile& profile);
  void addCommunicationObjects();
  /// @param first how many there are before its first one
  void addPdoObjects(const canopen::DeviceProfile& profile, unsigned first);
  void addRecord(std::uint16_t index, const char* name,
                 const std::vector<fieldbus::DataType>& types,
                 const std::vector<const char*>& names, fieldbus::Access count,
                 fieldbus::Access others);
  void take(const DcfReading::Item& item);
  void store(const DcfReading::Item& item);
  void setIdentity();

  std::string axis_, who_;
  bool has_eds_;
  canopen::EdsInfo info_;
  fieldbus::ObjectDictionary dictionary_;
  std::shared_ptr<DcfReading> reading_ = std::make_shared<DcfReading>();
  std::size_t read_ = 0, unwritable_ = 0;
  std::vector<std::string> unread_;
};

}  // namespace cia402::bus
