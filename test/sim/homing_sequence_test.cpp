// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Homing of the generic simulated drive. The axis, in motor turns:
//   negative limit at -2, home switch from 0.5 to 0.8, positive limit at 3, index at k + 0.25.
// Home positions below are read off the figures of CiA 402-2 by hand.
#include "homing_machine.h"

namespace cia402::sim {
namespace {

constexpr double kTurn = 131072.0;
constexpr int kOffset = 1000;  // 607Ch

struct Homing : DriveBench {
  explicit Homing(const AxisMechanics& mechanics) : DriveBench("generic_cia402", mechanics) {
    write(0x607C, 0, kOffset, 4);
    write(0x6060, 0, 6, 1);
    enable();
  }
  int bits() { return static_cast<int>(read(0x6041)) & 0x3400; }
  // Starts and waits for "completed" or "error".
  int home(int method) {
    write(0x6098, 0, static_cast<std::uint32_t>(method), 1);
    control(0x001F);
    lowest = highest = drive->truth(now).position_turns;
    for (int i = 0; i < 60000 && (status() & 0x0400) == 0; ++i) {
      run(ms(1));
      const double position = drive->truth(now).position_turns;
      lowest = std::min(lowest, position);
      highest = std::max(highest, position);
    }
    return bits();
  }
  double lowest = 0.0;
  double highest = 0.0;
};

struct Case {
  int method;
  double start;
  double home;   // turns
  int crossing;  // side on which it comes to rest
};

class HomingMethods : public testing::TestWithParam<Case> {};

TEST_P(HomingMethods, FindsTheHomePositionOfTheFigure) {
  const Case c = GetParam();
  Homing b(homingMachine(c.start));
  EXPECT_EQ(b.home(c.method), 0x1400);
  const double end = b.drive->truth(b.now).position_turns;
  EXPECT_NEAR(b.position(), kOffset + (end - c.home) * kTurn, 0.6);
  if (c.crossing == 0) {
    EXPECT_EQ(end, c.home);
  } else {
    EXPECT_GT((end - c.home) * c.crossing, 0.0);
    EXPECT_LT(std::abs(end - c.home), 0.07);  // 1 turn/s, 10 turns/s^2
  }
}

INSTANTIATE_TEST_SUITE_P(
    Standard, HomingMethods,
    testing::Values(
        Case{1, 0.6, -1.75, +1}, Case{2, 0.6, 2.25, -1}, Case{3, -1, 0.25, -1},
        Case{3, 0.6, 0.25, -1}, Case{4, -1, 1.25, +1}, Case{4, 0.6, 1.25, +1}, Case{5, 2, 1.25, +1},
        Case{5, 0.6, 1.25, +1}, Case{6, 2, 0.25, -1}, Case{6, 0.6, 0.25, -1}, Case{7, -1, 0.25, -1},
        Case{7, 2, 0.25, -1}, Case{8, -1, 1.25, +1}, Case{9, 2, 0.25, -1}, Case{10, 0.6, 1.25, +1},
        Case{11, 2, 1.25, +1}, Case{12, 0.6, 0.25, -1}, Case{13, -1, 1.25, +1},
        Case{14, 2, 0.25, -1}, Case{17, 0.6, -2, +1}, Case{17, -2.5, -2, +1}, Case{18, 0.6, 3, -1},
        Case{18, 3.5, 3, -1}, Case{19, -1, 0.5, -1}, Case{19, 0.6, 0.5, -1}, Case{20, -1, 0.5, +1},
        Case{20, 0.6, 0.5, +1}, Case{21, 2, 0.8, +1}, Case{21, 0.6, 0.8, +1}, Case{22, 2, 0.8, -1},
        Case{22, 0.6, 0.8, -1}, Case{23, -1, 0.5, -1}, Case{23, 0.6, 0.5, -1}, Case{23, 2, 0.5, -1},
        Case{24, -1, 0.5, +1}, Case{24, 0.6, 0.5, +1}, Case{24, 2, 0.5, +1}, Case{25, -1, 0.8, -1},
        Case{25, 0.6, 0.8, -1}, Case{25, 2, 0.8, -1}, Case{26, -1, 0.8, +1}, Case{26, 0.6, 0.8, +1},
        Case{26, 2, 0.8, +1}, Case{27, -1, 0.8, +1}, Case{27, 0.6, 0.8, +1}, Case{27, 2, 0.8, +1},
        Case{28, -1, 0.8, -1}, Case{28, 0.6, 0.8, -1}, Case{28, 2, 0.8, -1}, Case{29, -1, 0.5, +1},
        Case{29, 0.6, 0.5, +1}, Case{29, 2, 0.5, +1}, Case{30, -1, 0.5, -1}, Case{30, 0.6, 0.5, -1},
        Case{30, 2, 0.5, -1}, Case{33, -1, -1.75, -1}, Case{33, 0.6, 0.25, -1},
        Case{34, -1, -0.75, +1}, Case{34, 0.6, 1.25, +1}, Case{35, 0.6, 0.6, 0},
        Case{37, -1, -1, 0}));

TEST(Homing, SearchesInTheDirectionOfTheFigureAndTurnsAtTheLimitSwitch) {
  for (const int method : {23, 24, 25, 26}) {
    Homing b(homingMachine(2.0));
    b.home(method);
    EXPECT_GE(b.highest, 3.0) << method;
    EXPECT_GT(b.lowest, -2.0) << method;
  }
  for (const int method : {27, 28, 29, 30}) {
    Homing b(homingMachine(-1.0));
    b.home(method);
    EXPECT_LE(b.lowest, -2.0) << method;
    EXPECT_LT(b.highest, 3.0) << method;
  }
}

TEST(Homing, FailsWhenBothLimitSwitchesAreReached) {
  AxisMechanics mechanics = homingMachine(0.0);
  mechanics.home_switch_high = mechanics.home_switch_low;  // no home switch
  Homing b(mechanics);
  EXPECT_EQ(b.home(23), 0x2400);
  EXPECT_GE(b.highest, 3.0);
  EXPECT_LE(b.lowest, -2.0);
  EXPECT_EQ(b.state(), 0x27);
}

TEST(Homing, FailsAtTheFirstLimitWhereTheMethodKnowsNone) {
  Homing b(homingMachine(2.0));
  EXPECT_EQ(b.home(19), 0x2400);
  EXPECT_LT(b.highest, 3.2);
}

TEST(Homing, SeesASwitchThatIsTouchedOnTheWay) {
  for (const int touched : {50, 2000}) {  // ms: it is let go before the motor has turned, or after
    Homing b(homingMachine(0.6));
    b.write(0x6098, 0, 18, 1);
    b.control(0x001F);
    b.run(ms(500));
    const double place = b.drive->truth(b.now).position_turns;
    ASSERT_GT(place, 0.8);
    ASSERT_LT(place, 2.9);
    b.drive->mechanics().positive_limit_switch = place;
    b.run(ms(touched));
    b.drive->mechanics().positive_limit_switch = 3.0;
    b.run(ms(5000));
    EXPECT_EQ(b.bits(), 0x1400);
    const double end = b.drive->truth(b.now).position_turns;
    EXPECT_LT(std::abs(end - place), 1.0) << "it is not the switch at 3";
    EXPECT_LT(end, 2.99);
    EXPECT_LT(std::abs(b.position() - kOffset), 0.3 * kTurn) << "it stands near home";
  }
}

TEST(Homing, ShowsNotStartedThenRunningThenAttainedInItsBits) {
  Homing b(homingMachine(-1.0));
  EXPECT_EQ(b.bits(), 0x0400);
  b.write(0x6098, 0, 24, 1);
  b.control(0x001F);
  b.run(ms(500));
  EXPECT_EQ(b.bits(), 0x0000);
  b.control(0x000F);  // interrupted
  b.run(ms(500));
  EXPECT_EQ(b.bits(), 0x0400);
  EXPECT_EQ(b.velocity(), 0);
  EXPECT_EQ(b.home(24), 0x1400);
  b.control(0x000F);
  EXPECT_EQ(b.bits(), 0x1400);
}

TEST(Homing, DoesNotStartByABitThatCameWithTheEnabling) {
  Homing b(homingMachine(-1.0));
  b.control(0x0006);
  b.control(0x0007);
  b.control(0x001F);
  b.run(ms(500));
  EXPECT_EQ(b.bits(), 0x0400);
  EXPECT_EQ(b.drive->truth(b.now).position_turns, -1.0);
}

TEST(Homing, SearchesFastAndThenSlowly) {
  Homing b(homingMachine(-1.0));
  b.write(0x6098, 0, 23, 1);
  b.control(0x001F);
  b.run(ms(1000));
  EXPECT_NEAR(b.velocity(), 131072, 10);
  b.run(ms(1000));  // over the edge at 0.5, back at 0.1 turns/s
  EXPECT_NEAR(b.velocity(), -13107, 10);
}

TEST(Homing, RefusesMethodsItDoesNotHave) {
  Homing b(homingMachine(0.0));
  EXPECT_EQ(b.refusal(0x6098, 0, 15, 1), 0x06090030U);
  EXPECT_EQ(b.refusal(0x6098, 0, 36, 1), 0x06090030U);
  EXPECT_EQ(b.read(0x6098) & 0xFFU, 35U);
}

}  // namespace
}  // namespace cia402::sim
