// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/jobs/job.h"
#include "bus/jobs/job_list.h"
#include "bus/jobs/procedure_progress.h"
#include "bus/reply.h"

namespace cia402::bus {

/// A procedure on one or several axes, in the order that was asked for: axes of equal order run
/// together; an order begins when the one before has succeeded on every axis. set_mode on several
/// axes, and enable on those of a group, is done on all or none. The answer says what is true of
/// all axes when it is given. No axis is in two that home.
class ProcedureJob final : public Job {
 public:
  struct Item {
    drive::Axis* axis = nullptr;  ///< outlives the job
    int order = 0;
    std::size_t number = 0;  ///< of the axis, its index in the configuration
  };

  struct Manner {
    bool held = false;                              ///< nothing is begun before release()
    bool together = false;                          ///< the axes are a group
    std::uint64_t id = 0;                           ///< for cancel(); 0: nobody cancels it
    std::shared_ptr<ProcedureProgress> progress{};  ///< where it is shown; may be empty
  };

  /// @param items not empty; any order. @param remark said at the end of the answer.
  ProcedureJob(drive::ProcedureRequest request, std::vector<Item> items, std::string remark,
               Manner manner, Reply<ProcedureReport> reply);

  /// "; wrist is optional and not there, it was left out"
  static std::string leftOut(const drive::Axis& axis);
  /// Why `home` must not begin on these axes, as one is being homed, or waits for its turn; empty:
  /// none is.
  static std::string homingRefusal(const JobList& jobs, const std::vector<Item>& items);

  bool step(Time now) override;
  void abandon(const std::string& why) override;
  void withdraw(const drive::Axis& axis, drive::ProcedureKind by) override;
  void withdrawEnabling(const std::string& why) override;
  void cancel(std::uint64_t id, Time now) override;
  bool homes(const drive::Axis& axis) const override;
  bool held() const override { return manner_.held; }
  void release() override { manner_.held = false; }

 private:
  using Stage = ProcedureStage;
  struct Entry {
    drive::Axis* axis = nullptr;
    std::size_t number = 0;
    int order = 0;
    Stage stage = Stage::waiting;
    bool remark = false;   ///< its success has a message that is told
    std::uint32_t id = 0;  ///< of the procedure; while waiting: of the axis' last one
    bool seen = false;     ///< id is known while waiting
    std::string message;
    std::string mode;            ///< before set_mode
    bool was_on = false;         ///< before it was begun
    bool ready = false;          ///< its device was, when the job was made,
    std::uint32_t boot_ups = 0;  ///< and had booted so often
    bool unwanted = false;       ///< if it has failed, then as somebody wanted it to end
    bool may_move = false;       ///< since it was begun; of those that have failed until they stand

    bool ended() const { return stage == Stage::succeeded || stage == Stage::failed; }
    void fail(std::string why);
    /// It is not begun at all, for the reason `why`.
    void refuse(const std::string& why);
    /// The same, for somebody has called what stops it.
    void withdraw(const std::string& by);
    void watchWaiting();
    /// It has failed: looks whether its motor stands, or whatever else moves it by now.
    void watchFailed();
  };

  /// @return true: it has ended
  bool advance(Time now);
  void startDue(Time now);
  void watch();
  void watchRunning(Entry& entry) const;
  bool ended() const;
  bool all(Stage stage) const;
  bool allOrNone() const;
  /// Nothing is begun where one axis cannot.
  bool begunByAll() const;
  void refuseUnlessAll();
  void undo(Time now);
  void switchOff(Entry& entry, Time now) const;
  std::string undone(const drive::Axis& axis, bool back) const;
  void restoreMode(Entry& entry, Time now) const;
  bool awaitsNews(Time now) const;
  bool awaitsRest(Time now);
  void judge();
  void skipRest();
  ProcedureReport answer() const;
  std::string text() const;

  drive::ProcedureRequest request_;
  std::vector<Entry> entries_;
  Reply<ProcedureReport> reply_;
  std::string remark_;
  Manner manner_;
  std::optional<Time> ended_;  ///< on the last axis
};

}  // namespace cia402::bus
