// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/canopen/pdo/config.h"
#include "cia402_driver/canopen/sdo/client.h"

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
  std::optional<std::uint16_t> adoptedCobId() const { return adopted_; }
  /// The entries that are left out.
  const std::vector<PdoEntry>& leftOut() const { return left_out_; }
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
  /// A communication parameter beside the COB-ID.
  struct Parameter {
    std::uint8_t subindex;
    unsigned size;  ///< bytes
    const char* name;
    std::uint32_t wanted;
    bool missing_is_zero;
    std::optional<std::uint32_t> actual;
  };

  void ask();
  void read(ObjectId object, const std::string& name);
  void write(ObjectId object, std::uint32_t value, unsigned size, const std::string& name);
  void answered(const fieldbus::Transfer& transfer);
  void answeredRead(const fieldbus::Transfer& transfer);
  void answeredCount(std::size_t count);
  void leaveOutFillers();
  void answeredCobId(const fieldbus::Transfer& transfer);
  void answeredParameter(const fieldbus::Transfer& transfer);
  void answeredWrite(const fieldbus::Transfer& transfer);
  void compare();
  void verify();
  void enter(Phase phase, std::size_t item = 0);
  void enterWrite();
  void enterEntries();
  void enterWriteParameter(std::size_t item);
  void enterRead();
  void fail(const std::string& reason);
  void failTransfer(const fieldbus::Transfer& transfer);
  bool adoptCobId();
  bool refusedCobId(const fieldbus::Transfer& transfer);
  void enterAfterDisable();
  bool refusedReadOnlyCount(const fieldbus::Transfer& transfer) const;
  bool leaveOutWhole(const fieldbus::Transfer& transfer);
  bool leaveOutEntry(const fieldbus::Transfer& transfer);
  bool probeEntries(const fieldbus::Transfer& transfer);
  bool leaveOutRider(const fieldbus::Transfer& transfer);
  void answeredProbe(const fieldbus::Transfer& transfer);
  void leaveOut(std::size_t item);
  void afterEntries();
  bool anyOptional() const { return nextOptional(0) < wanted_.entries.size(); }
  bool allOptional() const;
  /// The next optional entry from `item` on, or the number of entries.
  std::size_t nextOptional(std::size_t item) const;

  static std::string hex(std::uint32_t value, int digits);
  std::string title() const;
  std::uint32_t enabledCobId() const;
  std::uint32_t entryValue(std::size_t item) const;
  std::string entryName(std::size_t item) const;
  bool mapDiffers() const;
  std::string firstDifference() const;

  SdoClient& sdo_;
  PdoConfig wanted_;
  Options options_;
  std::uint16_t communication_;  ///< index of the communication parameters
  std::uint16_t mapping_;        ///< index of the mapping parameters
  std::vector<Parameter> parameters_;

  Phase phase_ = Phase::read_cob_id;
  std::size_t item_ = 0;
  bool verifying_ = false, changed_ = false, map_refused_ = false, timed_out_ = false;
  std::uint32_t abort_code_ = 0;
  std::uint32_t cob_id_ = 0;
  std::optional<std::uint16_t> adopted_;
  bool cob_id_fixed_ = false;  ///< the drive refuses to make the PDO invalid, or valid elsewhere
  std::size_t count_ = 0;      ///< entries in use
  std::vector<std::uint32_t> entries_;
  std::vector<PdoEntry> left_out_;
  std::size_t left_out_before_probe_ = 0;
  SdoTicket ticket_;
  std::string step_, error_;
};

}  // namespace cia402::canopen
