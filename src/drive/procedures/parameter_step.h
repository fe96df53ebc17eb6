// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "drive/procedures/procedure.h"

namespace cia402::drive {

/// Part of a procedure: has a drive save its parameters or restore those of the factory.
class ParameterStep {
 public:
  virtual ~ParameterStep() = default;
  /// To be called in every cycle until it is not running.
  virtual Outcome advance(const Context& context) = 0;
  /// What was saved or restored: "1010:01 (all parameters)".
  virtual std::string what() const = 0;
};

/// Why the parameters cannot be touched now; empty if they can. @param verb "save"
std::string parameterRefusal(AxisCore& axis, const std::string& verb);
/// The factory's values may hold another zero. What the device's memory holds is that of all axes.
void loseZeros(AxisCore& axis);

// By the family's own objects (ParameterRecipes):
std::unique_ptr<ParameterStep> makeSaveBySwitch();
std::unique_ptr<ParameterStep> makeRestoreByObject();
/// "initialise_parameters (2002:20) = 1: <what is lost by it>".
std::string restoreText(const DriveProfile& profile);

}  // namespace cia402::drive
