// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "drive_fixture.h"

namespace cia402::sim {

/// The simulated SV660C, booted, at the factory's 1:1: 2^23 units a turn of its motor.
struct Sv660cBench : testing::Test {
  static constexpr std::uint32_t kInvalidValue = 0x06090030, kReadOnly = 0x06010002,
                                 kDeviceState = 0x08000022;
  DriveBench bench;
  explicit Sv660cBench(const AxisMechanics& mechanics = {}) : bench("sv660c", mechanics) {
    bench.run(ms(700));  // until it has booted
  }

  /// Bits 0 to 9 of 6041h, as the manual's table tells them; in `word` of an SDO answer.
  int word() { return static_cast<int>(bench.read(0x6041) & 0x3FF); }
  void mode(std::uint32_t number) { bench.write(0x6060, 0, number, 1); }
  /// Sends 6040h as its bytes.
  void control(std::uint8_t low, std::uint8_t high = 0) {
    ASSERT_EQ(bench.sdo({0x2B, 0x40, 0x60, 0x00, low, high, 0, 0}),
              (std::vector<std::uint8_t>{0x60, 0x40, 0x60, 0, 0, 0, 0, 0}));
  }
  void enable() {
    control(0x06);
    control(0x07);
    control(0x0F);
    bench.run(ms(300));  // H02.09
  }
  /// Enables pv, and waits until the motor turns evenly.
  void turnTwicePerSecond() {
    mode(3);
    enable();
    bench.write(0x60FF, 0, 16777216, 4);
    bench.run(ms(1500));
  }
};

}  // namespace cia402::sim
