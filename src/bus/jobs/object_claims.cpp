// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/object_claims.h"

#include <algorithm>

namespace cia402::bus {
namespace {

bool same(const ObjectClaims::Part& a, const ObjectClaims::Part& b) {
  return a.device == b.device && a.object == b.object && a.number == b.number;
}

}  // namespace

ObjectClaims::Claim ObjectClaims::take(const Part& part) {
  taken_.erase(std::remove_if(taken_.begin(), taken_.end(),
                              [](const auto& claim) { return claim.expired(); }),
               taken_.end());
  for (const auto& claim : taken_) {
    const Claim held = claim.lock();
    if (held != nullptr && same(*held, part)) return nullptr;
  }
  Claim claim = std::make_shared<const Part>(part);
  taken_.push_back(claim);
  return claim;
}

}  // namespace cia402::bus
