// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/configurator.h"

#include <utility>

#include "common/text.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

using fieldbus::Transfer;

constexpr unsigned kMaxPdoBits = 64;

bool isAborted(const Transfer& transfer) {
  return transfer.failure() == Transfer::Failure::aborted_by_server;
}

/// 0x06040041 and what drives answer instead of it.
bool isMissingOrUnmappable(const Transfer& transfer) {
  const std::uint32_t code = transfer.abortCode();
  return isAborted(transfer) &&
         (code == abort_code::kNoSuchObject || code == abort_code::kNoSuchSubindex ||
          code == abort_code::kNotMappable);
}

std::uint32_t numberOf(const Transfer& transfer) {
  return static_cast<std::uint32_t>(toUnsigned(transfer.data()));
}

}  // namespace

PdoConfigurator::PdoConfigurator(SdoClient& sdo, const PdoConfig& wanted, Options options)
    : sdo_(sdo), options_(options), wanted_(wanted), found_(wanted_) {}

PdoConfigurator::Status PdoConfigurator::advance() {
  if (!ticket_ && phase_ == Phase::read_cob_id) {
    const std::string impossible = impossibility();
    if (impossible.empty()) {
      ask();
    } else {
      fail(impossible);
    }
  }
  while (ticket_ && ticket_->done()) {
    const SdoTicket finished = std::exchange(ticket_, {});
    if (finished->direction() == Transfer::Direction::upload) {
      answeredRead(*finished);
    } else {
      answeredWrite(*finished);
    }
    if (phase_ != Phase::done && phase_ != Phase::failed) ask();
  }
  if (phase_ == Phase::failed) return Status::failed;
  return phase_ == Phase::done ? Status::done : Status::running;
}

/// Why no drive can hold what is wanted; empty if one may.
std::string PdoConfigurator::impossibility() const {
  const unsigned number = wanted_.config().number, bits = wanted_.bits();
  if (number < 1 || number > 512) return "there is no PDO of this number, 1..512 are allowed";
  if (bits > kMaxPdoBits) {
    return "its entries have " + std::to_string(bits) + " bits, 64 fit in a PDO";
  }
  if (options_.fixed_entries != 0 && wanted_.size() > options_.fixed_entries) {
    return "it has " + std::to_string(wanted_.size()) + " entries, the drive has room for " +
           std::to_string(options_.fixed_entries);
  }
  return {};
}

void PdoConfigurator::ask() {
  const auto n = static_cast<std::uint8_t>(item_ + 1);
  const std::uint16_t communication = wanted_.communication(), mapping = wanted_.mapping();
  switch (phase_) {
    case Phase::read_cob_id:
      return read({communication, 1}, "COB-ID");
    case Phase::read_parameter: {
      const PdoParameter& parameter = found_.parameters()[item_];
      return read({communication, parameter.subindex}, parameter.name);
    }
    case Phase::read_count:
      return read({mapping, 0}, "number of entries");
    case Phase::read_entry:
      return read({mapping, n}, "entry " + std::to_string(n));
    case Phase::disable:
      return write({communication, 1}, found_.cobId() | kInvalidBit, 4, "COB-ID");
    case Phase::clear_map:
      return write({mapping, 0}, 0, 1, "number of entries");
    case Phase::clear_entry:
      return write({mapping, n}, 0, 4, "entry " + std::to_string(n));
    case Phase::write_entry:
      return write({mapping, n}, wanted_.entryValue(item_), 4, wanted_.entryName(item_));
    case Phase::write_count:
      return write({mapping, 0}, static_cast<std::uint32_t>(wanted_.size()), 1,
                   "number of entries");
    case Phase::probe_entry:
      return read(wanted_.config().entries[item_].object, wanted_.entryName(item_));
    case Phase::write_parameter: {
      const PdoParameter& parameter = found_.parameters()[item_];
      return write({communication, parameter.subindex}, parameter.wanted, parameter.size,
                   parameter.name);
    }
    case Phase::enable:
      return write({communication, 1}, found_.enabledCobId(wanted_), 4, "COB-ID");
    case Phase::done:
    case Phase::failed:
      return;
  }
}

