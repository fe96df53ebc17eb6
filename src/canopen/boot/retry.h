// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canopen/boot/context.h"

namespace cia402::canopen {

/// Decides what happens by itself after a boot that did not succeed: another attempt, a slow search
/// for a node that does not answer, or nothing.
class BootRetry {
 public:
  explicit BootRetry(const BootPolicy& policy) : policy_(policy) {}

  /// A boot begins that is no repetition: counts begin anew.
  void reset();
  /// A boot failed; another attempt may become due.
  void failed(BootFailure failure, Time now);
  /// Nobody answers: the node is looked for from now on, but not before `earliest`.
  void search(Time now, Time earliest = Time());
  /// It may answer by now: it is looked for at `at`, also where search_period says never.
  void look(Time at);
  /// The search found nobody.
  void notFound(Time now);

  bool retryDue(Time now) const { return !searching_ && now >= due_; }
  bool searchDue(Time now) const { return searching_ && now >= due_; }
  /// What was due is under way.
  void begun();
  Time deadline() const { return due_; }

  /// For a problem: "; it is tried again in 1 s (attempt 2 of 3)"; empty if there is nothing to
  /// say.
  std::string outlook() const;
  /// For a step: "attempt 2 of 3: " while repeating, or how the search goes.
  std::string attemptText() const;
  std::string searchText() const;

 private:
  BootPolicy policy_;
  unsigned attempt_ = 1, searches_ = 0;
  bool searching_ = false, given_up_ = false;
  Duration period_{};  ///< of the search at present
  Time due_ = kNever;
};

}  // namespace cia402::canopen
