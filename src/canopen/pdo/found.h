// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/pdo/wanted.h"

namespace cia402::canopen {

/// A communication parameter beside the COB-ID.
struct PdoParameter {
  std::uint8_t subindex;
  unsigned size;  ///< bytes
  const char* name;
  std::uint32_t wanted;
  bool missing_is_zero;
  std::optional<std::uint32_t> actual;

  /// The drive need not have it.
  bool mayBeMissing() const { return missing_is_zero && wanted == 0; }
};

/// The configuration of one PDO as the drive was read to have it, and how it differs from the
/// wanted one.
class PdoFound {
 public:
  explicit PdoFound(const PdoWanted& wanted);

  /// Sub-index 1 of the communication parameters (CiA 301, 7.5.2.35).
  void setCobId(std::uint32_t cob_id) { cob_id_ = cob_id; }
  std::uint32_t cobId() const { return cob_id_; }
  bool isInvalid() const { return (cob_id_ & kInvalidBit) != 0; }
  /// What the COB-ID has to be for the PDO to be as wanted; whether a remote frame may ask for it
  /// remains the drive's own choice.
  std::uint32_t enabledCobId(const PdoWanted& wanted) const;

  /// In the order in which they are written.
  std::vector<PdoParameter>& parameters() { return parameters_; }
  /// The first from `item` on that differs, or the number of parameters.
  std::size_t nextToWrite(std::size_t item) const;

  /// Sub-index 0 of the mapping: what entries were known is void.
  void setCount(std::size_t count);
  /// The next entry of the mapping.
  void addEntry(std::uint32_t value) { entries_.push_back(value); }
  bool hasAllEntries() const { return entries_.size() >= count_; }
  /// Where the number of entries is fixed, those behind the last object are none.
  void leaveOutFillers();
  /// Entries in use.
  std::size_t count() const { return count_; }

  bool mapDiffers(const PdoWanted& wanted) const;
  /// "1800:01 is 0x..., wanted is 0x..."; empty if nothing differs. @param count_is_fixed the
  /// number of entries cannot be written
  std::string firstDifference(const PdoWanted& wanted, bool count_is_fixed) const;

 private:
  std::uint32_t cob_id_ = 0;
  std::vector<PdoParameter> parameters_;
  std::size_t count_ = 0;
  std::vector<std::uint32_t> entries_;
};

}  // namespace cia402::canopen
