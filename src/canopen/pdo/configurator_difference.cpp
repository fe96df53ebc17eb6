// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>

#include "canopen/pdo/configurator.h"

namespace cia402::canopen {
namespace {

constexpr std::uint32_t kNoRemoteBit = 0x40000000;  // bit 30: the drive's own choice, kept

}  // namespace

std::string PdoConfigurator::hex(std::uint32_t value, int digits) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%0*X", digits, static_cast<unsigned>(value));
  return text.data();
}

/// Where the number of entries is fixed, those behind the last object are none.
void PdoConfigurator::leaveOutFillers() {
  if (options_.fixed_entries == 0) return;
  while (!entries_.empty() && entries_.back() == 0) entries_.pop_back();
  count_ = entries_.size();
}

void PdoConfigurator::verify() {
  const std::string difference = firstDifference();
  if (difference.empty()) return enter(Phase::done);
  std::string reason = "the drive took all writes, but " + difference;
  if (map_refused_) {
    reason = "the drive refuses to change the number of mapped objects (" +
             toString(ObjectId{mapping_, 0}) + " is read-only), and " + difference;
  }
  fail(reason + "; choose a mapping that the drive can hold");
}

std::string PdoConfigurator::title() const {
  return (wanted_.direction == PdoDirection::tpdo ? "TPDO " : "RPDO ") +
         std::to_string(wanted_.number);
}

std::uint32_t PdoConfigurator::enabledCobId() const {
  const bool requested =
      wanted_.direction == PdoDirection::tpdo && isRequested(wanted_.transmission);
  return (requested ? 0 : cob_id_ & kNoRemoteBit) | wanted_.cob_id;
}

std::uint32_t PdoConfigurator::entryValue(std::size_t item) const {
  const PdoEntry& entry = wanted_.entries[item];
  return static_cast<std::uint32_t>(entry.object.index) << 16 |
         static_cast<std::uint32_t>(entry.object.subindex) << 8 | entry.bits;
}

std::string PdoConfigurator::entryName(std::size_t item) const {
  const PdoEntry& entry = wanted_.entries[item];
  std::string name = "entry " + std::to_string(item + 1) + " (" + toString(entry.object);
  if (!entry.name.empty()) name += " " + entry.name;
  return name + ")";
}

bool PdoConfigurator::mapDiffers() const {
  if (count_ != wanted_.entries.size()) return true;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i] != entryValue(i)) return true;
  }
  return false;
}

std::string PdoConfigurator::firstDifference() const {
  const auto tell = [](ObjectId object, const std::string& is, const std::string& wanted) {
    return toString(object) + " is " + is + ", wanted is " + wanted;
  };
  if (cob_id_ != enabledCobId()) {
    return tell({communication_, 1}, hex(cob_id_, 8), hex(enabledCobId(), 8));
  }
  for (const Parameter& parameter : parameters_) {
    if (parameter.actual == parameter.wanted) continue;
    return tell({communication_, parameter.subindex}, std::to_string(parameter.actual.value_or(0)),
                std::to_string(parameter.wanted));
  }
  if (count_ != wanted_.entries.size() && options_.fixed_entries != 0) {
    return toString(ObjectId{mapping_, 0}) + " has " + std::to_string(count_) +
           " entries in use, wanted are " + std::to_string(wanted_.entries.size());
  }
  if (count_ != wanted_.entries.size()) {
    return tell({mapping_, 0}, std::to_string(count_), std::to_string(wanted_.entries.size()));
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i] == entryValue(i)) continue;
    return tell({mapping_, static_cast<std::uint8_t>(i + 1)}, hex(entries_[i], 8),
                hex(entryValue(i), 8));
  }
  return {};
}

}  // namespace cia402::canopen
