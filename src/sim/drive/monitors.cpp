// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/monitors.h"

#include <algorithm>
#include <cmath>

namespace cia402::sim {
namespace {

using Shows = MonitorDefinition::Shows;

constexpr std::uint32_t kNmtId = 0x000, kHeartbeatIds = 0x700, kNodeBits = 0x7F;
constexpr std::uint8_t kNmtCommands[] = {1, 2, 128, 129, 130};

/// The lowest bits of it.
std::uint64_t cut(std::uint64_t number, unsigned bits) {
  return number & (bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1);
}

std::uint64_t bitsOf(double value, const Entry& entry) {
  return cut(static_cast<std::uint64_t>(static_cast<std::int64_t>(std::llround(value))),
             widthBits(entry.type));
}

}  // namespace

Monitors::Monitors(const MonitorsDefinition& definition, ObjectDictionary& dictionary,
                   DriveCore& core)
    : definition_(definition), dictionary_(dictionary), core_(core) {
  for (const auto& pair : definition_.shown) {
    const MonitorDefinition& monitor = pair.second;
    if (monitor.shows == Shows::constant) continue;
    dictionary_.onRead(pair.first, [this, &monitor](Entry& entry) {
      entry.number = number(monitor, entry);
      return 0U;
    });
  }
}

void Monitors::start(bool power_on, Time now) {
  if (power_on) before_ += now_ - since_;
  if (power_on || since_ == Time{}) since_ = now;
  now_ = now;
  for (const auto& [id, monitor] : definition_.shown) {
    Entry* entry = monitor.shows == Shows::constant ? dictionary_.find(id) : nullptr;
    if (entry != nullptr) entry->number = bitsOf(monitor.scale, *entry);
  }
}

std::uint64_t Monitors::numberOf(const std::optional<fieldbus::ObjectId>& object) const {
  const Entry* entry = object ? dictionary_.find(*object) : nullptr;
  return entry != nullptr ? static_cast<std::uint64_t>(asSigned(*entry)) : 0;
}

std::uint64_t Monitors::number(const MonitorDefinition& monitor, const Entry& entry) const {
  const bool outputs = monitor.shows == Shows::outputs;
  if (!outputs && !monitor.object) return bitsOf(value(monitor), entry);
  const std::uint64_t whole = outputs ? core_.outputs() : numberOf(monitor.object);
  return cut((whole - numberOf(monitor.less)) >> monitor.first_bit,
             std::min(monitor.bits, widthBits(entry.type)));
}

double Monitors::value(const MonitorDefinition& monitor) const {
  const Motor& motor = core_.motion().motor();
  const double periods = monitor.periods ? static_cast<double>(numberOf(monitor.periods)) : 1.0;
  const double turns = core_.motion().counter() * periods;
  switch (monitor.shows) {
    case Shows::speed:
      return motor.velocity() * monitor.scale;
    case Shows::torque:
      return motor.torque() * monitor.scale;
    case Shows::load:
      return std::fabs(motor.torque()) * monitor.scale;
    case Shows::angle:
      return std::floor((turns - std::floor(turns)) * monitor.scale);
    case Shows::time:
      return toSeconds(now_ - since_) * monitor.scale;
    case Shows::total_time:
      return toSeconds(before_ + (now_ - since_)) * monitor.scale;
    case Shows::constant:
    case Shows::object:
    case Shows::outputs:
      break;
  }
  return 0.0;
}

void Monitors::count(const std::optional<fieldbus::ObjectId>& counter) {
  Entry* entry = counter ? dictionary_.find(*counter) : nullptr;
  if (entry != nullptr) ++entry->number;
}

void Monitors::heard(const can::Frame& frame) {
  if (frame.id == kNmtId) {
    const auto* end = std::end(kNmtCommands);
    const bool whole = frame.size == 2;
    if (!whole) count(definition_.nmt_length);
    if (whole && std::find(std::begin(kNmtCommands), end, frame.data[0]) == end) {
      count(definition_.nmt_command);
    }
    return;
  }
  const bool heartbeat = (frame.id & ~kNodeBits) == kHeartbeatIds && frame.id != kHeartbeatIds;
  if (heartbeat && !frame.remote && frame.size != 1) count(definition_.heartbeat_length);
}

}  // namespace cia402::sim
