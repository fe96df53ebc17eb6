// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/alarm_memory.h"

#include <algorithm>

namespace cia402::sim {

void AlarmMemory::start(Time now) {
  started_ = now;
  show();
}

void AlarmMemory::add(std::int64_t details, Time now) {
  std::rotate(alarms_.begin(), alarms_.end() - 1, alarms_.end());
  alarms_.front() = {details & 0xFFFF, toSeconds(now - started_), {}};
  for (const auto& pair : more_) alarms_.front().more.push_back(shownBy(pair.second));
  show();
}

std::uint64_t AlarmMemory::shownBy(ObjectId id) {
  Entry* entry = dictionary_.find(id);
  if (entry == nullptr) return 0;
  const auto& bring_up_to_date = dictionary_.hooks(id).read;
  if (bring_up_to_date) bring_up_to_date(*entry);
  return entry->number;
}

void AlarmMemory::show() {
  const std::int64_t number = values_.raw(Role::alarm_select, 0);
  const bool known = number >= 0 && number < static_cast<std::int64_t>(kMost);
  const Alarm alarm = known ? alarms_[static_cast<std::size_t>(number)] : Alarm();
  values_.setRaw(Role::alarm_code, alarm.code);
  values_.set(Role::alarm_time, alarm.time);
  for (std::size_t i = 0; i < more_.size(); ++i) {
    Entry* entry = dictionary_.find(more_[i].first);
    if (entry != nullptr) entry->number = i < alarm.more.size() ? alarm.more[i] : 0;
  }
}

}  // namespace cia402::sim
