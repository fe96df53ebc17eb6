// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/configurator.h"

#include <algorithm>
#include <utility>

#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

constexpr std::uint32_t kInvalidBit = 0x80000000;   // CiA 301, 7.5.2.35, bit 31
constexpr std::uint32_t kExtendedBit = 0x20000000;  // bit 29: an identifier of 29 bits
constexpr std::uint32_t kCanIdMask = 0x1FFFFFFF;
constexpr std::uint32_t kMaxCanId = 0x7FF;
constexpr unsigned kMaxPdoBits = 64;

unsigned totalBits(const PdoConfig& pdo) {
  unsigned bits = 0;
  for (const PdoEntry& entry : pdo.entries) bits += entry.bits;
  return bits;
}

}  // namespace

PdoConfigurator::PdoConfigurator(SdoClient& sdo, const PdoConfig& wanted, Options options)
    : sdo_(sdo), wanted_(wanted), options_(options) {
  const bool tpdo = wanted.direction == PdoDirection::tpdo;
  const auto offset = static_cast<std::uint16_t>(wanted.number - 1);
  communication_ = static_cast<std::uint16_t>((tpdo ? 0x1800 : 0x1400) + offset);
  mapping_ = static_cast<std::uint16_t>((tpdo ? 0x1A00 : 0x1600) + offset);
  parameters_.push_back({2, 1, "transmission type", wanted.transmission, false, {}});
  if (tpdo) parameters_.push_back({3, 2, "inhibit time", wanted.inhibit, true, {}});
  parameters_.push_back({5, 2, "event timer", wanted.event_timer, true, {}});
}

PdoConfigurator::Status PdoConfigurator::advance() {
  if (!ticket_ && phase_ == Phase::read_cob_id) {
    if (wanted_.number < 1 || wanted_.number > 512) {
      fail("there is no PDO of this number, 1..512 are allowed");
    } else if (totalBits(wanted_) > kMaxPdoBits) {
      fail("its entries have " + std::to_string(totalBits(wanted_)) + " bits, 64 fit in a PDO");
    } else if (options_.fixed_entries != 0 && wanted_.entries.size() > options_.fixed_entries) {
      fail("it has " + std::to_string(wanted_.entries.size()) +
           " entries, the drive has room for " + std::to_string(options_.fixed_entries));
    } else {
      ask();
    }
  }
  while (ticket_ && ticket_->done()) {
    const SdoTicket finished = std::exchange(ticket_, {});
    answered(*finished);
    if (phase_ != Phase::done && phase_ != Phase::failed) ask();
  }
  if (phase_ == Phase::failed) return Status::failed;
  return phase_ == Phase::done ? Status::done : Status::running;
}

void PdoConfigurator::ask() {
  const auto n = static_cast<std::uint8_t>(item_ + 1);
  switch (phase_) {
    case Phase::read_cob_id:
      return read({communication_, 1}, "COB-ID");
    case Phase::read_parameter:
      return read({communication_, parameters_[item_].subindex}, parameters_[item_].name);
    case Phase::read_count:
      return read({mapping_, 0}, "number of entries");
    case Phase::read_entry:
      return read({mapping_, n}, "entry " + std::to_string(n));
    case Phase::disable:
      return write({communication_, 1}, cob_id_ | kInvalidBit, 4, "COB-ID");
    case Phase::clear_map:
      return write({mapping_, 0}, 0, 1, "number of entries");
    case Phase::clear_entry:
      return write({mapping_, n}, 0, 4, "entry " + std::to_string(n));
    case Phase::write_entry:
      return write({mapping_, n}, entryValue(item_), 4, entryName(item_));
    case Phase::write_count:
      return write({mapping_, 0}, static_cast<std::uint32_t>(wanted_.entries.size()), 1,
                   "number of entries");
    case Phase::probe_entry:
      return read(wanted_.entries[item_].object, entryName(item_));
    case Phase::write_parameter:
      return write({communication_, parameters_[item_].subindex}, parameters_[item_].wanted,
                   parameters_[item_].size, parameters_[item_].name);
    case Phase::enable:
      return write({communication_, 1}, enabledCobId(), 4, "COB-ID");
    case Phase::done:
    case Phase::failed:
      return;
  }
}

void PdoConfigurator::read(ObjectId object, const std::string& name) {
  const std::string full_name = name + " of " + title();
  step_ = (verifying_ ? "reading back " : "reading ") + toString(object) + " " + full_name;
  const bool parameter = phase_ == Phase::read_parameter && parameters_[item_].missing_is_zero &&
                         parameters_[item_].wanted == 0;
  const bool may_lack =
      parameter || phase_ == Phase::probe_entry ||
      (phase_ == Phase::read_cob_id && (options_.may_be_missing || allOptional()));
  ticket_ = sdo_.upload(object, full_name, may_lack ? options_.if_there : std::nullopt);
}

