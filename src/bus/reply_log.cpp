// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/reply_log.h"

#include "bus/real_clock.h"

namespace cia402::bus {
namespace {

constexpr std::size_t kCapacity = 256;
constexpr Duration kRefusalInterval = std::chrono::seconds(1);

}  // namespace

ReplyLog::ReplyLog(std::size_t axes) : entries_(kCapacity) {
  for (std::size_t i = 0; i < axes; ++i) refusals_.emplace_back(kRefusalInterval);
}

Reply<> ReplyLog::toSetpoint(std::size_t axis) {
  return [this, axis](const Answer& answer) {
    if (answer.success || !refusals_[axis].permit(realNow())) return;
    add(Level::warning, answer.message);
  };
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
