// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/jobs/job.h"
#include "bus/jobs/object_commands.h"
#include "cia402_driver/common/result.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// One read_object or write_object: the SDO transfers it needs and the wording of its answer.
/// Numbers are in device units; the answer shows the joint's units beside them where the profile
/// knows the quantity.
class ObjectJob final : public Job {
 public:
  /// Begins to read. An error where findObject() does not know `object`.
  /// @param axis must outlive the job.
  static Result<std::unique_ptr<Job>> read(drive::Axis& axis, const std::string& object,
                                           Reply<ObjectAnswer> reply);
  /// Begins to write `value`: a number ("-5", "0x80000181", "1.5") or text, by the object's type.
  /// The size of an object that the profile does not list is asked of the drive first. One that
  /// shifts coordinates or holds calibration (drive::CoordinateMark) is refused unless the axis is
  /// disabled and stands; nothing can enable the axis until it has told its position anew.
  static Result<std::unique_ptr<Job>> write(drive::Axis& axis, const std::string& object,
                                            const std::string& value, Reply<ObjectAnswer> reply);

  bool step(Time now) override;
  void abandon(const std::string& why) override { finish(false, who_ + ": " + why); }

 private:
  enum class Stage : std::uint8_t {
    reading,
    asking_size,
    writing,
    reading_back,
    settling,
    measuring
  };

  ObjectJob(drive::Axis& axis, Reply<ObjectAnswer> reply);
  /// @return why it cannot be accessed; empty if it can.
  std::string find(const std::string& object);
  /// @return why it cannot be written, as a sentence; empty once the first transfer has begun.
  std::string beginWrite(const std::string& value);
  std::string notWritten(const std::string& why) const;
  bool finish(bool success, std::string message);
  bool finishRead();
  bool joinHalves();
  bool writeWithAskedSize();
  void download(const fieldbus::Bytes& data);
  Result<std::string> countedValue() const;
  std::string printedText(double number) const;
  void lock();
  /// Why an object with a mark cannot be written now; empty: it can.
  std::string strangerRefusal() const;
  std::string calibrationRefusal() const;
  std::string powerRefusal() const;
  /// It is of the device, and so of all axes in it.
  bool ofDevice() const { return !drive::axisOf(id_); }
  bool finishWrite(Time now);
  bool readsBack() const;
  bool compare();
  bool measure(Time now);
  std::string writtenText() const;
  std::string unhomedText(bool measured) const;
  bool finishOrReadBack(std::string written, const std::string& consequence);
  /// By what was read of it, if nothing names it.
  std::optional<drive::ObjectSpec> unnamedObject() const;

  drive::Axis* axis_;
  std::optional<drive::ObjectSpec> spec_;  ///< nothing names it where there is none
  std::string who_, name_, value_;
  std::string units_;  ///< of what is written: " (0.1 rad)", or nothing
  fieldbus::ObjectId id_;
  Stage stage_ = Stage::reading;
  drive::CoordinateMark mark_ = drive::CoordinateMark::none;  ///< of what is written
  bool locked_ = false;                                       ///< Axis::beginCalibration()
  fieldbus::Bytes written_;
  std::string said_, consequence_;     ///< where what was written is the same when it is read back
  std::vector<std::uint64_t> halves_;  ///< of a number in two objects: lower, upper, lower again
  fieldbus::Bytes joined_;             ///< the number
  Time since_{};                       ///< of the stage
  fieldbus::Ticket ticket_;
  Reply<ObjectAnswer> reply_;
};

}  // namespace cia402::bus
