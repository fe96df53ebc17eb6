// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/pdo/config.h"
#include "canopen/pdo/found.h"
#include "canopen/pdo/wanted.h"
#include "canopen/sdo/client.h"

namespace cia402::canopen {

/// Brings one PDO of a node to its wanted configuration, as CiA 301, 7.5.2.34..37 prescribe: make
/// it invalid (bit 31 of the COB-ID), number of entries 0, entries, number of entries, other
/// communication parameters, make it valid. Everything is read first; only what differs is written
/// and nothing at all where nothing differs; after writing everything is read back. Where the drive
/// says that its COB-ID is read-only (0x06010002), or none is wanted, the drive's own is kept.
/// Entries that are optional are left out where it says that it does not have or cannot map them; a
/// PDO of such entries alone may be missing.
class PdoConfigurator {
 public:
  struct Options {
    bool count_may_be_read_only = false;  ///< go on when sub-index 0 of the mapping is read-only
    /// Sub-index 0 of the mapping always says so many, and is not written; entries that are not
    /// used are 0, which is no object. 0: as CiA 301 says.
    std::size_t fixed_entries = 0;
    bool may_be_missing = false;  ///< a PDO that cannot be read is none of our business
    /// For what the drive need not have; absent: the SDO client's defaults.
    std::optional<SdoOptions> if_there;
  };
  enum class Status { running, done, failed };

  /// @param wanted with `enabled` false the PDO is only made invalid. @param sdo must outlive this.
  PdoConfigurator(SdoClient& sdo, const PdoConfig& wanted, Options options);

  /// Asks for the next object as soon as the last answer is there. Call first to begin, then after
  /// each SDO answer.
  Status advance();

  /// Which object is being read or written: "reading 1800:01 COB-ID of TPDO 1".
  const std::string& step() const { return step_; }
  /// Why it failed.
  const std::string& error() const { return error_; }
  /// It failed because the drive did not answer at all.
  bool timedOut() const { return timed_out_; }
  /// The abort code by which the drive made it fail; 0 if it was no abort.
  std::uint32_t abortCode() const { return abort_code_; }
  /// The COB-ID of the PDO is the drive's own, not the one configured: which.
  std::optional<std::uint16_t> adoptedCobId() const { return wanted_.adopted(); }
  /// The entries that are left out.
  const std::vector<PdoEntry>& leftOut() const { return wanted_.leftOut(); }
  /// True once something had to be written.
  bool changed() const { return changed_; }

 private:
  enum class Phase {
    read_cob_id,
    read_parameter,
    read_count,
    read_entry,
    disable,
    clear_map,
    clear_entry,  ///< instead, where their number is fixed
    write_entry,
    write_count,
    probe_entry,  ///< which of the optional ones is the one that the drive does not have?
    write_parameter,
    enable,
    done,
    failed,
  };

  std::string impossibility() const;
  void ask();
  void read(ObjectId object, const std::string& name);
  void write(ObjectId object, std::uint32_t value, unsigned size, const std::string& name);

  void answeredRead(const fieldbus::Transfer& transfer);
  void answeredCobId(const fieldbus::Transfer& transfer);
  void answeredParameter(const fieldbus::Transfer& transfer);
  void answeredCount(std::size_t count);
  void answeredProbe(const fieldbus::Transfer& transfer);
  void answeredWrite(const fieldbus::Transfer& transfer);
  void answeredCobIdWrite(const fieldbus::Transfer& transfer);
  void compare();
  void verify();

  void enter(Phase phase, std::size_t item = 0);
  void enterWrite();
  void enterAfterDisable();
  void enterEntries();
  void enterWriteParameter(std::size_t item);
  void enterRead();
  void afterEntries();

  bool refusedCobId(const fieldbus::Transfer& transfer);
  bool refusedReadOnlyCount(const fieldbus::Transfer& transfer) const;
  bool leaveOutEntry(const fieldbus::Transfer& transfer);
  bool probeEntries(const fieldbus::Transfer& transfer);
  bool leaveOutRider(const fieldbus::Transfer& transfer);

  void fail(const std::string& reason);
  void failTransfer(const fieldbus::Transfer& transfer);
  std::string advice(const fieldbus::Transfer& transfer) const;

  SdoClient& sdo_;
  Options options_;
  PdoWanted wanted_;
  PdoFound found_;

  Phase phase_ = Phase::read_cob_id;
  std::size_t item_ = 0;
  bool verifying_ = false, changed_ = false, map_refused_ = false, timed_out_ = false;
  std::uint32_t abort_code_ = 0;
  bool cob_id_fixed_ = false;  ///< the drive refuses to make the PDO invalid, or valid elsewhere
  std::size_t left_out_before_probe_ = 0;
  SdoTicket ticket_;
  std::string step_, error_;
};

}  // namespace cia402::canopen
