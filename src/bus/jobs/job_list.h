// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/jobs/job.h"

namespace cia402::bus {

/// The jobs that are under way on a bus.
class JobList {
 public:
  void add(std::unique_ptr<Job> job);
  /// A step of each. @pre no job adds another one in its step
  void step(Time now);
  bool empty() const { return jobs_.empty(); }

  /// Those of Job, to each.
  void withdraw(const drive::Axis& axis, drive::ProcedureKind by);
  void withdrawEnabling(const std::string& why);
  void cancel(std::uint64_t id, Time now);
  void release();
  bool anyHeld() const;
  /// One of them homes that axis.
  bool homes(const drive::Axis& axis) const;
  /// Ends the jobs that end at once, or all.
  void abandon(Job::Ends up_to, const std::string& why);

 private:
  std::vector<std::unique_ptr<Job>> jobs_;  // by their turn
};

}  // namespace cia402::bus
