// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/bus/command.h"
#include "cia402_driver/drive/axis.h"

namespace cia402::bus {

/// A procedure on one or several axes, in the order that was asked for: axes of equal order run
/// together; an order begins when the one before has succeeded on every axis. set_mode on several
/// axes is done on all or none. The answer says what is true of all axes when it is given.
class ProcedureJob {
 public:
  struct Item {
    std::size_t axis = 0;
    int order = 0;
  };

  /// @param items not empty; any order.
  ProcedureJob(drive::ProcedureRequest request, std::vector<Item> items, Reply reply);

  /// Said at the end of the answer.
  void remark(std::string text) { remark_ = std::move(text); }
  /// Nothing is started before release().
  void hold() { held_ = true; }
  void release() { held_ = false; }
  bool held() const { return held_; }
  /// Somebody wants the axis to stop: what has not begun on it does not begin any more.
  void withdraw(std::size_t axis, drive::ProcedureKind by, const std::vector<drive::Axis>& axes);
  /// The same on all axes, for the reason `why`, if the procedure would enable them.
  void withdrawEnabling(const std::string& why, const std::vector<drive::Axis>& axes);
  /// Starts what is due and watches what runs. @return true once the reply was given.
  bool step(std::vector<drive::Axis>& axes, Time now);
  /// Gives a failed reply; for the end of the program.
  void abandon(const std::string& why);

 private:
  enum class Stage : std::uint8_t { waiting, running, succeeded, failed, restoring };
  struct Entry {
    Item item;
    Stage stage = Stage::waiting;
    bool remark = false;   ///< its success has a message that is told
    std::uint32_t id = 0;  ///< of the procedure; while waiting: of the axis' last one
    bool seen = false;     ///< id is known while waiting
    std::string message;
    std::string mode;  ///< before set_mode
  };

  void startDue(std::vector<drive::Axis>& axes, Time now);
  void watch(std::vector<drive::Axis>& axes);
  bool ended() const;
  bool allOrNone() const;
  void refuseUnlessAll(const std::vector<drive::Axis>& axes);
  void restoreModes(std::vector<drive::Axis>& axes, Time now);
  bool awaitsNews(const std::vector<drive::Axis>& axes, Time now) const;
  void judge(const std::vector<drive::Axis>& axes);
  static void watchWaiting(Entry& entry, const drive::Axis& axis);
  static void refuseToBegin(Entry& entry, const drive::Axis& axis, const std::string& why);
  void skipRest(const std::vector<drive::Axis>& axes);
  Answer answer(const std::vector<drive::Axis>& axes) const;

  drive::ProcedureRequest request_;
  std::vector<Entry> entries_;
  Reply reply_;
  std::string remark_;
  bool held_ = false;
};

/// One read_object or write_object: the SDO transfers it needs and the wording of its answer.
/// Numbers are in device units; the answer shows the joint's units beside them where the profile
/// knows the quantity.
class ObjectJob {
 public:
  /// Begins to read. An error where findObject() does not know `object`.
  /// @param axis must outlive the job.
  static Result<ObjectJob> read(drive::Axis& axis, const std::string& object, Reply reply);
  /// Begins to write `value`: a number ("-5", "0x80000181", "1.5") or text, by the object's type.
  /// The size of an object that the profile does not list is asked of the drive first. One that
  /// shifts coordinates or holds calibration (drive::CoordinateMark) is refused unless the axis is
  /// disabled and stands; nothing can enable the axis until it has told its position anew.
  static Result<ObjectJob> write(drive::Axis& axis, const std::string& object,
                                 const std::string& value, Reply reply);

  /// @return true once the reply was given.
  bool step(Time now);
  /// Gives a failed reply; for the end of the program.
  void abandon(const std::string& why) { finish(false, who_ + ": " + why); }

 private:
  enum class Stage : std::uint8_t { reading, asking_size, writing, settling, measuring };

  static Result<ObjectJob> find(drive::Axis& axis, const std::string& object, Reply reply);
  bool finish(bool success, std::string message);
  bool finishRead();
  bool writeWithAskedSize();
  void download(const fieldbus::Bytes& data);
  void lock();
  /// Why an object with a mark cannot be written now; empty: it can.
  std::string calibrationRefusal() const;
  bool finishWrite(Time now);
  bool measure(Time now);
  /// By what was read of it, if nothing names it.
  std::optional<drive::ObjectSpec> unnamedObject() const;

  drive::Axis* axis_ = nullptr;
  std::optional<drive::ObjectSpec> spec_;  ///< nothing names it where there is none
  std::string who_, name_, value_;
  std::string units_;  ///< of what is written: " (0.1 rad)", or nothing
  fieldbus::ObjectId id_;
  Stage stage_ = Stage::reading;
  drive::CoordinateMark mark_ = drive::CoordinateMark::none;  ///< of what is written
  bool locked_ = false;                                       ///< Axis::beginCalibration()
  Time since_{};                                              ///< of the stage
  canopen::SdoTicket ticket_;
  Reply reply_;
};

}  // namespace cia402::bus