void PdoConfigurator::read(ObjectId object, const std::string& name) {
  const std::string full_name = name + " of " + wanted_.title();
  step_ = (verifying_ ? "reading back " : "reading ") + toString(object) + " " + full_name;
  const bool may_lack =
      phase_ == Phase::probe_entry ||
      (phase_ == Phase::read_parameter && found_.parameters()[item_].mayBeMissing()) ||
      (phase_ == Phase::read_cob_id && (options_.may_be_missing || wanted_.allOptional()));
  ticket_ = sdo_.upload(object, full_name, may_lack ? options_.if_there : std::nullopt);
}

void PdoConfigurator::write(ObjectId object, std::uint32_t value, unsigned size,
                            const std::string& name) {
  changed_ = true;
  const std::string full_name = name + " of " + wanted_.title();
  step_ = "writing " + hexText(value, static_cast<int>(2 * size)) + " to " + toString(object) +
          " " + full_name;
  const bool may_lack = (phase_ == Phase::write_entry && wanted_.mayLack(item_)) ||
                        (phase_ == Phase::write_count && wanted_.anyOptional());
  ticket_ = sdo_.download(object, toBytes(value, size), full_name,
                          may_lack ? options_.if_there : std::nullopt);
}

void PdoConfigurator::answeredRead(const Transfer& transfer) {
  if (phase_ == Phase::read_cob_id) return answeredCobId(transfer);
  if (phase_ == Phase::read_parameter) return answeredParameter(transfer);
  if (phase_ == Phase::probe_entry) return answeredProbe(transfer);
  if (!transfer.ok()) return failTransfer(transfer);
  if (phase_ == Phase::read_count) return answeredCount(numberOf(transfer));
  found_.addEntry(numberOf(transfer));
  if (!found_.hasAllEntries()) return enter(Phase::read_entry, item_ + 1);
  if (options_.fixed_entries != 0) found_.leaveOutFillers();
  compare();
}

void PdoConfigurator::answeredCobId(const Transfer& transfer) {
  if (!transfer.ok()) {
    if (isAborted(transfer) && options_.may_be_missing) return enter(Phase::done);
    if (!isMissingOrUnmappable(transfer) || !wanted_.allOptional()) return failTransfer(transfer);
    wanted_.leaveOutAll();
    return enter(Phase::done);
  }
  found_.setCobId(numberOf(transfer));
  if (wanted_.config().enabled) {
    if (wanted_.config().cob_id == 0 && !wanted_.adopt(found_.cobId())) {
      return fail("the drive's own COB-ID is to be used, but " + toString(transfer.object()) +
                  " is " + hexText(found_.cobId(), 8) +
                  ", which is none of 11 bits; configure a `cob_id`");
    }
    return enter(Phase::read_parameter);
  }
  if (found_.isInvalid()) return enter(Phase::done);
  if (verifying_) {
    return fail("the drive did not disable it: COB-ID is still " + hexText(found_.cobId(), 8));
  }
  enter(Phase::disable);
}

void PdoConfigurator::answeredParameter(const Transfer& transfer) {
  PdoParameter& parameter = found_.parameters()[item_];
  if (transfer.ok()) {
    parameter.actual = numberOf(transfer);
  } else if (isAborted(transfer) && parameter.mayBeMissing()) {
    parameter.actual = 0;
  } else {
    return failTransfer(transfer);
  }
  if (item_ + 1 < found_.parameters().size()) return enter(Phase::read_parameter, item_ + 1);
  enter(Phase::read_count);
}

void PdoConfigurator::answeredCount(std::size_t count) {
  found_.setCount(count);
  if (options_.fixed_entries == 0) {
    // Entries need no look where their number differs already.
    if (count != wanted_.size() || count == 0) return compare();
  } else if (count != options_.fixed_entries) {
    return fail(toString(ObjectId{wanted_.mapping(), 0}) + " is " + std::to_string(count) +
                ", but the profile says that it is always " +
                std::to_string(options_.fixed_entries) + " (pdo_rules/fixed_entries)");
  }
  enter(Phase::read_entry);
}

void PdoConfigurator::compare() {
  if (verifying_) return verify();
  if (found_.firstDifference(wanted_, options_.fixed_entries != 0).empty()) {
    return enter(Phase::done);
  }
  if (!found_.isInvalid()) return enter(Phase::disable);
  enterWrite();
}

