// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/pdo_parameters.h"

#include "fieldbus/abort_code.h"
#include "sim/device/cob_id.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

constexpr std::uint64_t kMaxSync = 240;
constexpr std::uint64_t kRtrSynchronous = 252;
constexpr std::uint64_t kEventVendor = 254;

std::uint32_t checkType(const SlaveContext& context, const PdoRecords& pdo, std::uint64_t type) {
  if (type <= kMaxSync || type >= kEventVendor) return 0;
  const bool rtr = pdo.direction == PdoDirection::transmit && type >= kRtrSynchronous;
  return rtr && context.behaviour.rtr_types ? 0 : abort_code::kInvalidValue;
}

bool idIsFixed(const SlaveContext& context, const PdoRecords& pdo, const Entry& entry,
               std::uint64_t number) {
  const PdoIdentifiers rule = context.behaviour.pdo_identifiers;
  if (rule == PdoIdentifiers::writable || rule == PdoIdentifiers::of_node) return false;
  const bool rtr = rule == PdoIdentifiers::fixed_but_rtr && pdo.direction == PdoDirection::transmit;
  const std::uint64_t free = kCobIdInvalid | (rtr ? kCobIdNoRtr : 0U);
  return rule == PdoIdentifiers::read_only || ((entry.number ^ number) & ~free) != 0;
}

bool leavesNode(const SlaveContext& context, const Entry& entry, std::uint64_t number) {
  const bool bound = context.behaviour.pdo_identifiers == PdoIdentifiers::of_node;
  return bound && ((entry.number ^ number) & 0x7FU) != 0;
}

bool dropsRtrBit(const SlaveContext& context, const PdoRecords& pdo, std::uint64_t number) {
  const bool kept = context.behaviour.keeps_rtr_bit && pdo.direction == PdoDirection::transmit;
  return kept && (number & kCobIdNoRtr) == 0;
}

bool hasBadCobId(const SlaveContext& context, const PdoRecords& pdo) {
  const auto cob_id = static_cast<std::uint32_t>(
      context.value({pdo.communication, pdo_sub::kCobId}, kCobIdInvalid));
  return checkCobId(kCobIdInvalid, cob_id & ~kCobIdInvalid, true) != 0;
}

std::uint32_t checkMappingEntry(const SlaveContext& context, const PdoRecords& pdo,
                                const Entry& entry, std::uint64_t number) {
  const auto refused = Mapping::checkEntry(context.dictionary, number, pdo.direction);
  if (refused != 0 || !countFollowsEntries(context, pdo)) return refused;
  std::uint64_t bits = number & 0xFFU;
  for (std::uint8_t sub = 1; sub <= 64; ++sub) {
    if (sub != entry.id.subindex) bits += context.value({pdo.mapping, sub}) & 0xFFU;
  }
  return bits <= 64 ? 0 : abort_code::kPdoLength;
}

}  // namespace

bool isValid(const SlaveContext& context, const PdoRecords& pdo) {
  const auto cob_id = context.value({pdo.communication, pdo_sub::kCobId}, kCobIdInvalid);
  return (cob_id & kCobIdInvalid) == 0;
}

bool countFollowsEntries(const SlaveContext& context, const PdoRecords& pdo) {
  const DeviceBehaviour& behaviour = context.behaviour;
  if (behaviour.map_count_read_only || behaviour.fixed_map_entries != 0) return true;
  const Entry* count = context.dictionary.find({pdo.mapping, 0});
  return count != nullptr && count->access == Access::ro;
}

void countEntries(SlaveContext& context, const PdoRecords& pdo) {
  if (!countFollowsEntries(context, pdo)) return;
  auto count = static_cast<std::uint8_t>(context.behaviour.fixed_map_entries);
  const auto is_entry = [&](unsigned place) {
    return context.value({pdo.mapping, static_cast<std::uint8_t>(place)}) != 0;
  };
  if (count == 0) {
    while (count < 64 && is_entry(count + 1U)) ++count;
  }
  if (Entry* entry = context.dictionary.find({pdo.mapping, 0})) entry->number = count;
}

void setRtrBit(SlaveContext& context, const PdoRecords& pdo) {
  if (!context.behaviour.keeps_rtr_bit) return;
  if (Entry* entry = context.dictionary.find({pdo.communication, pdo_sub::kCobId})) {
    entry->number |= kCobIdNoRtr;
  }
}

std::uint32_t checkCommunication(const SlaveContext& context, const PdoRecords& pdo,
                                 const Entry& entry, std::uint64_t number) {
  const bool locked = context.behaviour.timers_require_invalid && isValid(context, pdo);
  const bool bound = context.behaviour.type_requires_invalid && isValid(context, pdo);
  switch (entry.id.subindex) {
    case pdo_sub::kCobId:
      if (idIsFixed(context, pdo, entry, number)) return abort_code::kReadOnly;
      if (leavesNode(context, entry, number)) return abort_code::kInvalidValue;
      if (dropsRtrBit(context, pdo, number)) return abort_code::kInvalidValue;
      if (context.behaviour.misleading_cob_id_abort) return 0;
      return checkCobId(static_cast<std::uint32_t>(entry.number),
                        static_cast<std::uint32_t>(number),
                        context.behaviour.disable_may_change_id);
    case pdo_sub::kType:
      if (bound) return abort_code::kDeviceState;
      return checkType(context, pdo, number);
    case pdo_sub::kEventTimer:
      return bound ? abort_code::kDeviceState : 0;
    case pdo_sub::kInhibitTime:
      return locked ? abort_code::kDeviceState : 0;
    case pdo_sub::kSyncStart:
      if (locked) return abort_code::kDeviceState;
      return number <= kMaxSync ? 0 : abort_code::kInvalidValue;
    default:
      return 0;
  }
}

std::uint32_t checkMapping(const SlaveContext& context, const PdoRecords& pdo, const Entry& entry,
                           std::uint64_t number) {
  const bool follows = countFollowsEntries(context, pdo);
  const bool fixed = context.behaviour.fixed_map_entries != 0;
  const bool by_the_book = context.behaviour.mapping_requires_invalid && !follows;
  const bool needs_invalid = by_the_book || (fixed && context.behaviour.mapping_requires_invalid);
  if (entry.id.subindex == 0) {
    if (follows) return abort_code::kReadOnly;
    if (by_the_book && isValid(context, pdo)) return abort_code::kDeviceState;
    return Mapping::check(context.dictionary, pdo.mapping, number, pdo.direction);
  }
  if (needs_invalid && isValid(context, pdo)) return abort_code::kDeviceState;
  if (by_the_book && context.value({pdo.mapping, 0}) != 0) return abort_code::kUnsupportedAccess;
  if (context.behaviour.misleading_cob_id_abort && hasBadCobId(context, pdo)) {
    return abort_code::kNotMappable;
  }
  const bool check_now = follows || context.behaviour.map_entry_checked_on_write;
  return check_now && number != 0 ? checkMappingEntry(context, pdo, entry, number) : 0;
}

}  // namespace cia402::sim
