// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The simulated DM5: what its manual says beside CiA 402.
#include "drive_fixture.h"

namespace cia402::sim {
namespace {

struct Dm5Bench : DriveBench {
  Dm5Bench() : DriveBench("megmeet_dm5", AxisMechanics()) {
    run(ms(1500));
    write(0x6072, 0, 1000, 2);
    write(0x60E0, 0, 1000, 2);
    write(0x60E1, 0, 1000, 2);
    write(0x607F, 0, 0x7FFFFFFF, 4);
    write(0x6080, 0, 3000, 4);
    write(0x6083, 0, 0x10000000, 4);
    write(0x6084, 0, 0x10000000, 4);
    write(0x6060, 0, 3, 1);
  }
};

// Er.073 beyond 100 rpm [L3781].
TEST(DriveDm5, IsNotEnabledWhileItsMotorTurnsFasterThan100Rpm) {
  Dm5Bench b;
  b.enable();
  b.run(ms(600));
  b.write(0x60FF, 0, 10 * 8388608, 4);  // 600 rpm
  b.run(ms(800));
  ASSERT_GT(b.drive->truth(b.now).velocity_turns, 9.0);
  b.control(0x0000);  // disable voltage: it coasts
  b.write(0x60FF, 0, 0, 4);
  b.control(0x0006);
  b.control(0x0007);
  ASSERT_GT(b.drive->truth(b.now).velocity_turns, 100.0 / 60.0);
  b.control(0x000F);
  EXPECT_FALSE(b.drive->truth(b.now).power_stage_on);
  EXPECT_EQ(b.read(0x603F) & 0xFFFFU, 0xFF49U);
  b.run(ms(60000));
  ASSERT_LT(b.drive->truth(b.now).velocity_turns, 100.0 / 60.0);
  b.control(0x0000);
  b.control(0x0080);
  b.control(0x0000);
  b.enable();
  EXPECT_TRUE(b.drive->truth(b.now).power_stage_on);
}

}  // namespace
}  // namespace cia402::sim
