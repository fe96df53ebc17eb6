// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/wanted.h"

#include <algorithm>

namespace cia402::canopen {
namespace {

constexpr std::uint32_t kExtendedBit = 0x20000000;  // bit 29: an identifier of 29 bits
constexpr std::uint32_t kMaxCanId = 0x7FF;

}  // namespace

std::string PdoWanted::title() const {
  return (config_.direction == PdoDirection::tpdo ? "TPDO " : "RPDO ") +
         std::to_string(config_.number);
}

std::uint16_t PdoWanted::communication() const {
  const unsigned first = config_.direction == PdoDirection::tpdo ? 0x1800 : 0x1400;
  return static_cast<std::uint16_t>(first + config_.number - 1);
}

std::uint16_t PdoWanted::mapping() const {
  const unsigned first = config_.direction == PdoDirection::tpdo ? 0x1A00 : 0x1600;
  return static_cast<std::uint16_t>(first + config_.number - 1);
}

bool PdoWanted::isRequestedTpdo() const {
  return config_.direction == PdoDirection::tpdo && isRequested(config_.transmission);
}

bool PdoWanted::adopt(std::uint32_t cob_id) {
  const std::uint32_t can_id = cob_id & kCanIdMask;
  if ((cob_id & kExtendedBit) != 0 || can_id == 0 || can_id > kMaxCanId) return false;
  config_.cob_id = static_cast<std::uint16_t>(can_id);
  adopted_ = config_.cob_id;
  return true;
}

std::uint32_t PdoWanted::entryValue(std::size_t item) const {
  const PdoEntry& entry = config_.entries[item];
  return static_cast<std::uint32_t>(entry.object.index) << 16 |
         static_cast<std::uint32_t>(entry.object.subindex) << 8 | entry.bits;
}

std::string PdoWanted::entryName(std::size_t item) const {
  const PdoEntry& entry = config_.entries[item];
  std::string name = "entry " + std::to_string(item + 1) + " (" + toString(entry.object);
  if (!entry.name.empty()) name += " " + entry.name;
  return name + ")";
}

unsigned PdoWanted::bits() const {
  unsigned bits = 0;
  for (const PdoEntry& entry : config_.entries) bits += entry.bits;
  return bits;
}

bool PdoWanted::mayLack(std::size_t item) const {
  return config_.entries[item].optional || config_.entries[item].if_room;
}

bool PdoWanted::allOptional() const {
  return !empty() && std::all_of(config_.entries.begin(), config_.entries.end(),
                                 [](const PdoEntry& entry) { return entry.optional; });
}

std::size_t PdoWanted::nextOptional(std::size_t item) const {
  while (item < size() && !config_.entries[item].optional) ++item;
  return item;
}

std::size_t PdoWanted::lastOptional() const {
  std::size_t last = nextOptional(0);
  while (nextOptional(last + 1) < size()) last = nextOptional(last + 1);
  return last;
}

std::optional<std::size_t> PdoWanted::rider() const {
  const auto& entries = config_.entries;
  const auto rider = std::find_if(entries.begin(), entries.end(),
                                  [](const PdoEntry& entry) { return entry.if_room; });
  if (rider == entries.end()) return std::nullopt;
  return static_cast<std::size_t>(rider - entries.begin());
}

void PdoWanted::leaveOut(std::size_t item) {
  const auto gone = config_.entries.begin() + static_cast<std::ptrdiff_t>(item);
  left_out_.push_back(*gone);
  config_.entries.erase(gone);
}

void PdoWanted::leaveOutAll() {
  while (!empty()) leaveOut(0);
}

}  // namespace cia402::canopen
