// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "bus/jobs/job.h"
#include "bus/reply.h"
#include "canopen/device_profile.h"
#include "cia402_driver/common/result.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

class Network;

/// Gives a drive without LSS another node-ID or bit rate, by the objects of its maker. The
/// node-ID of the master, or of another axis whose drive was heard, is refused: two would follow
/// the same frames.
struct SetBusParametersCommand {
  using Answer = bus::Answer;
  std::string axis;
  unsigned node_id = 0;   ///< 1 to 127; 0: it keeps it
  unsigned bit_rate = 0;  ///< bit/s; 0: it keeps it
  bool confirm = false;   ///< else nothing is written, and the answer says what would be

  void begin(Network& network, const Reply<>& reply, Time now) const;
};

/// What is to be written.
struct BusSettingChange {
  const canopen::BusSettings* settings = nullptr;  ///< of the device
  const canopen::BusSetting* setting = nullptr;    ///< of these
  const drive::ObjectSpec* object = nullptr;
  std::int64_t number = 0;  ///< the drive's own
  std::string what, value;  ///< "node-ID", "5"
  std::string file;         ///< what is to be changed in the robot's file
};
/// What the command asks for; or why that cannot be.
Result<BusSettingChange> busSettingChange(const drive::Axis& axis,
                                          const canopen::DeviceProfile& device,
                                          const SetBusParametersCommand& command);

/// Reads what the drive has, writes the new number where that is confirmed, and reads it back where
/// it does not count at once. The axis is disabled and stands all the time.
class BusSettingJob final : public Job {
 public:
  /// @param axis must outlive it.
  BusSettingJob(drive::Axis& axis, const BusSettingChange& change, bool confirmed, Reply<> reply);

  bool step(Time now) override;
  void abandon(const std::string& why) override { (void)fail(why); }

 private:
  enum class Stage : std::uint8_t { reading, opening, writing, closing, comparing };

  void read(Stage stage);
  void write(const drive::ObjectSpec& object, std::int64_t number, Stage stage);
  bool takeOld();
  bool takeWritten();
  bool fail(const std::string& why);
  bool finish();
  std::string numberText(std::int64_t number) const;
  std::string consequence() const;

  drive::Axis* axis_;
  BusSettingChange change_;
  bool confirmed_;
  Stage stage_ = Stage::reading;
  std::int64_t old_ = 0;
  bool doubtful_ = false;  ///< it was written, and no answer came
  std::string problem_;    ///< the write was refused; what was opened for it is closed first
  fieldbus::Ticket ticket_;
  Reply<> reply_;
};

}  // namespace cia402::bus
