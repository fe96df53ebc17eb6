// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <list>
#include <memory>

#include "bus/jobs/procedure_progress.h"
#include "campaign/session.h"

namespace cia402::campaign {

/// The services of a robot: calls them, and sees to it that each is answered once and in time.
class Calls {
 public:
  /// The way between the calls and the driver.
  class Line {
   public:
    virtual ~Line() = default;
    /// Gives a command to the driver.
    virtual void post(bus::Command command) = 0;
    /// A reply on its way back.
    virtual bus::Reply<> replied(bus::Reply<> reply) { return reply; }
  };

  /// Both must outlive it.
  Calls(Session& session, Line& line);

  /// @return false if the words are no call.
  bool act(const Words& words);
  /// A call that `act` has not made is answered.
  void answered(const Call& call, const bus::Answer& answer);
  /// An axis may move from now on because it is told to home.
  void permitHoming(const Call& call);
  /// Calls of a process that is gone are answered by nobody.
  void drop() { pending_.clear(); }
  /// Reports what is overdue.
  void watchDeadlines();
  /// Whether a call waits for its answer.
  bool waits() const { return !pending_.empty(); }

 private:
  struct Pending {
    Call call;
    Time deadline{};
    std::shared_ptr<bool> answered = std::make_shared<bool>(false);
  };
  bool actProcedure(const Words& words);
  /// homing NAME,NAME... ORDER,ORDER...: the action, of axes and groups; without orders as they are
  /// configured
  void home(const Words& words);
  void cancelHome();
  template <typename Request>
  void call(const Words& words, Request request, Duration bound);
  template <typename Request>
  void call(Call call, Request request, Duration bound);
  /// A search for home that somebody ended is answered once its motors stand.
  void judgeStopped(const Call& call, const bus::ProcedureReport& report);
  void endPermits(const Call& call, const bus::Answer& answer);
  bool waitsToHome(const Call& call, std::size_t axis) const;
  bool homesStill(std::size_t axis) const;

  Session& session_;
  Line& line_;
  std::list<Pending> pending_;
  std::uint64_t last_home_ = 0;
};

}  // namespace cia402::campaign
