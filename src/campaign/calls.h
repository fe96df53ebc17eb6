// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <list>
#include <memory>

#include "campaign/session.h"

namespace cia402::campaign {

/// The services of a robot: calls them, and sees to it that each is answered once and in time.
class Calls {
 public:
  /// Gives a command to the driver.
  using Post = std::function<void(bus::Command)>;

  /// `session` must outlive it.
  Calls(Session& session, Post post);

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
  void call(const Words& words, decltype(bus::Command::body) body, Duration bound);
  void endPermits(const Call& call, const bus::Answer& answer);
  bool homesStill(std::size_t axis) const;

  Session& session_;
  Post post_;
  std::list<Pending> pending_;
};

}  // namespace cia402::campaign
