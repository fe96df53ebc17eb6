// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "fieldbus/device.h"

namespace cia402::bus {

/// Who has something of a device for himself. Whoever changes single bits of an object reads it and
/// writes it, and what somebody else wrote in between would be undone.
class ObjectClaims {
 public:
  /// What of a device.
  struct Part {
    const fieldbus::Device* device = nullptr;
    fieldbus::ObjectId object;  ///< {0, 0}: the bits of any
    unsigned number = 0;        ///< of what the object holds several of
  };
  /// Held until it is dropped.
  using Claim = std::shared_ptr<const Part>;

  /// nullptr: somebody else has it.
  Claim take(const Part& part);

 private:
  std::vector<std::weak_ptr<const Part>> taken_;
};

}  // namespace cia402::bus