void PdoConfigurator::write(ObjectId object, std::uint32_t value, unsigned size,
                            const std::string& name) {
  changed_ = true;
  const std::string full_name = name + " of " + title();
  step_ = "writing " + hex(value, static_cast<int>(2 * size)) + " to " + toString(object) + " " +
          full_name;
  const bool may_lack = (phase_ == Phase::write_entry &&
                         (wanted_.entries[item_].optional || wanted_.entries[item_].if_room)) ||
                        (phase_ == Phase::write_count && anyOptional());
  ticket_ = sdo_.download(object, toBytes(value, size), full_name,
                          may_lack ? options_.if_there : std::nullopt);
}

void PdoConfigurator::answered(const fieldbus::Transfer& transfer) {
  if (transfer.direction() == fieldbus::Transfer::Direction::upload) {
    answeredRead(transfer);
  } else {
    answeredWrite(transfer);
  }
}

void PdoConfigurator::answeredRead(const fieldbus::Transfer& transfer) {
  if (phase_ == Phase::read_cob_id) return answeredCobId(transfer);
  if (phase_ == Phase::read_parameter) return answeredParameter(transfer);
  if (phase_ == Phase::probe_entry) return answeredProbe(transfer);
  if (!transfer.ok()) return failTransfer(transfer);
  const auto value = static_cast<std::uint32_t>(toUnsigned(transfer.data()));
  if (phase_ == Phase::read_count) {
    return answeredCount(value);
  }
  entries_.push_back(value);
  if (entries_.size() < count_) return enter(Phase::read_entry, item_ + 1);
  leaveOutFillers();
  compare();
}

void PdoConfigurator::answeredCount(std::size_t count) {
  count_ = count;
  entries_.clear();
  if (options_.fixed_entries == 0) {
    // Entries need no look where their number differs already.
    if (count_ != wanted_.entries.size() || count_ == 0) return compare();
  } else if (count_ != options_.fixed_entries) {
    return fail(toString(ObjectId{mapping_, 0}) + " is " + std::to_string(count_) +
                ", but the profile says that it is always " +
                std::to_string(options_.fixed_entries) + " (pdo_rules/fixed_entries)");
  }
  enter(Phase::read_entry);
}

void PdoConfigurator::answeredCobId(const fieldbus::Transfer& transfer) {
  if (!transfer.ok()) {
    const bool answered = transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server;
    if (answered && options_.may_be_missing) return enter(Phase::done);
    if (leaveOutWhole(transfer)) return enter(Phase::done);
    return failTransfer(transfer);
  }
  cob_id_ = static_cast<std::uint32_t>(toUnsigned(transfer.data()));
  if (wanted_.enabled) {
    if (wanted_.cob_id == 0 && !adoptCobId()) {
      return fail("the drive's own COB-ID is to be used, but " + toString(transfer.object()) +
                  " is " + hex(cob_id_, 8) + ", which is none of 11 bits; configure a `cob_id`");
    }
    return enter(Phase::read_parameter);
  }
  if ((cob_id_ & kInvalidBit) != 0) return enter(Phase::done);
  if (verifying_) return fail("the drive did not disable it: COB-ID is still " + hex(cob_id_, 8));
  enter(Phase::disable);
}

/// @return false if what the drive has is no usable identifier.
bool PdoConfigurator::adoptCobId() {
  const std::uint32_t can_id = cob_id_ & kCanIdMask;
  if ((cob_id_ & kExtendedBit) != 0 || can_id == 0 || can_id > kMaxCanId) return false;
  wanted_.cob_id = static_cast<std::uint16_t>(can_id);
  adopted_ = wanted_.cob_id;
  return true;
}

/// The drive has a COB-ID that it does not give up: then that is the one, if it is valid.
bool PdoConfigurator::refusedCobId(const fieldbus::Transfer& transfer) {
  if (cob_id_fixed_ || !wanted_.enabled ||
      transfer.failure() != fieldbus::Transfer::Failure::aborted_by_server ||
      transfer.abortCode() != abort_code::kReadOnly) {
    return false;
  }
  const bool differs = (cob_id_ & kCanIdMask) != wanted_.cob_id;
  if (phase_ == Phase::enable && !differs) return false;  // it is the valid bit that is refused
  cob_id_fixed_ = true;
  return !differs || adoptCobId();
}

void PdoConfigurator::answeredParameter(const fieldbus::Transfer& transfer) {
  Parameter& parameter = parameters_[item_];
  if (transfer.ok()) {
    parameter.actual = static_cast<std::uint32_t>(toUnsigned(transfer.data()));
  } else if (transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server &&
             parameter.missing_is_zero && parameter.wanted == 0) {
    parameter.actual = 0;
  } else {
    return failTransfer(transfer);
  }
  if (item_ + 1 < parameters_.size()) return enter(Phase::read_parameter, item_ + 1);
  enter(Phase::read_count);
}

void PdoConfigurator::compare() {
  if (verifying_) return verify();
  if (firstDifference().empty()) return enter(Phase::done);
  if ((cob_id_ & kInvalidBit) == 0) return enter(Phase::disable);
  enterWrite();
}

