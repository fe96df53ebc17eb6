// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The oracles that look at the wire find what they are for, and nothing else.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t kControlwordObject = 0x6040, kTargetObject = 0x607A;

class TargetStepTest : public OracleTest {
 protected:
  TargetStepTest() : OracleTest(makeTargetSteps) {
    for (AxisTruth& truth : truths_) {
      truth.mode = 8;
      truth.velocity = 0.5;  // what stands may be called back
    }
    truths_[2].mode = 1;
    look();
    mark();
  }
  /// A cycle later a target in counts; the controlword operates.
  void target(std::int32_t counts, std::uint32_t controlword = 0x000F) {
    lookFor(4ms);
    rpdos(0,
          {{kControlwordObject, controlword}, {kTargetObject, static_cast<std::uint32_t>(counts)}});
  }
  /// The same for the axis with floats.
  void target(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    lookFor(4ms);
    rpdos(2, {{kControlwordObject, 0x000F}, {kTargetObject, bits}});
  }
};

// 1.02 * 1 rad/s * 4 ms is 132.99 counts; two more are allowed.
TEST_F(TargetStepTest, ThatIsTooLongIsFound) {
  target(1000);
  target(1135);
  EXPECT_EQ(found(), "target_step a1 +8 ms");
}

TEST_F(TargetStepTest, BackwardsThatIsTooLongIsFound) {
  target(1000);
  target(865);
  EXPECT_EQ(found(), "target_step a1 +8 ms");
}

TEST_F(TargetStepTest, WithinTheBoundIsNot) {
  for (const int counts : {1000, 1134, 1000, 866}) target(counts);
  EXPECT_EQ(found(), "");
}

TEST_F(TargetStepTest, HasNoMoreRoomWhereFramesLieFurtherApart) {
  target(1000);
  lookFor(96ms);
  target(1135);
  EXPECT_EQ(found(), "target_step a1 +104 ms");
}

// 1.02 * 1 rad/s * 4 ms = 0.00408 rad.
TEST_F(TargetStepTest, OfFloatsIsMeasuredInRadians) {
  target(0.1F);
  target(0.10407F);
  EXPECT_EQ(found(), "");
  target(0.10816F);
  EXPECT_EQ(found(), "target_step a3 +12 ms");
}

