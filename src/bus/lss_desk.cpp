// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/lss_desk.h"

#include <utility>

namespace cia402::bus {

void LssDesk::add(std::string who, std::unique_ptr<canopen::LssTask> task, Ended ended,
                  std::optional<Duration> window) {
  queue_.push_back({std::move(who), std::move(task), std::move(ended), window});
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
    master_.setWindow(entry.window.value_or(canopen::LssOptions().window));
    const canopen::LssTask::Status status = entry.task->advance(master_, now);
    if (status == canopen::LssTask::Status::running) continue;
    const Entry ended = std::move(queue_.front());  // its end may add others
    queue_.pop_front();
    const bool done = status == canopen::LssTask::Status::done;
    if (ended.ended) ended.ended(*ended.task, done ? std::string() : ended.task->error(), now);
  }
}

std::string LssDesk::step() const {
  return busy() ? "LSS: " + queue_.front().task->step() : std::string();
}

}  // namespace cia402::bus
