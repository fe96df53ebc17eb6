// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/reply_log.h"

#include "bus/real_clock.h"

namespace cia402::bus {
namespace {

constexpr std::size_t kCapacity = 256;
constexpr Duration kRefusalInterval = std::chrono::seconds(1);

}  // namespace

ReplyLog::ReplyLog(std::size_t axes, std::size_t groups) : entries_(kCapacity) {
  for (std::size_t i = 0; i < axes; ++i) refusals_.emplace_back(kRefusalInterval);
  for (std::size_t i = 0; i < groups; ++i) group_refusals_.emplace_back(kRefusalInterval);
}

/// Not larger than what a reply holds without memory.
Reply<> ReplyLog::toStream(ReplyLog& log, Throttle& refusals) {
  return [&log, &refusals](const Answer& answer) {
    if (answer.success || !refusals.permit(realNow())) return;
    log.add(Level::warning, answer.message);
  };
}

Reply<> ReplyLog::toSetpoint(std::size_t axis) { return toStream(*this, refusals_[axis]); }

Reply<> ReplyLog::toGroupSetpoints(std::size_t group) {
  return toStream(*this, group_refusals_[group]);
}

Reply<TrajectoryAnswer> ReplyLog::toTrajectory() {
  return [this](const TrajectoryAnswer& answer) {
    const bool differs = answer.passed_points > 0 || answer.slowed;
    const Level accepted = differs ? Level::warning : Level::debug;
    add(answer.success ? accepted : Level::error, answer.message);
  };
}

void ReplyLog::add(Level level, const std::string& text) {
  Entry entry;
  entry.level = level;
  entry.text.assign(text);
  if (!entries_.push(std::move(entry))) ++lost_;
}

}  // namespace cia402::bus