void PdoConfigurator::enterAfterDisable() {
  if (!wanted_.enabled) return enterRead();
  enterWrite();
}

void PdoConfigurator::enterWrite() {
  if (!mapDiffers()) return enterWriteParameter(0);
  if (options_.fixed_entries == 0) return enter(Phase::clear_map);
  // The last first: at no time are there more than 64 bits, or a gap.
  if (count_ != 0) return enter(Phase::clear_entry, count_ - 1);
  enterEntries();
}

void PdoConfigurator::enterEntries() {
  if (!wanted_.entries.empty()) return enter(Phase::write_entry);
  enterWriteParameter(0);
}

void PdoConfigurator::answeredWrite(const fieldbus::Transfer& transfer) {
  const bool cob_id = phase_ == Phase::disable || phase_ == Phase::enable;
  if (!transfer.ok() && cob_id) {
    const bool was_disabled = phase_ == Phase::enable;
    if (!refusedCobId(transfer)) return failTransfer(transfer);
    if (was_disabled) return enter(Phase::enable);  // now with the drive's own
    return enterAfterDisable();
  }
  if (!transfer.ok()) {
    if (leaveOutEntry(transfer) || probeEntries(transfer) || leaveOutRider(transfer)) return;
    if (!refusedReadOnlyCount(transfer)) return failTransfer(transfer);
    map_refused_ = true;
  }
  switch (phase_) {
    case Phase::disable:
      return enterAfterDisable();
    case Phase::clear_map:
      return enterEntries();
    case Phase::clear_entry:
      return item_ == 0 ? enterEntries() : enter(Phase::clear_entry, item_ - 1);
    case Phase::write_entry:
      if (item_ + 1 < wanted_.entries.size()) return enter(Phase::write_entry, item_ + 1);
      return afterEntries();
    case Phase::write_count:
      return enterWriteParameter(0);
    case Phase::write_parameter:
      return enterWriteParameter(item_ + 1);
    default:  // enable: all is written
      return enterRead();
  }
}

/// All entries are written, or there are none left.
void PdoConfigurator::afterEntries() {
  if (!wanted_.entries.empty()) {
    if (!map_refused_ && options_.fixed_entries == 0) return enter(Phase::write_count);
    return enterWriteParameter(0);
  }
  wanted_.enabled = false;  // it is invalid already, and stays so
  enterRead();
}

bool PdoConfigurator::refusedReadOnlyCount(const fieldbus::Transfer& transfer) const {
  return options_.count_may_be_read_only &&
         transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server &&
         transfer.abortCode() == abort_code::kReadOnly &&
         transfer.object() == ObjectId{mapping_, 0};
}

void PdoConfigurator::enterWriteParameter(std::size_t item) {
  while (item < parameters_.size() && parameters_[item].actual == parameters_[item].wanted) ++item;
  if (item < parameters_.size()) return enter(Phase::write_parameter, item);
  if (cob_id_fixed_) return enterRead();  // it never became invalid
  enter(Phase::enable);
}

void PdoConfigurator::enterRead() {
  verifying_ = true;
  enter(Phase::read_cob_id);
}

void PdoConfigurator::enter(Phase phase, std::size_t item) {
  phase_ = phase;
  item_ = item;
}

void PdoConfigurator::fail(const std::string& reason) {
  error_ = title() + ": " + reason;
  phase_ = Phase::failed;
}

void PdoConfigurator::failTransfer(const fieldbus::Transfer& transfer) {
  timed_out_ = transfer.failure() != fieldbus::Transfer::Failure::aborted_by_server;
  if (!timed_out_) abort_code_ = transfer.abortCode();
  std::string reason = step_ + ": " + transfer.reason();
  if (transfer.abortCode() == abort_code::kReadOnly && transfer.object().index == mapping_ &&
      transfer.object().subindex == 0) {
    reason += "; if the drive's number of entries is fixed, say so in its profile";
  } else if (phase_ == Phase::read_cob_id &&
             transfer.failure() == fieldbus::Transfer::Failure::aborted_by_server) {
    reason += "; the drive has no such PDO, use another number";
  } else if (phase_ == Phase::write_entry && abort_code_ == abort_code::kNotMappable &&
             (cob_id_ & kCanIdMask) != wanted_.cob_id) {
    // maxon EPOS4 takes a COB-ID that it cannot have, and refuses the mapping for it.
    reason += "; if it can be mapped, the cause may be that " +
              toString(ObjectId{communication_, 1}) + " still holds the COB-ID " +
              hex(cob_id_ & kCanIdMask, 8) +
              ": write a valid one there first, or restore the drive's parameters (1011h)";
  } else if (phase_ == Phase::write_count && !timed_out_) {
    // Drives check the entries when they are written, or all of them only now.
    for (std::size_t i = 0; i < wanted_.entries.size(); ++i) {
      reason += (i == 0 ? "; one of these cannot be mapped: " : ", ") + entryName(i);
    }
  }
  fail(reason);
}

}  // namespace cia402::canopen
