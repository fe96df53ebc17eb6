// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/pdo/config.h"

namespace cia402::canopen {

/// The wanted configuration of one PDO, as far as it has become clear that the drive cannot hold
/// all of it: entries leave, and the COB-ID may become the drive's own.
class PdoWanted {
 public:
  explicit PdoWanted(const PdoConfig& config) : config_(config) {}

  const PdoConfig& config() const { return config_; }
  /// "TPDO 2".
  std::string title() const;
  /// Index of its communication parameters, 1400h or 1800h and on (CiA 301, 7.5.2.34, 7.5.2.36).
  std::uint16_t communication() const;
  /// Index of its mapping parameters, 1600h or 1A00h and on (CiA 301, 7.5.2.35, 7.5.2.37).
  std::uint16_t mapping() const;
  /// A remote frame of the master asks for it.
  bool isRequestedTpdo() const;
  /// It is not to be valid after all.
  void disable() { config_.enabled = false; }

  /// Takes the COB-ID that the drive has. @param cob_id as sub-index 1 of the communication
  /// parameters holds it @return false if that is no identifier of 11 bits
  bool adopt(std::uint32_t cob_id);
  /// The drive's own COB-ID, if that was taken.
  std::optional<std::uint16_t> adopted() const { return adopted_; }

  /// Entries that are wanted still.
  std::size_t size() const { return config_.entries.size(); }
  bool empty() const { return config_.entries.empty(); }
  /// As the mapping holds it: index, sub-index and bits (CiA 301, 7.5.2.36). @pre item < size()
  std::uint32_t entryValue(std::size_t item) const;
  /// "entry 2 (6064:00 position_actual)". @pre item < size()
  std::string entryName(std::size_t item) const;
  /// Bits of all entries.
  unsigned bits() const;

  /// May the drive say that it does not have this entry, or not take it? @pre item < size()
  bool mayLack(std::size_t item) const;
  bool anyOptional() const { return nextOptional(0) < size(); }
  bool allOptional() const;
  /// The next optional entry from `item` on, or the number of entries.
  std::size_t nextOptional(std::size_t item) const;
  /// @pre anyOptional()
  std::size_t lastOptional() const;
  /// An entry that is there only because there was room; nothing if there is none.
  std::optional<std::size_t> rider() const;

  /// The entries behind it move up. @pre item < size()
  void leaveOut(std::size_t item);
  void leaveOutAll();
  /// The entries that have left, in their order of leaving.
  const std::vector<PdoEntry>& leftOut() const { return left_out_; }

 private:
  PdoConfig config_;
  std::optional<std::uint16_t> adopted_;
  std::vector<PdoEntry> left_out_;
};

/// Bits of a COB-ID that are the identifier (CiA 301, table 66).
inline constexpr std::uint32_t kCanIdMask = 0x1FFFFFFF;
/// Bit 31 of a COB-ID: the PDO does not exist.
inline constexpr std::uint32_t kInvalidBit = 0x80000000;

}  // namespace cia402::canopen
