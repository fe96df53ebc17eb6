// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/digital_outputs.h"

#include <cmath>
#include <optional>

namespace cia402::sim {
namespace {

constexpr std::uint16_t kAlarmBits = 0x0088, kReachedBit = 0x0400;  // of the statusword
constexpr double kTurning = 1e-3;                                   // turns/s

struct OutputRoles {
  Role function;
  std::optional<Role> logic, used;
};
constexpr OutputRoles kOutputs[] = {
    {Role::output_1_function, Role::output_1_logic, Role::output_1_used},
    {Role::output_2_function, Role::output_2_logic, Role::output_2_used},
    {Role::output_3_function, {}, {}},
    {Role::output_4_function, {}, {}},
    {Role::output_5_function, {}, {}}};

bool bitOf(const DriveValues& values, Role role, std::uint32_t number) {
  return (static_cast<std::uint32_t>(values.raw(role, 0)) >> number & 1U) != 0;
}

bool isSo(OutputFunction function, const OutputSituation& situation) {
  switch (function) {
    case OutputFunction::alarm:
      return (situation.statusword & kAlarmBits) != 0;
    case OutputFunction::reached:
      return (situation.statusword & kReachedBit) != 0;
    case OutputFunction::holding:
      return situation.powered;
    case OutputFunction::turning:
      return std::fabs(situation.velocity) > kTurning;
  }
  return false;
}

/// The level of an output that is not commanded; low where its function is not simulated.
bool told(const DriveDefinition& definition, const DriveValues& values, const OutputRoles& output,
          const OutputSituation& situation) {
  const auto function = definition.outputs.functions.find(values.raw(output.function, 0));
  if (function == definition.outputs.functions.end()) return false;
  const bool active_high = !output.logic || values.raw(*output.logic, 1) != 0;
  return isSo(function->second, situation) == active_high;
}

}  // namespace

std::uint32_t outputsAtTerminals(const DriveDefinition& definition, const DriveValues& values,
                                 const OutputSituation& situation) {
  const std::int64_t mask = values.raw(Role::digital_outputs_mask, -1);
  const std::int64_t commanded = definition.outputs.commanded;
  const bool offline = situation.nmt != canopen::NmtState::operational;
  auto bits = static_cast<std::uint32_t>(values.raw(Role::digital_outputs, 0) & mask);
  std::uint32_t number = 0;
  for (const OutputRoles& output : kOutputs) {
    const std::uint32_t bit = 1U << (definition.outputs.first + number);
    const auto set = [&](bool on) { bits = on ? bits | bit : bits & ~bit; };
    if (values.raw(output.function, commanded) != commanded) {
      set(told(definition, values, output, situation));
    }
    if (offline && bitOf(values, Role::outputs_offline, number)) set(false);
    if (bitOf(values, Role::outputs_by_parameter, number)) {
      set(bitOf(values, Role::output_levels, number));
    }
    if (output.used && values.raw(*output.used, 1) == 0) set(false);
    ++number;
  }
  return bits;
}

}  // namespace cia402::sim
