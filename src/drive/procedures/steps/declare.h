// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "drive/procedures/procedure.h"

namespace cia402::drive {

/// Declares what the present position reads, at standstill. A position that the drive would still
/// go to by itself is given up first. The position limits in the drive
/// follow: they are opened first and closed around the new zero afterwards, so that an enabled
/// drive finds its target within them at any time. Where it does not let go of those that it has,
/// nothing is declared.
class DeclareStep {
 public:
  /// @param what for messages: "declaring the position"
  DeclareStep(double position, std::string what) : position_(position), what_(std::move(what)) {}
  Outcome advance(const Context& context);
  /// What a person must know besides; empty: nothing.
  const std::string& remark() const { return remark_; }
  double before() const { return before_; }  ///< what the position read

 private:
  enum class Phase { standing, giving_up, opening, declaring, closing };
  Outcome open(const Context& context);
  Outcome close(const Context& context);
  bool stands(const Context& context, Outcome& outcome);

  double position_, before_ = kUnknown;
  std::string what_, remark_;
  Phase phase_ = Phase::standing;
  Time since_ = kNever;
};

}  // namespace cia402::drive