void PdoConfigurator::verify() {
  const std::string difference = found_.firstDifference(wanted_, options_.fixed_entries != 0);
  if (difference.empty()) return enter(Phase::done);
  std::string reason = "the drive took all writes, but " + difference;
  if (map_refused_) {
    reason = "the drive refuses to change the number of mapped objects (" +
             toString(ObjectId{wanted_.mapping(), 0}) + " is read-only), and " + difference;
  }
  fail(reason + "; choose a mapping that the drive can hold");
}

void PdoConfigurator::answeredWrite(const Transfer& transfer) {
  if (phase_ == Phase::disable || phase_ == Phase::enable) return answeredCobIdWrite(transfer);
  if (!transfer.ok()) {
    if (leaveOutEntry(transfer) || probeEntries(transfer) || leaveOutRider(transfer)) return;
    if (!refusedReadOnlyCount(transfer)) return failTransfer(transfer);
    map_refused_ = true;
  }
  switch (phase_) {
    case Phase::clear_map:
      return enterEntries();
    case Phase::clear_entry:
      return item_ == 0 ? enterEntries() : enter(Phase::clear_entry, item_ - 1);
    case Phase::write_entry:
      if (item_ + 1 < wanted_.size()) return enter(Phase::write_entry, item_ + 1);
      return afterEntries();
    case Phase::write_count:
      return enterWriteParameter(0);
    default:
      return enterWriteParameter(item_ + 1);
  }
}

void PdoConfigurator::answeredCobIdWrite(const Transfer& transfer) {
  const bool was_disabled = phase_ == Phase::enable;
  if (transfer.ok()) return was_disabled ? enterRead() : enterAfterDisable();
  if (!refusedCobId(transfer)) return failTransfer(transfer);
  if (was_disabled) return enter(Phase::enable);  // now with the drive's own
  enterAfterDisable();
}

/// The drive has a COB-ID that it does not give up: then that is the one, if it is valid.
bool PdoConfigurator::refusedCobId(const Transfer& transfer) {
  if (cob_id_fixed_ || !wanted_.config().enabled || !isAborted(transfer) ||
      transfer.abortCode() != abort_code::kReadOnly) {
    return false;
  }
  const bool differs = (found_.cobId() & kCanIdMask) != wanted_.config().cob_id;
  if (phase_ == Phase::enable && !differs) return false;  // it is the valid bit that is refused
  cob_id_fixed_ = true;
  return !differs || wanted_.adopt(found_.cobId());
}

void PdoConfigurator::enter(Phase phase, std::size_t item) {
  phase_ = phase;
  item_ = item;
}

void PdoConfigurator::enterAfterDisable() {
  if (!wanted_.config().enabled) return enterRead();
  enterWrite();
}

void PdoConfigurator::enterWrite() {
  if (!found_.mapDiffers(wanted_)) return enterWriteParameter(0);
  if (options_.fixed_entries == 0) return enter(Phase::clear_map);
  // The last first: at no time are there more than 64 bits, or a gap.
  if (found_.count() != 0) return enter(Phase::clear_entry, found_.count() - 1);
  enterEntries();
}

void PdoConfigurator::enterEntries() {
  if (!wanted_.empty()) return enter(Phase::write_entry);
  enterWriteParameter(0);
}

/// All entries are written, or there are none left.
void PdoConfigurator::afterEntries() {
  if (!wanted_.empty()) {
    if (!map_refused_ && options_.fixed_entries == 0) return enter(Phase::write_count);
    return enterWriteParameter(0);
  }
  wanted_.disable();  // it is invalid already, and stays so
  enterRead();
}

void PdoConfigurator::enterWriteParameter(std::size_t item) {
  item = found_.nextToWrite(item);
  if (item < found_.parameters().size()) return enter(Phase::write_parameter, item);
  if (cob_id_fixed_) return enterRead();  // it never became invalid
  enter(Phase::enable);
}

void PdoConfigurator::enterRead() {
  verifying_ = true;
  enter(Phase::read_cob_id);
}

