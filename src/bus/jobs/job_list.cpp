// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/job_list.h"

#include <algorithm>
#include <utility>

namespace cia402::bus {

void JobList::add(std::unique_ptr<Job> job) {
  const auto later = std::find_if(jobs_.begin(), jobs_.end(),
                                  [&](const auto& other) { return other->turn() > job->turn(); });
  jobs_.insert(later, std::move(job));
}

void JobList::step(Time now) {
  for (auto job = jobs_.begin(); job != jobs_.end();) {
    job = (*job)->step(now) ? jobs_.erase(job) : job + 1;
  }
}

void JobList::withdraw(const drive::Axis& axis, drive::ProcedureKind by) {
  for (const auto& job : jobs_) job->withdraw(axis, by);
}

void JobList::withdrawEnabling(const std::string& why) {
  for (const auto& job : jobs_) job->withdrawEnabling(why);
}

void JobList::cancel(std::uint64_t id, Time now) {
  for (const auto& job : jobs_) job->cancel(id, now);
}

bool JobList::homes(const drive::Axis& axis) const {
  return std::any_of(jobs_.begin(), jobs_.end(), [&](const auto& job) { return job->homes(axis); });
}

void JobList::release() {
  for (const auto& job : jobs_) job->release();
}

bool JobList::anyHeld() const {
  return std::any_of(jobs_.begin(), jobs_.end(), [](const auto& job) { return job->held(); });
}

void JobList::abandon(Job::Ends up_to, const std::string& why) {
  for (auto job = jobs_.begin(); job != jobs_.end();) {
    const bool ends = (*job)->ends() <= up_to;
    if (ends) (*job)->abandon(why);
    job = ends ? jobs_.erase(job) : job + 1;
  }
}

}  // namespace cia402::bus
