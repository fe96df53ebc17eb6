// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include "drive_fixture.h"
#include "sim/definition/drive_definition.h"

namespace cia402::sim {

/// Counts of a turn of its motor.
inline constexpr int kTurn = 131072;

/// The generic simulated drive; ramps 10 turns/s^2 by default.
struct GenericBench : DriveBench {
  /// @param with further keys of the simulated drive
  explicit GenericBench(const AxisMechanics& mechanics = {}, const YAML::Node& with = {})
      : DriveBench(
            loadDriveDefinition(
                cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml", with),
            mechanics) {}
  int bits(int mask) { return static_cast<int>(read(0x6041)) & mask; }
  void mode(int number) { write(0x6060, 0, static_cast<std::uint32_t>(number), 1); }
  void target(std::int32_t counts) { write(0x607A, 0, static_cast<std::uint32_t>(counts), 4); }
  std::int32_t demand() { return static_cast<std::int32_t>(read(0x6062)); }
  std::int32_t followingError() { return static_cast<std::int32_t>(read(0x60F4)); }
  // One cycle of a master: RPDO3 (controlword 0x000F, target), SYNC, 4 ms.
  void cycle(std::int32_t counts) {
    const auto raw = static_cast<std::uint32_t>(counts);
    frame(0x401, {0x0F, 0x00, low(raw), high(raw), low(raw >> 16), high(raw >> 16)});
    sync();
    run(ms(4));
  }
};

}  // namespace cia402::sim
