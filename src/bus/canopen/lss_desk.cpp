// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/lss_desk.h"

#include <utility>

namespace cia402::bus {

void LssDesk::add(std::string who, std::unique_ptr<canopen::LssTask> task, Ended ended,
                  Refusal refusal, std::optional<Duration> window) {
  queue_.push_back({std::move(who), std::move(task), std::move(ended), std::move(refusal), window});
}

void LssDesk::abandon(const std::string& why, Time now) {
  if (!busy()) return;
  master_.stop();
  sink_.send(canopen::lss::switchGlobal(canopen::lss::State::waiting));
  for (; busy(); queue_.pop_front()) {
    const Entry& entry = queue_.front();
    if (entry.ended) entry.ended(*entry.task, why, now);
  }
}

void LssDesk::receive(const can::Frame& frame, Time now) {
  if (frame.id == canopen::lss::kAnswerId) master_.receive(frame, now);
}

void LssDesk::tick(Time now) {
  master_.tick(now);
  advance(now);
}

void LssDesk::advance(Time now) {
  while (!queue_.empty() && !master_.busy()) {
    Entry& entry = queue_.front();
    if (const Refusal refusal = std::exchange(entry.refusal, nullptr)) {
      const std::string why = refusal();
      if (!why.empty()) {
        end(why, now);
        continue;
      }
    }
    master_.setWindow(entry.window.value_or(canopen::LssOptions().window));
    const canopen::LssTask::Status status = entry.task->advance(master_, now);
    if (status == canopen::LssTask::Status::running) continue;
    end(status == canopen::LssTask::Status::done ? std::string() : entry.task->error(), now);
  }
}

/// The present task has ended; its end may add others.
void LssDesk::end(const std::string& error, Time now) {
  const Entry ended = std::move(queue_.front());
  queue_.pop_front();
  if (ended.ended) ended.ended(*ended.task, error, now);
}

std::string LssDesk::step() const {
  return busy() ? "LSS: " + queue_.front().task->step() : std::string();
}

}  // namespace cia402::bus
