// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "drive/axis/axis.h"

namespace cia402::bus {

/// Changes some bits of an object and leaves the others as they are: reads it, then writes it.
/// Where it travels in the cycle its value there is changed, which the drive gets with the next
/// one.
/// @pre whoever does it has claimed the bits of the device (ObjectClaims)
class BitChange {
 public:
  /// Begins to read. @param axis, @param object must outlive it. @param mask bits that are changed;
  /// 0: it only reads. @param bits their new values
  BitChange(drive::Axis& axis, const drive::ObjectSpec& object, std::uint64_t mask,
            std::uint64_t bits);

  /// Begins to write once it was read. @return true once it has ended
  bool step();
  /// Valid once it has ended: "60FE:01 digital_outputs not read: the drive refused: ..."; empty: it
  /// was done.
  const std::string& problem() const { return problem_; }
  /// What the object held before. Valid once it was read.
  std::uint64_t found() const { return found_; }
  /// The drive may have got it.
  bool sent() const { return writing_ || travels(); }

 private:
  bool travels() const { return slot_ != fieldbus::kNoSlot; }

  drive::Axis* axis_;
  const drive::ObjectSpec* object_;
  fieldbus::Slot slot_;  ///< in the process image
  std::uint64_t mask_, bits_, found_ = 0;
  bool writing_ = false;
  fieldbus::Ticket ticket_;
  std::string problem_;
};

/// Why single bits of an object cannot be changed: the axis says that the drive lacks it, or it
/// travels in every cycle, which would undo the change. Empty: they can.
std::string bitsRefusal(drive::Axis& axis, const drive::ObjectSpec& object);

}  // namespace cia402::bus
