// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cia402::drive {

/// How set-points are handed to a drive one by one, by bits of the controlword (CiA 402-2, profile
/// position mode).
struct Handover {
  /// What becomes of ModeSpec::set_point_acknowledge_bit.
  enum class Acknowledge : std::uint8_t {
    none,   ///< there is no such bit
    level,  ///< it rises with the last word, and falls once the words are back at rest
    rise,   ///< it rises, but may stay set from then on
  };
  /// Bits beside those of the state machine and the mode: at rest, then those that hand a set-point
  /// over, one after the other. Empty: a written target counts at once.
  std::vector<std::uint16_t> words;
  Acknowledge acknowledge = Acknowledge::none;
  int each_for = 2;  ///< controlwords that each is sent in, at least; 1 to 10

  // Of what people command; what stops the axis counts at once (bit 5) and is absolute anyway.
  bool queued = false;  ///< the drive comes to rest at each before it goes on (bit 5 = 0)
  /// What counts at once is taken by a full queue, too, and replaces it; else the halt bit empties
  /// it.
  bool replaces_queue = false;
  /// What a set-point counts from.
  enum class From : std::uint8_t {
    zero,      ///< of the joint
    target,    ///< the set-point before (bit 6, 60F2h = 0)
    demand,    ///< where the drive's own set-points are (60F2h = 1)
    position,  ///< where the motor is (60F2h = 2)
  };
  From from = From::zero;
  bool relative() const { return from != From::zero; }
  /// Commands go to the drive one after the other: none replaces the one before.
  bool oneByOne() const { return queued || relative(); }
  /// The word `words[index]` of a command.
  std::uint16_t ofCommand(std::size_t index) const;
};
/// That of CiA 402-2: bit 5 is held (change at once), bit 4 hands over.
Handover standardHandover(bool acknowledged);

}  // namespace cia402::drive
