// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drive/procedures/procedure.h"
#include "drive/profile/named_write.h"

namespace cia402::drive {

/// Looks how fast a drive would search for home by itself. Speeds that the axis' `homing` section
/// does not give are the drive's own (6099h): each is read and compared with the joint's limit; one
/// beyond it fails, and names object, number and remedy. What the drive does not have, or does not
/// let be read, is passed over.
class HomingSpeedStep {
 public:
  Outcome advance(const Context& context);

 private:
  struct Speed {
    const NamedWrite* write;
    const ObjectSpec* object;
    Conversion conversion;
  };
  void plan(const AxisConfig& axis);
  void add(const AxisConfig& axis, const NamedWrite& write);
  std::string excess(const AxisConfig& axis, const fieldbus::Transfer& answer) const;

  bool planned_ = false;
  std::vector<Speed> speeds_;
  std::size_t next_ = 0;
  fieldbus::Ticket ticket_;
};

}  // namespace cia402::drive
