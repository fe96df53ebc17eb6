// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/own_bus.h"

#include <algorithm>

namespace cia402::sim {
namespace {

constexpr Duration kAnswered = std::chrono::milliseconds(2);  // a write is answered before

Entry* find(ObjectDictionary& dictionary, const std::optional<ObjectId>& id) {
  return id ? dictionary.find(*id) : nullptr;
}

}  // namespace

void OwnBus::setUp() {
  Entry* entry = find(dictionary_, definition_.bit_rate);
  const auto known = std::find_if(definition_.rates.begin(), definition_.rates.end(),
                                  [this](const auto& rate) { return rate.second == of_bus_; });
  if (entry == nullptr || known == definition_.rates.end()) return;
  entry->number = entry->initial_number = known->first;
}

std::optional<canopen::NodeId> OwnBus::nodeId() const {
  const Entry* entry = find(dictionary_, definition_.node_id);
  if (entry == nullptr) return {};
  return static_cast<canopen::NodeId>(definition_.at_once ? entry->number : entry->initial_number);
}

bool OwnBus::foreign() const {
  const Entry* entry = find(dictionary_, definition_.bit_rate);
  if (entry == nullptr || of_bus_ == 0) return false;
  const auto rate = definition_.rates.find(entry->number);
  return rate == definition_.rates.end() || rate->second != of_bus_;
}

void OwnBus::written(const Entry& entry, Time now) {
  if (holds(entry.id) && definition_.at_once) due_ = now + kAnswered;
}

bool OwnBus::count(canopen::NodeId present) {
  due_ = kNever;
  return nodeId().value_or(present) != present;
}

/// What was not kept is lost.
void OwnBus::powerOff() {
  due_ = kNever;
  Entry* entry = find(dictionary_, definition_.node_id);
  if (entry != nullptr) entry->number = entry->initial_number;
}

}  // namespace cia402::sim
