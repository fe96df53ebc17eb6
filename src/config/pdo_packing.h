// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cia402::config {

/// Bits of a classic CAN data frame with an 11-bit identifier and `bytes` of data, the three bits
/// between frames included.
struct FrameBits {
  double nominal = 0.0;  ///< without stuff bits: 47 + 8n
  double worst = 0.0;    ///< with the most stuff bits there can be: 55 + 10n
};
FrameBits frameBits(unsigned bytes);
/// Of a remote frame, which has no data.
FrameBits remoteFrameBits();

/// An object that wants to travel by PDO.
struct PackItem {
  std::string name;
  unsigned bits = 0;   ///< 1..64
  unsigned every = 1;  ///< cycles after which it must have travelled again, >= 1
};

/// A PDO whose mapping the drive does not let anybody change.
struct FixedPdo {
  unsigned number = 1;
  std::vector<PackItem> items;  ///< all that it carries; `every` is of no account
};

/// What the drive allows in one direction.
struct PackRules {
  unsigned pdos = 4;       ///< how many there are, fixed ones included
  std::size_t most = 512;  ///< that may be used
  unsigned entries = 8;    ///< objects in one PDO
  std::vector<FixedPdo> fixed;
  /// A PDO may change in every cycle, however seldom it must travel (RPDOs): the worst case of its
  /// load counts every cycle.
  bool may_change_every_cycle = false;
};

/// One PDO of a packing.
struct PackedPdo {
  unsigned number = 1;
  unsigned every = 1;              ///< the least of its items
  std::vector<std::string> items;  ///< in the order of the mapping
};

/// Distributes `items` (most important first) over PDOs: each in exactly one free PDO or in one or
/// more fixed ones that are used, at most 64 bits and PackRules::entries in each. Of all ways the
/// one that loads the bus least in the worst case, then without stuff bits, then with the fewest
/// PDOs; of some ten items all ways are judged, of more as many as a bounded search comes to.
/// @return nothing if there is no way.
std::optional<std::vector<PackedPdo>> packPdos(const std::vector<PackItem>& items,
                                               const PackRules& rules);

}  // namespace cia402::config
