// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/digital_outputs.h"

namespace cia402::sim {
namespace {

constexpr Role kFunctions[] = {Role::output_1_function, Role::output_2_function,
                               Role::output_3_function, Role::output_4_function,
                               Role::output_5_function};

bool bitOf(const DriveValues& values, Role role, std::uint32_t number) {
  return (static_cast<std::uint32_t>(values.raw(role, 0)) >> number & 1U) != 0;
}

}  // namespace

std::uint32_t outputsAtTerminals(const DriveDefinition& definition, const DriveValues& values,
                                 canopen::NmtState nmt) {
  const std::int64_t mask = values.raw(Role::digital_outputs_mask, -1);
  const std::int64_t commanded = definition.commanded_output;
  auto bits = static_cast<std::uint32_t>(values.raw(Role::digital_outputs, 0) & mask);
  std::uint32_t number = 0;
  for (const Role function : kFunctions) {
    const std::uint32_t bit = 0x10000U << number;
    const bool offline = nmt != canopen::NmtState::operational;
    if (values.raw(function, commanded) != commanded) bits &= ~bit;
    if (offline && bitOf(values, Role::outputs_offline, number)) bits &= ~bit;
    if (bitOf(values, Role::outputs_by_parameter, number)) {
      bits = bitOf(values, Role::output_levels, number) ? bits | bit : bits & ~bit;
    }
    ++number;
  }
  return bits;
}

}  // namespace cia402::sim
