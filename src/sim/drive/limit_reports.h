// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "sim/definition/drive_definition.h"

namespace cia402::sim {

/// Which limits that were in the way the drive has told of.
class LimitReports {
 public:
  struct Seen {
    const char* name;  ///< of the fault, where there is none for each side
    bool in_the_way;
    bool there;  ///< the axis is not off it yet
    bool upwards;
  };
  /// What is to be done about it now; nullptr: nothing.
  struct Due {
    const FaultDefinition* raise = nullptr;
    const FaultDefinition* end = nullptr;  ///< a warning
  };
  /// One kind of limit, in a step.
  class Kind {
   public:
    Due look(const Seen& seen, const DriveDefinition& definition) {
      Due due;
      if (!seen.there) due.end = std::exchange(warning_, nullptr);
      const bool news = seen.in_the_way && !told_;
      told_ = seen.in_the_way;
      if (news) due.raise = faultOf(seen, definition);
      return due;
    }

   private:
    const FaultDefinition* faultOf(const Seen& seen, const DriveDefinition& definition);

    bool told_ = false;
    const FaultDefinition* warning_ = nullptr;
  };

  Kind switches, positions;
};

}  // namespace cia402::sim
