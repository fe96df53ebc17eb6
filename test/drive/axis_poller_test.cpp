// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/poller.h"

#include "drive/objects_fixture.h"

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;

using test::FakeDrive;

const FakeDrive::Key kError{0x60F4, 0}, kVelocity{0x606C, 0};

class AxisPollerTest : public test::ObjectsFixture {
 protected:
  AxisPollerTest() {
    error_spec.id = {0x60F4, 0};
    velocity_spec.id = {0x606C, 0};
    error.spec = &error_spec;
    velocity.spec = &velocity_spec;
    drive.dictionary[kError] = {5, 4};
    drive.dictionary[kVelocity] = {7, 4};
  }
  /// A cycle of 4 ms each. @return how often `object` was asked for.
  int pass(Duration span, FakeDrive::Key object, Duration look_every = Duration::zero()) {
    drive.reads.clear();
    for (Duration past{}; past < span; past += 4ms) {
      if (look_every > Duration::zero() && past % look_every == Duration::zero()) {
        poller.look(shown);
      }
      if (poller.due(now)) poller.advance(objects, now);
      run();
      now += 4ms;
    }
    return drive.reads[object];
  }

  ObjectSpec error_spec, velocity_spec;
  Signal error, velocity;
  AxisPoller poller;
  int shown = 0;  ///< the item that is looked at
};

TEST_F(AxisPollerTest, WhatTheDriverNeedsIsReadEveryFiftyMilliseconds) {
  const int item = poller.add(velocity);
  EXPECT_EQ(pass(5200ms, kVelocity), 100);
  EXPECT_EQ(poller.value(item, now)->raw, 7u);
}

TEST_F(AxisPollerTest, WhatNobodyLooksAtIsNotRead) {
  const int item = poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(60s, kError), 0);
  EXPECT_EQ(poller.value(item, now), nullptr);
}

TEST_F(AxisPollerTest, EachLookReadsOnce) {
  const int item = poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(10s, kError, 1s), 10);
  EXPECT_EQ(poller.value(item, now)->raw, 5u) << "a second old, as the next look will find it";
  EXPECT_EQ(pass(10s, kError, 100ms), 100);
  pass(2500ms, kError);
  EXPECT_EQ(poller.value(item, now), nullptr) << "nobody has looked for long";
  pass(8ms, kError);
  EXPECT_FALSE(poller.value(item).fresh);
}

TEST_F(AxisPollerTest, ManyLooksReadNoOftenerThanTheIntervalAndDelayNothingElse) {
  poller.add(velocity);
  shown = poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(5200ms, kVelocity, 4ms), 50) << "in turn";
}

TEST_F(AxisPollerTest, EachValueCarriesTheTimeOfItsAnswerAndIsUnknownOnceItIsTooOld) {
  const int item = poller.add(velocity);
  pass(100ms, kVelocity);
  const Time answered = poller.value(item, now)->stamp;
  EXPECT_GT(answered, now - 60ms);
  drive.unanswered_reads.insert(kVelocity);  // no answer from now on
  pass(AxisPoller::kStale - (now - answered), kVelocity);
  EXPECT_EQ(poller.value(item, answered + AxisPoller::kStale)->stamp, answered);
  EXPECT_EQ(poller.value(item, answered + AxisPoller::kStale + 1ms), nullptr);
  EXPECT_TRUE(poller.value(item).fresh) << "where it stays for those who look in each cycle";
  pass(8ms, kVelocity);
  EXPECT_FALSE(poller.value(item).fresh);
  drive.unanswered_reads.clear();
  pass(2s, kVelocity);
  EXPECT_TRUE(poller.value(item).fresh) << "it is asked for again";
}

TEST_F(AxisPollerTest, WhatSomebodyElseHasReadIsFreshForAsLong) {
  const int item = poller.add(velocity);
  drive.read_aborts[kVelocity] = 0x06020000;  // it is not asked for any more
  pass(200ms, kVelocity);
  EXPECT_FALSE(poller.value(item).fresh);
  poller.put(item, 9, now);
  EXPECT_TRUE(poller.value(item).fresh);
  EXPECT_EQ(poller.value(item).raw, 9u);
  pass(AxisPoller::kStale, kVelocity);
  EXPECT_TRUE(poller.value(item).fresh);
  pass(8ms, kVelocity);
  EXPECT_FALSE(poller.value(item).fresh);
}

TEST_F(AxisPollerTest, OfMappedObjectsThoseAreReadThatAreOnlyLookedAt) {
  velocity.slot = error.slot = 3;
  EXPECT_EQ(poller.add(velocity), -1);
  const int item = poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(1s, kError), 0) << "the drive may map it: nobody has to ask";
  EXPECT_EQ(pass(1s, kError, 100ms), 10) << "the drive turned out not to";
  EXPECT_EQ(poller.value(item, now)->raw, 5u);
}

TEST_F(AxisPollerTest, AnObjectThatTheDriveRefusesIsNotAskedForAtEveryLook) {
  drive.read_aborts[kError] = 0x06020000;
  poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(10s, kError, 100ms), 1);
}

TEST_F(AxisPollerTest, AfterAResetNothingIsKnownAndWhatWasRefusedIsAskedAnew) {
  const int value = poller.add(velocity);
  const int refused = poller.add(error);
  drive.read_aborts[kError] = 0x06020000;
  pass(500ms, kError);
  ASSERT_NE(poller.value(value, now), nullptr);
  poller.reset();
  EXPECT_EQ(poller.value(value, now), nullptr);
  drive.read_aborts.clear();
  EXPECT_GT(pass(500ms, kError), 0);
  ASSERT_NE(poller.value(refused, now), nullptr);
  EXPECT_EQ(poller.value(refused, now)->raw, 5u);
  EXPECT_EQ(poller.value(value, now)->raw, 7u);
}

TEST_F(AxisPollerTest, AnAnswerThatAResetMadeVoidIsNotTaken) {
  const int item = poller.add(velocity);
  drive.unanswered_reads.insert(kVelocity);
  poller.advance(objects, now);  // asked, not answered
  run();
  poller.reset();
  drive.unanswered_reads.clear();
  drive.dictionary[kVelocity] = {9, 4};
  EXPECT_TRUE(poller.due(now));
  EXPECT_EQ(poller.value(item, now), nullptr);
}

TEST_F(AxisPollerTest, TakesWhatSomebodyElseHasRead) {
  const int item = poller.add(velocity);
  poller.put(item, 42, now);
  ASSERT_NE(poller.value(item, now), nullptr);
  EXPECT_EQ(poller.value(item, now)->raw, 42u);
  EXPECT_EQ(poller.value(item, now)->stamp, now);
  poller.put(-1, 43, now);  // what is no item is nothing to it
  EXPECT_EQ(poller.value(item, now)->raw, 42u);
}

}  // namespace
}  // namespace cia402::drive
