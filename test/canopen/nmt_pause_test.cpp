// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A node that works is taken through NMT stop and start, and keeps its configuration.
#include "canopen/nmt/pause.h"

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using test::Lines;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

const char kStopCommand[] = "000 02 03";
const char kStartCommand[] = "000 01 03";

class NmtPauseTest : public test::NodeFixture {
 protected:
  void pauseReadyNode() {
    boot();
    hear("703 05");
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    peer.take();
    peer.forget(kStartCommand);  // else it answers at once
    node->stopAndStart(milliseconds(100), now);
  }
};

TEST_F(NmtPauseTest, StopsTwiceAndStartsUntilTheHeartbeatSaysOperational) {
  pauseReadyNode();
  EXPECT_EQ(peer.take(), Lines{kStopCommand});
  pass(milliseconds(119));
  EXPECT_EQ(peer.take(), Lines{kStopCommand}) << "the first may be lost";
  pass(milliseconds(1));
  EXPECT_EQ(peer.take(), Lines{kStartCommand});
  pass(milliseconds(20));
  EXPECT_EQ(peer.take(), Lines{kStartCommand});
  EXPECT_TRUE(node->paused());
  hear("703 05");
  EXPECT_FALSE(node->paused());
  pass(milliseconds(60));
  EXPECT_EQ(peer.take(), Lines{});
  EXPECT_EQ(node->health(), Health::ready);
}

TEST_F(NmtPauseTest, AHeartbeatThatSaysStoppedIsNoSurpriseThen) {
  pauseReadyNode();
  pass(milliseconds(50));
  hear("703 04");
  pass(milliseconds(80));
  hear("703 04");
  EXPECT_EQ(node->health(), Health::ready);
  hear("703 05");
  EXPECT_FALSE(node->paused());
  hear("703 04");
  EXPECT_EQ(node->health(), Health::booting) << "now it is one";
}

TEST_F(NmtPauseTest, AHeartbeatFromBeforeTheStopEndsNothing) {
  pauseReadyNode();
  hear("703 05");
  EXPECT_TRUE(node->paused());
}

TEST_F(NmtPauseTest, ANodeThatDoesNotStartAgainIsBooted) {
  pauseReadyNode();
  for (int i = 0; i < 12; ++i) {
    pass(milliseconds(100));
    hear("703 04");
  }
  EXPECT_FALSE(node->paused());
  EXPECT_NE(node->health(), Health::ready);
  EXPECT_THAT(node->problem(), HasSubstr("did not become operational again"));
}

TEST_F(NmtPauseTest, ABootUpMessageEndsIt) {
  pauseReadyNode();
  hear("703 00");
  EXPECT_FALSE(node->paused());
  peer.take();
  pass(milliseconds(100));
  EXPECT_THAT(peer.take(), Not(Contains(kStopCommand)));
}

TEST_F(NmtPauseTest, ANodeThatIsNotReadyIsLeftAlone) {
  create();
  node->stopAndStart(milliseconds(100), now);
  EXPECT_FALSE(node->paused());
  EXPECT_EQ(peer.take(), Lines{});
}

TEST(NmtPauseOfASilentNode, CountsAsOverAfterThreeStarts) {
  test::ScriptedPeer peer;
  NmtPause pause(3, peer);
  Time now{};
  pause.begin(milliseconds(40), milliseconds(500), false, now);
  while (pause.active()) {
    now = pause.deadline();
    EXPECT_TRUE(pause.tick(now));
  }
  EXPECT_EQ(peer.take(),
            (Lines{kStopCommand, kStopCommand, kStartCommand, kStartCommand, kStartCommand}));
}

TEST(NmtPauseOfANodeThatTells, IsOverWhenItsPatienceIs) {
  test::ScriptedPeer peer;
  NmtPause pause(3, peer);
  const Time now(std::chrono::seconds(100));
  pause.begin(milliseconds(40), milliseconds(500), true, now);
  Time at = now;
  while (pause.tick(at)) at = pause.deadline();
  EXPECT_EQ(at, now + milliseconds(20 + 40 + 500));
  EXPECT_FALSE(pause.active());
  EXPECT_TRUE(pause.tick(at)) << "told once";
}

}  // namespace
}  // namespace cia402::canopen
