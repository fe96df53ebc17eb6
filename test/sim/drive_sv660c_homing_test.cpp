// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Home offset and hard stops of the simulated SV660C. Lnnn: lines of the manual's text.
#include <algorithm>
#include <cstdlib>

#include "sv660c_bench.h"

namespace cia402::sim {
namespace {

struct Sv660cOffset : Sv660cBench {
  double turns() { return bench.drive->truth(bench.now).position_turns; }
  /// Method 35: here, without moving [L1745-1757].
  void home() {
    bench.write(0x6098, 0, 35, 1);
    mode(6);
    enable();
    control(0x0F);
    control(0x1F);
    bench.run(ms(5));
    control(0x00);
  }
  void cyclePower() {
    bench.drive->powerOff(bench.now);
    bench.drive->powerOn(bench.now);
    bench.run(ms(700));
  }
};

// 607Ch counts where home was found since the power came, with bit 15 [L15530].
TEST_F(Sv660cOffset, ThatIsWrittenLaterMovesTheCoordinatesOnceItHasHomed) {
  bench.write(0x607C, 0, 1000, 4);
  EXPECT_EQ(bench.position(), 0) << "not homed";
  home();
  EXPECT_EQ(bench.position(), 1000);
  bench.write(0x607C, 0, 5000, 4);
  EXPECT_EQ(bench.position(), 5000);
  bench.write(0x607C, 0, static_cast<std::uint32_t>(-70), 4);
  EXPECT_EQ(bench.position(), -70);
  EXPECT_EQ(turns(), 0.0) << "nothing moves";
  cyclePower();
  bench.write(0x607C, 0, 5000, 4);
  EXPECT_EQ(bench.position(), 0) << "not homed since";
}

// H02.01 = 1: bit 15 stays without power, but the search was before it [L15530].
TEST_F(Sv660cOffset, DoesNotCountByAHomeFromBeforeThePowerWentAway) {
  bench.write(0x2002, 2, 1, 2);
  cyclePower();
  home();
  bench.write(0x607C, 0, 300, 4);
  EXPECT_EQ(bench.position(), 300);
  cyclePower();
  ASSERT_NE(bench.read(0x6041) & 0x8000, 0U);
  EXPECT_EQ(bench.position(), 300) << "the encoder knows";
  bench.write(0x607C, 0, 900, 4);
  EXPECT_EQ(bench.position(), 300);
}

// 60E6h = 1: 607Ch is added to what was read [L1756-1757].
TEST_F(Sv660cOffset, IsAddedWhere60E6hSaysSo) {
  mode(1);
  enable();
  bench.write(0x607A, 0, 838861, 4);
  control(0x1F);
  bench.run(ms(2000));
  ASSERT_EQ(bench.position(), 838861);
  control(0x00);
  bench.write(0x60E6, 0, 1, 1);
  bench.write(0x607C, 0, 1000, 4);
  const double at = turns();
  home();
  EXPECT_EQ(bench.position(), 839861);
  EXPECT_NEAR(turns(), at, 1e-9);
  bench.write(0x60E6, 0, 0, 1);
  home();
  EXPECT_EQ(bench.position(), 1000);
}

// "E09.1" where 607Ch is set outside 607Dh [L15534].
TEST_F(Sv660cOffset, OutsideThePositionLimitsIsAFault) {
  bench.write(0x607D, 1, static_cast<std::uint32_t>(-1000), 4);
  bench.write(0x607D, 2, 1000, 4);
  for (const std::int32_t offset : {1000, -1000, 0}) {
    bench.write(0x607C, 0, static_cast<std::uint32_t>(offset), 4);
    EXPECT_EQ(word(), 0x0250) << offset;
  }
  for (const std::int32_t offset : {1001, -1001}) {
    bench.write(0x607C, 0, static_cast<std::uint32_t>(offset), 4);
    EXPECT_EQ(word(), 0x0218) << offset;
    EXPECT_EQ(bench.read(0x603F), 0xFF00U);
    EXPECT_EQ(bench.read(0x203F) & 0xFFFF, 0x0E09U);
    control(0x80);
    control(0x00);
    EXPECT_EQ(word(), 0x0250);
  }
  home();
  EXPECT_EQ(word(), 0x0218) << "it counts from now on";
}

// H05.58 is the greatest torque of either sign while it searches a hard stop [L5551-5555].
TEST(Sv660cHardStopTorque, BoundsTheMotorWhileItSearchesAlone) {
  AxisMechanics mechanics;
  mechanics.negative_stop = -0.5;
  DriveBench bench("sv660c", mechanics);
  bench.run(ms(700));
  bench.write(0x2005, 0x3B, 300, 2);  // 30.0 %
  bench.write(0x6098, 0, 0xFF, 1);    // -1
  bench.write(0x6060, 0, 6, 1);
  bench.enable();
  bench.run(ms(300));
  const auto number = [&](std::uint16_t index) {
    return static_cast<std::int16_t>(bench.drive->dictionary().find({index, 0})->number);
  };
  bench.control(0x1F);
  int most = 0;
  for (int i = 0; i < 20000 && (number(0x6041) & 0x1000) == 0; ++i) {
    bench.run(ms(0.5));
    most = std::max(most, std::abs(int{number(0x6077)}));
  }
  EXPECT_NE(number(0x6041) & 0x1000, 0) << "home was found";
  EXPECT_EQ(most, 300);
  bench.write(0x6060, 0, 4, 1);  // pt
  bench.write(0x6071, 0, 1000, 2);
  bench.run(ms(20));
  EXPECT_GT(number(0x6077), 900) << "afterwards it does not";
}

}  // namespace
}  // namespace cia402::sim
