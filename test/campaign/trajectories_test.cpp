// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Trajectories of some joints, and cancelled ones: what they move, and until when.
#include "campaign/trajectories.h"

#include "campaign/player_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

const char kRobotOfTwo[] =
    "bus: {interface: can0, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
    "recorder: {duration: 1, keep: 0}\naxes:\n"
    "  a1: {node_id: 1, drive: generic_cia402, mode: cyclic_position, counts_per_turn: 4096,\n"
    "    gear_ratio: 50.0, limits: {lower: -3, upper: 3, velocity: 1, acceleration: 4}}\n"
    "  a2: {node_id: 2, drive: generic_cia402, mode: cyclic_position, counts_per_turn: 4096,\n"
    "    gear_ratio: 50.0, limits: {lower: -3, upper: 3, velocity: 1, acceleration: 4}}\n"
    "groups:\n  g1: {joints: [a1, a2], allow_partial_joints_goal: true,\n"
    "    stop_trajectory_duration: 0.5}\n";

class TrajectoriesTest : public PlayerTest {
 protected:
  /// Plays, and keeps where the motors are at the end.
  void playTwo(std::vector<std::string> actions) {
    actions.insert(actions.begin(), "2 enable all");
    EXPECT_EQ(play(
                  actions, kRobotOfTwo,
                  [this](Tapped& player, Stage& stage) {
                    permits_ = &player.permits();
                    stage_ = &stage;
                  },
                  [this] {
                    stage_->look(motors_);
                    until_ = {seconds(permits_->until(0)), seconds(permits_->until(1))};
                  }),
              "");
  }
  std::vector<AxisTruth> motors_;
  std::vector<double> until_;  ///< s, when the permits of the axes end

 private:
  const Permits* permits_ = nullptr;
  Stage* stage_ = nullptr;
};

// A cubic of 0.3 rad in 1 s.
TEST_F(TrajectoriesTest, OfOneJointMoveAndPermitThatOneAlone) {
  playTwo({"4 part g1 a2 1.0 0.55", "8 end"});
  EXPECT_NEAR(motors_[1].position, 0.3, 0.001);
  EXPECT_EQ(motors_[0].position, 0.0);
  EXPECT_NEAR(until_[1], 4 + 1.0 + 0.25, 0.006);
  EXPECT_EQ(until_[0], 0.0);
}

TEST_F(TrajectoriesTest, OfOneJointEachGoOnBesideEachOther) {
  playTwo({"4 part g1 a2 1.0 0.55", "4.5 part g1 a1 1.0 0.45", "8 end"});
  EXPECT_NEAR(motors_[1].position, 0.3, 0.001);
  EXPECT_NEAR(motors_[0].position, -0.3, 0.001);
  EXPECT_NEAR(until_[1], 4 + 1.0 + 0.25, 0.006);
  EXPECT_NEAR(until_[0], 4.5 + 1.0 + 0.25, 0.006);
}

// The stop takes half a second, as the group says.
TEST_F(TrajectoriesTest, ThatAreCancelledMayMoveUntilTheirStopIsOver) {
  playTwo({"4 part g1 a2 2.0 0.6", "5 cancel g1", "8 end"});
  EXPECT_NEAR(until_[1], 5 + 0.5 + 0.15, 0.02);
  EXPECT_GT(motors_[1].position, 0.3);
  EXPECT_LT(motors_[1].position, 0.5) << "0.6 rad were its goal";
  EXPECT_NEAR(seconds(told("has ended: g1: cancelled").at), 5.5, 0.1);
}

TEST_F(TrajectoriesTest, ThatWaitLeaveWhatIsBeforeThemAlone) {
  playTwo({"4 move g1 2.0 0.6 0.6", "4.5 path g1 2 1 1 0.5 0.5", "5 cancel g1", "9 end"});
  EXPECT_NEAR(motors_[0].position, 0.6, 0.001);
  EXPECT_NEAR(motors_[1].position, 0.6, 0.001);
}

TEST_F(TrajectoriesTest, StopsOfOneJointLeaveTheOtherAlone) {
  playTwo({"4 move g1 2.0 0.6 0.6", "5 stop g1 a1", "8 end"});
  EXPECT_LT(motors_[0].position, 0.5);
  EXPECT_NEAR(motors_[1].position, 0.6, 0.001);
  EXPECT_NEAR(until_[0], 5 + 0.5 + 0.15, 0.02);
  EXPECT_NEAR(until_[1], 4 + 2.0 + 0.25, 0.006);
}

// At 4.95 s it is 0.05 s from its end, and the stop takes half a second, as the group says.
TEST_F(TrajectoriesTest, MayMoveForAStopThatOutlastsThem) {
  playTwo({"4 part g1 a2 1.0 0.55", "4.95 stop g1", "8 end"});
  EXPECT_NEAR(until_[1], 4.95 + 0.5 + 0.15, 0.02);
}

TEST_F(TrajectoriesTest, MayMoveForAsMuchLongerAsTheyAreSaidToTake) {
  playTwo({"4 part g1 a2 2.0 0.6", "5 part g1 a2 0.8 0.3", "8 end"});
  const std::string answer = told("slowed down, it ends").line;
  const double later = std::stod(answer.substr(answer.find("it ends ") + 8));
  EXPECT_GT(later, 0.05);
  EXPECT_LT(later, 0.4 + 0.1 * 0.8 + 1e-6) << "goal_time and a share of its duration";
  EXPECT_NEAR(until_[1], 5 + 0.8 + later + 0.25, 0.006);
}

TEST_F(TrajectoriesTest, AreStoppedByCallsOfTheirGroup) {
  playTwo({"4 move g1 2.0 0.6 0.6", "5 halt g1", "8 end"});
  EXPECT_LT(motors_[0].position, 0.5);
  EXPECT_LT(motors_[1].position, 0.5);
  EXPECT_NEAR(until_[0], seconds(told("< halt g1").at), 0.001);
  EXPECT_NEAR(until_[1], seconds(told("< halt g1").at), 0.001);
}

}  // namespace
}  // namespace cia402::campaign
