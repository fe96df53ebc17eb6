// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/found.h"

#include "common/text.h"

namespace cia402::canopen {
namespace {

constexpr std::uint32_t kNoRemoteBit = 0x40000000;  // bit 30: the drive's own choice, kept

std::string tell(ObjectId object, const std::string& is, const std::string& wanted) {
  return toString(object) + " is " + is + ", wanted is " + wanted;
}

}  // namespace

PdoFound::PdoFound(const PdoWanted& wanted) {
  const PdoConfig& config = wanted.config();
  const bool tpdo = config.direction == PdoDirection::tpdo;
  parameters_.push_back({2, 1, "transmission type", config.transmission, false, {}});
  if (tpdo) parameters_.push_back({3, 2, "inhibit time", config.inhibit, true, {}});
  parameters_.push_back({5, 2, "event timer", config.event_timer, true, {}});
  if (tpdo && config.sync_start) {
    parameters_.push_back({6, 1, "SYNC start value", *config.sync_start, true, {}});
  }
}

std::uint32_t PdoFound::enabledCobId(const PdoWanted& wanted) const {
  return (wanted.isRequestedTpdo() ? 0 : cob_id_ & kNoRemoteBit) | wanted.config().cob_id;
}

std::size_t PdoFound::nextToWrite(std::size_t item) const {
  while (item < parameters_.size() && parameters_[item].actual == parameters_[item].wanted) ++item;
  return item;
}

void PdoFound::setCount(std::size_t count) {
  count_ = count;
  entries_.clear();
}

void PdoFound::leaveOutFillers() {
  while (!entries_.empty() && entries_.back() == 0) entries_.pop_back();
  count_ = entries_.size();
}

bool PdoFound::mapDiffers(const PdoWanted& wanted) const {
  if (count_ != wanted.size()) return true;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i] != wanted.entryValue(i)) return true;
  }
  return false;
}

std::string PdoFound::firstDifference(const PdoWanted& wanted, bool count_is_fixed) const {
  const std::uint16_t communication = wanted.communication(), mapping = wanted.mapping();
  const std::uint32_t cob_id = enabledCobId(wanted);
  if (cob_id_ != cob_id) return tell({communication, 1}, hexText(cob_id_, 8), hexText(cob_id, 8));
  for (const PdoParameter& parameter : parameters_) {
    if (parameter.actual == parameter.wanted) continue;
    return tell({communication, parameter.subindex}, std::to_string(parameter.actual.value_or(0)),
                std::to_string(parameter.wanted));
  }
  if (count_ != wanted.size() && count_is_fixed) {
    return toString(ObjectId{mapping, 0}) + " has " + std::to_string(count_) +
           " entries in use, wanted are " + std::to_string(wanted.size());
  }
  if (count_ != wanted.size()) {
    return tell({mapping, 0}, std::to_string(count_), std::to_string(wanted.size()));
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i] == wanted.entryValue(i)) continue;
    return tell({mapping, static_cast<std::uint8_t>(i + 1)}, hexText(entries_[i], 8),
                hexText(wanted.entryValue(i), 8));
  }
  return {};
}

}  // namespace cia402::canopen
