// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "canopen/lss/task.h"

namespace cia402::bus {

/// Carries out LSS tasks one after the other, for there is one LSS master on a bus. Sans-IO.
///
/// Why no JobList does this: jobs take their steps in the cycle, all of them in each. LSS tasks
/// take turns, go on with each answer or after some milliseconds, and run before there is a cycle,
/// for no drive can be booted without its node-ID.
class LssDesk {
 public:
  /// @param error why it failed; empty for success.
  using Ended =
      std::function<void(const canopen::LssTask& task, const std::string& error, Time now)>;
  /// Why a task must not begin now; empty if it may.
  using Refusal = std::function<std::string()>;

  /// @param sink must outlive the desk.
  explicit LssDesk(can::Sink& sink) : sink_(sink), master_(sink) {}

  /// Queues a task. @param who for step(): an axis, or what is done. @param ended called once.
  /// @param refusal asked when its turn has come, for those before it may take long.
  /// @param window of this task alone, see LssOptions::window.
  void add(std::string who, std::unique_ptr<canopen::LssTask> task, Ended ended,
           Refusal refusal = {}, std::optional<Duration> window = {});
  /// Ends everything without further ado, for this reason; no device stays in the configuration
  /// state.
  void abandon(const std::string& why, Time now);

  void receive(const can::Frame& frame, Time now);
  void tick(Time now);
  Time nextDeadline() const {
    if (!busy()) return kNever;
    return master_.busy() ? master_.nextDeadline() : Time();
  }

  bool busy() const { return !queue_.empty(); }
  /// Whose task runs; empty if none does.
  std::string who() const { return busy() ? queue_.front().who : std::string(); }
  /// "LSS: inquiring its node-ID".
  std::string step() const;

 private:
  struct Entry {
    std::string who;
    std::unique_ptr<canopen::LssTask> task;
    Ended ended;
    Refusal refusal;  ///< empty once it was asked
    std::optional<Duration> window;
  };
  void advance(Time now);
  void end(const std::string& error, Time now);

  can::Sink& sink_;
  canopen::LssMaster master_;
  std::deque<Entry> queue_;
};

}  // namespace cia402::bus
