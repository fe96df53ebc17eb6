// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "../../src/drive/axis_poller.h"

#include <algorithm>

#include "canopen/sdo_client_fixture.h"

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;

const char kAskError[] = "601 40 F4 60 00 00 00 00 00";
const char kAskVelocity[] = "601 40 6C 60 00 00 00 00 00";

class AxisPollerTest : public canopen::test::SdoClientFixture {
 protected:
  AxisPollerTest() {
    error_spec.id = {0x60F4, 0};
    velocity_spec.id = {0x606C, 0};
    error.spec = &error_spec;
    velocity.spec = &velocity_spec;
    peer.on(kAskError, "581 43 F4 60 00 05 00 00 00");
    peer.on(kAskVelocity, "581 43 6C 60 00 07 00 00 00");
  }
  /// A cycle of 4 ms each. @return how often `line` was asked.
  long pass(Duration span, const char* line, Duration look_every = Duration::zero()) {
    peer.take();
    for (Duration past{}; past < span; past += 4ms) {
      if (look_every > Duration::zero() && past % look_every == Duration::zero()) poller.look();
      if (poller.due(now)) poller.advance(client, now);
      run();
      now += 4ms;
    }
    const auto sent = peer.take();
    return std::count(sent.begin(), sent.end(), line);
  }

  ObjectSpec error_spec, velocity_spec;
  InputObject error, velocity;
  AxisPoller poller;
};

TEST_F(AxisPollerTest, WhatTheDriverNeedsIsReadEveryFiftyMilliseconds) {
  const int item = poller.add(velocity);
  EXPECT_EQ(pass(5200ms, kAskVelocity), 100);
  EXPECT_EQ(poller.value(item, now)->raw, 7u);
}

TEST_F(AxisPollerTest, WhatNobodyLooksAtIsNotRead) {
  const int item = poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(60s, kAskError), 0);
  EXPECT_EQ(poller.value(item, now), nullptr);
}

TEST_F(AxisPollerTest, EachLookReadsOnce) {
  const int item = poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(10s, kAskError, 1s), 10);
  EXPECT_EQ(poller.value(item, now)->raw, 5u) << "a second old, as the next look will find it";
  EXPECT_EQ(pass(10s, kAskError, 100ms), 100);
  pass(2500ms, kAskError);
  EXPECT_EQ(poller.value(item, now), nullptr) << "nobody has looked for long";
}

TEST_F(AxisPollerTest, ManyLooksReadNoOftenerThanTheIntervalAndDelayNothingElse) {
  poller.add(velocity);
  poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(5200ms, kAskVelocity, 4ms), 50) << "in turn";
}

TEST_F(AxisPollerTest, EachValueCarriesTheTimeOfItsAnswerAndIsUnknownOnceItIsTooOld) {
  const int item = poller.add(velocity);
  pass(100ms, kAskVelocity);
  const Time answered = poller.value(item, now)->stamp;
  EXPECT_GT(answered, now - 60ms);
  peer.forget(kAskVelocity);  // no answer from now on
  pass(AxisPoller::kStale - (now - answered), kAskVelocity);
  EXPECT_EQ(poller.value(item, answered + AxisPoller::kStale)->stamp, answered);
  EXPECT_EQ(poller.value(item, answered + AxisPoller::kStale + 1ms), nullptr);
}

TEST_F(AxisPollerTest, OfMappedObjectsThoseAreReadThatAreOnlyLookedAt) {
  velocity.slot = error.slot = 3;
  EXPECT_EQ(poller.add(velocity), -1);
  const int item = poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(1s, kAskError), 0) << "the drive may map it: nobody has to ask";
  EXPECT_EQ(pass(1s, kAskError, 100ms), 10) << "the drive turned out not to";
  EXPECT_EQ(poller.value(item, now)->raw, 5u);
}

TEST_F(AxisPollerTest, AnObjectThatTheDriveRefusesIsNotAskedForAtEveryLook) {
  peer.replace(kAskError, "581 80 F4 60 00 00 00 02 06");
  poller.add(error, AxisPoller::Reading::when_looked_at);
  EXPECT_EQ(pass(10s, kAskError, 100ms), 1);
}

TEST_F(AxisPollerTest, AfterAResetNothingIsKnownAndWhatWasRefusedIsAskedAnew) {
  const int value = poller.add(velocity);
  const int refused = poller.add(error);
  peer.replace(kAskError, "581 80 F4 60 00 00 00 02 06");
  pass(500ms, kAskError);
  ASSERT_NE(poller.value(value, now), nullptr);
  poller.reset();
  EXPECT_EQ(poller.value(value, now), nullptr);
  peer.replace(kAskError, "581 43 F4 60 00 05 00 00 00");
  EXPECT_GT(pass(500ms, kAskError), 0);
  ASSERT_NE(poller.value(refused, now), nullptr);
  EXPECT_EQ(poller.value(refused, now)->raw, 5u);
  EXPECT_EQ(poller.value(value, now)->raw, 7u);
}

TEST_F(AxisPollerTest, AnAnswerThatAResetMadeVoidIsNotTaken) {
  const int item = poller.add(velocity);
  peer.forget(kAskVelocity);
  poller.advance(client, now);  // asked, not answered
  run();
  poller.reset();
  peer.on(kAskVelocity, "581 43 6C 60 00 09 00 00 00");
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