bool PdoConfigurator::refusedReadOnlyCount(const Transfer& transfer) const {
  return options_.count_may_be_read_only && isAborted(transfer) &&
         transfer.abortCode() == abort_code::kReadOnly &&
         transfer.object() == ObjectId{wanted_.mapping(), 0};
}

/// Most drives judge an entry when it is written.
bool PdoConfigurator::leaveOutEntry(const Transfer& transfer) {
  if (phase_ != Phase::write_entry) return false;
  const PdoEntry& entry = wanted_.config().entries[item_];
  const bool goes =
      entry.if_room ? isAborted(transfer) : entry.optional && isMissingOrUnmappable(transfer);
  if (!goes) return false;
  wanted_.leaveOut(item_);  // the next one has its place then
  if (item_ == wanted_.size()) afterEntries();
  return true;
}

/// Others judge all of them at the end, without a word about which one is wrong: those that it does
/// not have are found by reading them.
bool PdoConfigurator::probeEntries(const Transfer& transfer) {
  if (phase_ != Phase::write_count || !isMissingOrUnmappable(transfer)) return false;
  if (!wanted_.anyOptional()) return false;
  left_out_before_probe_ = leftOut().size();
  enter(Phase::probe_entry, wanted_.nextOptional(0));
  return true;
}

void PdoConfigurator::answeredProbe(const Transfer& transfer) {
  if (!transfer.ok() && !isAborted(transfer)) return failTransfer(transfer);
  std::size_t next = item_ + 1;
  if (!transfer.ok() && isMissingOrUnmappable(transfer)) wanted_.leaveOut(next = item_);
  next = wanted_.nextOptional(next);
  if (next < wanted_.size()) return enter(Phase::probe_entry, next);
  // It has them all: the last one goes.
  if (leftOut().size() == left_out_before_probe_) wanted_.leaveOut(wanted_.lastOptional());
  if (wanted_.empty()) return afterEntries();
  enter(Phase::clear_map);
}

/// A PDO that the drive does not take as a whole may be one without what is there for the room
/// only.
bool PdoConfigurator::leaveOutRider(const Transfer& transfer) {
  const std::optional<std::size_t> rider = wanted_.rider();
  const bool refused = phase_ == Phase::write_count && isAborted(transfer);
  if (!refused || !rider || refusedReadOnlyCount(transfer)) return false;
  wanted_.leaveOut(*rider);
  if (wanted_.empty()) {
    afterEntries();
  } else {
    enter(Phase::clear_map);
  }
  return true;
}

void PdoConfigurator::fail(const std::string& reason) {
  error_ = wanted_.title() + ": " + reason;
  phase_ = Phase::failed;
}

void PdoConfigurator::failTransfer(const Transfer& transfer) {
  timed_out_ = !isAborted(transfer);
  if (!timed_out_) abort_code_ = transfer.abortCode();
  fail(step_ + ": " + transfer.reason() + advice(transfer));
}

/// What may be the cause of a failed transfer and what to do, behind a semicolon; or nothing.
std::string PdoConfigurator::advice(const Transfer& transfer) const {
  const std::uint32_t can_id = found_.cobId() & kCanIdMask;
  if (transfer.abortCode() == abort_code::kReadOnly &&
      transfer.object() == ObjectId{wanted_.mapping(), 0}) {
    return "; if the drive's number of entries is fixed, say so in its profile";
  }
  if (phase_ == Phase::read_cob_id && isAborted(transfer)) {
    return "; the drive has no such PDO, use another number";
  }
  if (phase_ == Phase::write_entry && abort_code_ == abort_code::kNotMappable &&
      can_id != wanted_.config().cob_id) {
    // maxon EPOS4 takes a COB-ID that it cannot have, and refuses the mapping for it.
    return "; if it can be mapped, the cause may be that " +
           toString(ObjectId{wanted_.communication(), 1}) + " still holds the COB-ID " +
           hexText(can_id, 8) +
           ": write a valid one there first, or restore the drive's parameters (1011h)";
  }
  if (phase_ != Phase::write_count || timed_out_) return {};
  // Drives check the entries when they are written, or all of them only now.
  std::string entries;
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    entries += (i == 0 ? "; one of these cannot be mapped: " : ", ") + wanted_.entryName(i);
  }
  return entries;
}

}  // namespace cia402::canopen