TEST_F(TargetStepTest, ToWhatIsNoNumberIsFound) {
  target(0.1F);
  target(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(found(), "target_step a3 +8 ms");
}

TEST_F(TargetStepTest, InAFrameThatEndsOperationIsNone) {
  target(1000);
  target(5000, 0x0007);  // disable operation
  target(9000, 0x0002);  // quick stop
  EXPECT_EQ(found(), "");
  target(5000);
  EXPECT_EQ(found(), "") << "the first of a new operation";
  target(5135);
  EXPECT_EQ(found(), "target_step a1 +20 ms");
}

TEST_F(TargetStepTest, OfADriveThatIsNotEnabledIsNone) {
  target(1000);
  truths_[0].statusword = 0x0023;
  target(5000);
  EXPECT_EQ(found(), "");
  truths_[0].statusword = 0x0027;
  target(9000);
  EXPECT_EQ(found(), "") << "the first since it is enabled";
  target(9135);
  EXPECT_EQ(found(), "target_step a1 +16 ms");
}

TEST_F(TargetStepTest, InAnotherModeIsNone) {
  truths_[0].mode = 1;  // profile_position: the drive plans its way
  target(1000);
  target(5000);
  EXPECT_EQ(found(), "");
}

TEST_F(TargetStepTest, WithoutAVelocityLimitIsNotJudged) {
  for (const std::uint32_t counts : {1000U, 100000U}) {
    lookFor(4ms);
    rpdos(1, {{kControlwordObject, 0x000F}, {kTargetObject, counts}});
  }
  EXPECT_EQ(found(), "");
}

// Number 1 of a3 is cyclic_position and profile_position: only the wish tells them apart.
TEST_F(TargetStepTest, IsNotJudgedWhereTheModeMayBeAnotherOfTheSameNumber) {
  call("set_mode", "a3", "profile_position");
  target(0.1F);
  target(0.5F);
  EXPECT_EQ(found(), "");
}

TEST_F(TargetStepTest, IsJudgedWhereTheModeOfThatNumberIsAskedForByItsName) {
  call("set_mode", "a3", "cyclic_position");
  call("set_mode", "a1", "profile_position");
  target(0.1F);
  target(0.5F);
  EXPECT_EQ(found(), "target_step a3 +8 ms");
}

TEST_F(TargetStepTest, BackToWhereTheMotorStandsIsNone) {
  target(1000);
  truths_[0].velocity = 0.0;
  truths_[0].told = 0.03068;  // 1000 counts
  for (int counts = 1100; counts <= 2000; counts += 100) target(counts);
  target(1010);
  EXPECT_EQ(found(), "");
}

TEST_F(TargetStepTest, BackToWhereTheMotorStoodACycleAgoIsNone) {
  target(1500);
  truths_[0].velocity = 0.0;
  truths_[0].told = 0.03068;
  look();
  truths_[0].velocity = 0.5;
  target(1000);
  EXPECT_EQ(found(), "") << "4 ms ago";
}

TEST_F(TargetStepTest, AwayFromWhereTheMotorStandsIsFound) {
  truths_[0].velocity = 0.0;
  truths_[0].told = 0.03068;
  target(1000);
  target(1140);
  EXPECT_EQ(found(), "target_step a1 +8 ms");
}

TEST_F(TargetStepTest, BackToWhereTheMotorStoodMoreThanTwoCyclesAgoIsFound) {
  target(1500);
  truths_[0].velocity = 0.0;
  truths_[0].told = 0.03068;
  look();
  truths_[0].velocity = 0.5;
  target(1600);
  target(1700);
  look();
  rpdos(0, {{kControlwordObject, 0x000F}, {kTargetObject, 1000}});
  EXPECT_EQ(found(), "target_step a1 +14 ms") << "9 ms ago";
}

// It was freed just as its target was called back, which is to where it has been told to be.
TEST_F(TargetStepTest, BackToAMotorThatHasJustBegunToMoveIsNone) {
  target(1500);
  truths_[0].velocity = 0.0;
  truths_[0].told = 0.03068;
  look();
  truths_[0].velocity = -2.0;
  target(1600);
  truths_[0].told = 0.02455;  // 800 counts
  target(800);
  EXPECT_EQ(found(), "") << "it stood 8 ms ago";
  target(1300);
  EXPECT_EQ(found(), "target_step a1 +17 ms");
}

class FloatTest : public OracleTest {
 protected:
  FloatTest() : OracleTest(makeFloats) {}
  void sends(std::size_t axis, std::uint32_t bits) { rpdos(axis, {{kTargetObject, bits}}); }
};

TEST_F(FloatTest, ThatIsNoFiniteNumberIsFound) {
  for (const std::uint32_t bits : {0x7FC00000U, 0xFFC00001U, 0x7F800000U, 0xFF800000U}) {
    findings_.clear();
    mark();
    wait(2ms);
    sends(2, bits);
    EXPECT_EQ(found(), "bad_float a3 +2 ms") << std::hex << bits;
  }
}

TEST_F(FloatTest, MinusZeroIsFound) {
  sends(2, 0x80000000U);
  EXPECT_EQ(found(), "bad_float a3 +0 ms");
}

TEST_F(FloatTest, ThatIsFiniteIsNot) {
  // 0, 1, -1, the smallest below zero, the greatest, and its negative
  for (const std::uint32_t bits :
       {0U, 0x3F800000U, 0xBF800000U, 0x80000001U, 0x7F7FFFFFU, 0xFF7FFFFFU}) {
    sends(2, bits);
  }
  EXPECT_EQ(found(), "");
}

TEST_F(FloatTest, IsNoneWhereTheObjectIsAWholeNumber) {
  sends(0, 0x7FC00000U);
  EXPECT_EQ(found(), "");
}

TEST_F(FloatTest, ThatADriveTrappedIsFoundOnce) {
  look();
  truths_[2].bad_floats = 1;
  lookFor(5ms);
  EXPECT_EQ(allFound(), "bad_float a3 +2 ms");
  truths_[2].bad_floats = 2;
  lookFor(5ms);
  EXPECT_EQ(allFound(), "bad_float a3 +2 ms, bad_float a3 +7 ms");
}

class VainRequestTest : public OracleTest {
 protected:
  VainRequestTest() : OracleTest(makeVainRequests) {}
  void heartbeats(int count, std::uint8_t state) {
    for (int i = 0; i < count; ++i) {
      wait(100ms);
      frame(0x701, {state});
    }
  }
  /// The question after the device type, with which a boot begins.
  void asks(int times) {
    for (int i = 0; i < times; ++i) {
      wait(10ms);
      frame(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    }
  }
};

TEST_F(VainRequestTest, OfADriveThatSaysStoppedIsFoundTheSecondTime) {
  heartbeats(3, 0x04);
  asks(1);
  EXPECT_EQ(found(), "");
  asks(3);
  EXPECT_EQ(allFound(), "vain_request a1 +320 ms") << "once";
}

TEST_F(VainRequestTest, AfterAnswersToGuardingIsFoundWhateverTheirToggleBit) {
  heartbeats(1, 0x84);
  heartbeats(1, 0x04);
  heartbeats(1, 0x84);
  asks(2);
  EXPECT_EQ(found(), "vain_request a1 +320 ms");
}

TEST_F(VainRequestTest, AfterTwoHeartbeatsIsNone) {
  heartbeats(2, 0x04);
  asks(5);
  EXPECT_EQ(found(), "");
}

TEST_F(VainRequestTest, OfADriveInAnotherStateIsNone) {
  heartbeats(3, 0x7F);
  asks(5);
  heartbeats(3, 0x04);
  heartbeats(1, 0x05);
  asks(5);
  EXPECT_EQ(found(), "");
}

TEST_F(VainRequestTest, IsNoneWithAnEmergencyInBetween) {
  heartbeats(3, 0x04);
  asks(1);
  frame(0x081, {0, 0, 0, 0, 0, 0, 0, 0});
  asks(1);
  EXPECT_EQ(found(), "");
}

TEST_F(VainRequestTest, IsNoneWithAnAnswerInBetween) {
  heartbeats(3, 0x04);
  asks(1);
  frame(0x581, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  asks(1);
  EXPECT_EQ(found(), "");
}

TEST_F(VainRequestTest, IsNoneWhereHeartbeatsMayBeLost) {
  conditions_.lossy = now() + 101ms;
  heartbeats(3, 0x04);
  asks(2);
  EXPECT_EQ(found(), "");
  heartbeats(1, 0x04);
  asks(2);
  EXPECT_EQ(found(), "vain_request a1 +440 ms") << "three after it";
}

TEST_F(VainRequestTest, IsNoneWhereTheHostCannotHearTheDrive) {
  conditions_.axes[0].unheard = now() + 101ms;
  conditions_.axes[1].unheard = now() + 10s;
  heartbeats(3, 0x04);
  asks(2);
  EXPECT_EQ(found(), "");
  heartbeats(1, 0x04);
  asks(2);
  EXPECT_EQ(found(), "vain_request a1 +440 ms");
}

TEST_F(VainRequestTest, ForAnotherObjectIsThatOfPeople) {
  heartbeats(3, 0x04);
  for (int i = 0; i < 5; ++i) frame(0x601, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(found(), "");
}

TEST_F(VainRequestTest, OfAnotherDriveIsNone) {
  heartbeats(3, 0x04);
  for (int i = 0; i < 5; ++i) frame(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(found(), "");
}

}  // namespace
}  // namespace cia402::campaign
