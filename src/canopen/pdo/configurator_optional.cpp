// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "canopen/pdo/configurator.h"
#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

/// 0x06040041 and what drives answer instead of it.
bool isMissingOrUnmappable(const fieldbus::Transfer& transfer) {
  const std::uint32_t code = transfer.abortCode();
  return transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server &&
         (code == abort_code::kNoSuchObject || code == abort_code::kNoSuchSubindex ||
          code == abort_code::kNotMappable);
}

}  // namespace

bool PdoConfigurator::leaveOutWhole(const fieldbus::Transfer& transfer) {
  if (!isMissingOrUnmappable(transfer) || !allOptional()) return false;
  while (!wanted_.entries.empty()) leaveOut(0);
  return true;
}

/// Most drives judge an entry when it is written.
bool PdoConfigurator::leaveOutEntry(const fieldbus::Transfer& transfer) {
  if (phase_ != Phase::write_entry) return false;
  const PdoEntry& entry = wanted_.entries[item_];
  const bool goes = entry.if_room
                        ? transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server
                        : entry.optional && isMissingOrUnmappable(transfer);
  if (!goes) return false;
  leaveOut(item_);  // the next one has its place then
  if (item_ == wanted_.entries.size()) afterEntries();
  return true;
}

/// A PDO that the drive does not take as a whole may be one without what is there for the room
/// only.
bool PdoConfigurator::leaveOutRider(const fieldbus::Transfer& transfer) {
  const auto& entries = wanted_.entries;
  const auto rider = std::find_if(entries.begin(), entries.end(),
                                  [](const PdoEntry& entry) { return entry.if_room; });
  const bool refused = phase_ == Phase::write_count &&
                       transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server;
  if (!refused || rider == entries.end() || refusedReadOnlyCount(transfer)) return false;
  leaveOut(static_cast<std::size_t>(rider - entries.begin()));
  if (wanted_.entries.empty()) {
    afterEntries();
  } else {
    enter(Phase::clear_map);
  }
  return true;
}

/// Others judge all of them at the end, without a word about which one is wrong: those that it does
/// not have are found by reading them.
bool PdoConfigurator::probeEntries(const fieldbus::Transfer& transfer) {
  if (phase_ != Phase::write_count || !isMissingOrUnmappable(transfer)) return false;
  if (!anyOptional()) return false;
  left_out_before_probe_ = left_out_.size();
  enter(Phase::probe_entry, nextOptional(0));
  return true;
}

void PdoConfigurator::answeredProbe(const fieldbus::Transfer& transfer) {
  const bool aborted = transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server;
  if (!transfer.ok() && !aborted) return failTransfer(transfer);
  std::size_t next = item_ + 1;
  if (!transfer.ok() && isMissingOrUnmappable(transfer)) leaveOut(next = item_);
  next = nextOptional(next);
  if (next < wanted_.entries.size()) return enter(Phase::probe_entry, next);
  if (left_out_.size() == left_out_before_probe_) {  // it has them all: the last one goes
    std::size_t last = nextOptional(0);
    while (nextOptional(last + 1) < wanted_.entries.size()) last = nextOptional(last + 1);
    leaveOut(last);
  }
  if (wanted_.entries.empty()) return afterEntries();
  enter(Phase::clear_map);
}

void PdoConfigurator::leaveOut(std::size_t item) {
  const auto gone = wanted_.entries.begin() + static_cast<std::ptrdiff_t>(item);
  left_out_.push_back(*gone);
  wanted_.entries.erase(gone);
}

bool PdoConfigurator::allOptional() const {
  return !wanted_.entries.empty() &&
         std::all_of(wanted_.entries.begin(), wanted_.entries.end(),
                     [](const PdoEntry& entry) { return entry.optional; });
}

std::size_t PdoConfigurator::nextOptional(std::size_t item) const {
  while (item < wanted_.entries.size() && !wanted_.entries[item].optional) ++item;
  return item;
}

}  // namespace cia402::canopen
