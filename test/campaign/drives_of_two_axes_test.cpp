// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Robots with several axes in one drive: each axis is looked at and troubled where it is, and what
// happens to the drive happens to all its axes.
#include <gmock/gmock.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "campaign/bus_trouble.h"
#include "campaign/drive_trouble.h"
#include "campaign/player.h"
#include "dual_robot.h"
#include "oracle_fixture.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

// --- where the axes are

class DualStage : public testing::Test {
 protected:
  DualStage() : stage_(loadedRobot(dualRobot()), 1) { stage_.world().powerOn(); }
  void look() { stage_.look(truths_); }
  /// The objects of the axis in PDOs.
  static std::set<std::uint16_t> objects(const std::vector<PdoPlace>& places, std::size_t axis) {
    std::set<std::uint16_t> objects;
    for (const PdoPlace& place : places) {
      if (place.axis == axis) objects.insert(place.object.index);
    }
    return objects;
  }

  Stage stage_;
  std::vector<AxisTruth> truths_;
};

TEST_F(DualStage, KnowsWhichAxesSitInWhichDrive) {
  ASSERT_EQ(stage_.drives().size(), 2U);
  EXPECT_THAT(stage_.drives()[0].axes, ElementsAre(0, 1));
  EXPECT_EQ(stage_.drives()[0].node_id, 4);
  EXPECT_THAT(stage_.inDriveOf(1), ElementsAre(0, 1));
  EXPECT_THAT(stage_.inDriveOf(2), ElementsAre(2));
  EXPECT_THAT(stage_.drivesNamed("a2"), ElementsAre(0));
  EXPECT_THAT(stage_.drivesNamed("all"), ElementsAre(0, 1));
  EXPECT_EQ(&stage_.driveOf(0), &stage_.driveOf(1));
  EXPECT_NE(&stage_.driveOf(0), &stage_.driveOf(2));
}

// A count of a1 is 2 pi / (50 * 4096) = 3.068e-5 rad, one of a2 1.918e-5.
TEST_F(DualStage, LooksAtTheMotorOfEachAxis) {
  look();
  EXPECT_NEAR(truths_[0].position, 0.5, 1e-9);
  EXPECT_NEAR(truths_[1].position, -0.25, 1e-9);
  EXPECT_NEAR(truths_[2].position, 0.0, 1e-9);
  EXPECT_NEAR(truths_[0].told, 0.5, 3.1e-5);
  EXPECT_NEAR(truths_[1].told, -0.25, 2e-5);
}

// 100 thousandths of 1 N m behind a gear of 50.
TEST_F(DualStage, LooksAtTheEffortOfEachAxis) {
  stage_.driveOf(0).dictionary().find({0x6877, 0})->number = 100;
  look();
  EXPECT_NEAR(truths_[0].effort, 5.0, 1e-9);
  EXPECT_EQ(truths_[1].effort, 0.0);
}

TEST_F(DualStage, LooksAtTheFaultOfEachAxis) {
  ASSERT_TRUE(stage_.driveOf(0).inject("overcurrent", stage_.now(), 1));
  look();
  EXPECT_TRUE(truths_[0].faulted());
  EXPECT_FALSE(truths_[1].faulted());
}

TEST_F(DualStage, KnowsThePdosOfEachAxisByItsObjects) {
  EXPECT_THAT(objects(stage_.rpdos(), 0), testing::IsSupersetOf({0x6840, 0x687A}));
  EXPECT_THAT(objects(stage_.rpdos(), 1), testing::IsSupersetOf({0x6040, 0x607A}));
  EXPECT_THAT(objects(stage_.tpdos(), 0), testing::IsSupersetOf({0x6841, 0x6864}));
  EXPECT_THAT(objects(stage_.tpdos(), 1), testing::IsSupersetOf({0x6041, 0x6064}));
  for (const std::uint16_t of_a2 : objects(stage_.rpdos(), 1)) EXPECT_LT(of_a2, 0x6800);
  for (const std::uint16_t of_a1 : objects(stage_.rpdos(), 0)) EXPECT_GE(of_a1, 0x6800);
  ASSERT_TRUE(stage_.statusword(0) != nullptr && stage_.statusword(1) != nullptr);
  EXPECT_EQ(stage_.statusword(0)->object.index, 0x6841);
  EXPECT_EQ(stage_.statusword(1)->object.index, 0x6041);
  EXPECT_NE(stage_.statusword(0)->cob_id, stage_.statusword(1)->cob_id);
}

// --- troubles

class DualTrouble : public DualStage {
 protected:
  DualTrouble() : session_(stage_, 1, options_) {
    wait(1s);
    session_.look();
  }
  void wait(Duration duration) {
    stage_.world().advance(stage_.now() + duration);
    session_.doLater(stage_.now());
  }
  void drives(const Words& words) { ASSERT_TRUE(drives_.act(words)); }
  void bus(const Words& words) { ASSERT_TRUE(bus_.act(words)); }
  /// The axes with such an excuse.
  std::set<std::size_t> excused(Time Conditions::Axis::*kind) const {
    std::set<std::size_t> axes;
    for (std::size_t i = 0; i < session_.conditions.axes.size(); ++i) {
      if (session_.conditions.axes[i].*kind > stage_.now()) axes.insert(i);
    }
    return axes;
  }
  std::set<std::size_t> mayCoast() const { return excused(&Conditions::Axis::may_coast); }
  std::set<std::size_t> cutOff() const { return excused(&Conditions::Axis::cut_off); }
  std::set<std::size_t> unheard() const { return excused(&Conditions::Axis::unheard); }
  bool hostLoses(std::uint32_t id) {
    return stage_.world().bus().faults().losesAt(stage_.host().interface().port().name(),
                                                 can::Frame(id, {0}));
  }

  RunOptions options_;
  Session session_;
  DriveTrouble drives_{session_};
  BusTrouble bus_{session_};
};

TEST_F(DualTrouble, PowerIsThatOfTheDrive) {
  drives({"power", "a1", "0.5"});
  EXPECT_THAT(mayCoast(), ElementsAre(0, 1));
  EXPECT_THAT(cutOff(), ElementsAre(0, 1));
  EXPECT_THAT(unheard(), ElementsAre(0, 1));
  EXPECT_FALSE(stage_.driveOf(0).device().powered());
  EXPECT_TRUE(stage_.driveOf(2).device().powered());
}

TEST_F(DualTrouble, PowerReturnsWhenNoCutLastsAnyMore) {
  drives({"power", "a1", "0.5"});
  drives({"power", "a2", "1"});
  wait(600ms);
  EXPECT_FALSE(stage_.driveOf(0).device().powered()) << "for a2";
  wait(500ms);
  EXPECT_TRUE(stage_.driveOf(0).device().powered());
}

TEST_F(DualTrouble, AFaultIsThatOfTheAxis) {
  drives({"fault", "a1", "overcurrent"});
  EXPECT_THAT(mayCoast(), ElementsAre(0));
  EXPECT_THAT(cutOff(), ElementsAre());
  look();
  EXPECT_TRUE(truths_[0].faulted());
  EXPECT_FALSE(truths_[1].faulted());
}

TEST_F(DualTrouble, APowerCycleIsThatOfTheDrive) {
  drives({"fault", "a2", "power_cycle"});
  EXPECT_THAT(mayCoast(), ElementsAre(0, 1));
  EXPECT_THAT(cutOff(), ElementsAre(0, 1));
  EXPECT_THAT(unheard(), ElementsAre(0, 1));
}

TEST_F(DualTrouble, AFaultThatOnlyThePowerSwitchEndsIsEndedSoForBoth) {
  drives({"fault", "a1", "hardware"});
  wait(100ms);
  drives_.calm();
  EXPECT_THAT(mayCoast(), ElementsAre(0, 1));
  EXPECT_FALSE(stage_.driveOf(0).device().powered());
  EXPECT_TRUE(stage_.driveOf(2).device().powered());
}

TEST_F(DualTrouble, ABlockedRotorIsThatOfTheAxis) {
  drives({"block", "a1", "0.5"});
  EXPECT_THAT(excused(&Conditions::Axis::blocked), ElementsAre(0));
}

// 0.5 rad are 3.98 turns of the motor, to the other side.
TEST_F(DualTrouble, ALimitSwitchIsThatOfTheAxis) {
  drives({"switch", "a1", "upper", "1"});
  EXPECT_NEAR(stage_.driveOf(0).mechanics(1).positive_limit_switch, -3.9789, 1e-4);
  EXPECT_EQ(stage_.driveOf(0).mechanics(0).positive_limit_switch, 1e9);
  wait(1100ms);
  EXPECT_EQ(stage_.driveOf(0).mechanics(1).positive_limit_switch, 1e9);
}

TEST_F(DualTrouble, ALimitSwitchThatIsMovedTwiceGoesBackToItsPlace) {
  drives({"switch", "a1", "upper", "1"});
  wait(500ms);
  drives({"switch", "a1", "upper", "1"});
  wait(1100ms);
  EXPECT_EQ(stage_.driveOf(0).mechanics(1).positive_limit_switch, 1e9);
}

TEST_F(DualTrouble, SilenceIsThatOfTheDrive) {
  drives({"silent", "a2", "0.5"});
  EXPECT_THAT(unheard(), ElementsAre(0, 1));
  EXPECT_THAT(cutOff(), ElementsAre(0, 1));
}

TEST_F(DualTrouble, ACableIsThatOfTheDrive) {
  bus({"cable", "a2", "0.5"});
  EXPECT_THAT(unheard(), ElementsAre(0, 1));
  EXPECT_FALSE(stage_.world().port(0).attached());
  EXPECT_TRUE(stage_.world().port(1).attached());
}

TEST_F(DualTrouble, ACommandOfAStrangerIsToTheDrive) {
  bus({"foreign_nmt", "a2", "stop"});
  wait(6ms);
  EXPECT_THAT(cutOff(), ElementsAre(0, 1));
  EXPECT_THAT(mayCoast(), ElementsAre());
  bus({"foreign_nmt", "a2", "reset_node"});
  EXPECT_THAT(mayCoast(), ElementsAre(0, 1));
}

// It goes on as it was told.
TEST_F(DualTrouble, ACommandOfAStrangerThatIsLostCutsNothingOff) {
  for (AxisTruth& truth : session_.truths) truth.nmt = canopen::NmtState::operational;
  bus({"foreign_nmt", "a2", "stop"});
  wait(6ms);
  EXPECT_THAT(cutOff(), ElementsAre());
}

TEST_F(DualTrouble, CommandsThatAreLostAreCountedOnceForADrive) {
  bus({"nmt_loss", "all", "2"});
  const can::Frame stop(0x000, {0x02, 0x04});
  auto& faults = stage_.world().bus().faults();
  EXPECT_TRUE(faults.losesAt(stage_.world().port(0).name(), stop));
  EXPECT_TRUE(faults.losesAt(stage_.world().port(0).name(), stop));
  EXPECT_FALSE(faults.losesAt(stage_.world().port(0).name(), stop));
  EXPECT_TRUE(faults.losesAt(stage_.world().port(1).name(), stop));
}

TEST_F(DualTrouble, NothingIsHeardOfADriveWithAllItsAxes) {
  bus({"unheard", "a2", "all", "0.5"});
  EXPECT_THAT(unheard(), ElementsAre(0, 1));
  for (const PdoPlace& place : stage_.tpdos()) {
    EXPECT_EQ(hostLoses(place.cob_id), place.axis != 2) << std::hex << place.cob_id;
  }
  EXPECT_TRUE(hostLoses(0x704));
  EXPECT_FALSE(hostLoses(0x705));
  wait(600ms);
  for (const PdoPlace& place : stage_.tpdos()) EXPECT_FALSE(hostLoses(place.cob_id));
}

// --- played

/// Plays a scene of the robot. @return the findings, as "power_at_speed a1".
class DualPlayer : public testing::Test {
 protected:
  std::string play(const std::vector<std::string>& actions,
                   const std::function<void(Stage&, const std::string&)>& watch = {},
                   const std::string& robot = dualRobot()) {
    Scene scene;
    scene.robot = robot;
    for (const std::string& action : actions) scene.actions.push_back(parseAction(action).value());
    Stage stage(loadedRobot(scene.robot), scene.seed);
    RunOptions options;
    options.stop_at_first = false;
    options.trace = [&](const std::string& line) {
      if (watch) watch(stage, line);
      if (line.find("> ") != std::string::npos) stage.look(at_last_action_);
    };
    Player player(stage, scene, options);
    player.play();
    std::string text;
    for (const Finding& finding : player.findings()) {
      text += (text.empty() ? "" : ", ") + finding.oracle + " " + finding.axis;
    }
    return text;
  }
  bool powered(std::size_t axis) const { return at_last_action_.at(axis).power; }

  std::vector<AxisTruth> at_last_action_;
};

/// All move, as each is told, by 0.6 rad in 2 s.
const char* const kEnable = "2 enable all";
const char* const kMove = "4 goal g1 2.0 -0.1 0.35 0.6";

TEST_F(DualPlayer, EachAxisGoesWhereItIsTold) {
  EXPECT_EQ(play({kEnable, kMove, "7 end"}), "");
  EXPECT_NEAR(at_last_action_[0].position, -0.1, 0.001);
  EXPECT_NEAR(at_last_action_[1].position, 0.35, 0.001);
  EXPECT_NEAR(at_last_action_[2].position, 0.6, 0.001);
}

TEST_F(DualPlayer, ALossOfPowerTakesBothAndIsExcusedInBoth) {
  EXPECT_EQ(play({kEnable, kMove, "5 power a1 0.5", "5.01 end"}), "");
  EXPECT_FALSE(powered(0) || powered(1));
  EXPECT_TRUE(powered(2));
}

TEST_F(DualPlayer, AFaultTakesItsAxisAlone) {
  EXPECT_EQ(play({kEnable, kMove, "5 fault a1 overcurrent", "5.05 end"}), "");
  EXPECT_FALSE(powered(0));
  EXPECT_TRUE(powered(1) && powered(2));
}

TEST_F(DualPlayer, AFaultOfOneExcusesNothingInTheOther) {
  const auto breaks = [](Stage& stage, const std::string& line) {
    if (line.find("> 5.0 fault a1") == std::string::npos) return;
    ASSERT_TRUE(stage.driveOf(1).inject("overcurrent", stage.now(), 0));
  };
  EXPECT_EQ(play({kEnable, kMove, "5 fault a1 overcurrent", "5.05 end"}, breaks),
            "power_at_speed a2");
}

TEST_F(DualPlayer, ABlockedRotorHoldsItsAxisAlone) {
  double held = 0.0;
  const auto remember = [&](Stage& stage, const std::string& line) {
    if (line.find("> 5.0 block") == std::string::npos) return;
    std::vector<AxisTruth> truths;
    stage.look(truths);
    held = truths[0].position;
  };
  play({kEnable, kMove, "5 block a1 0.3", "5.2 end"}, remember);
  EXPECT_NEAR(at_last_action_[0].position, held, 0.02);
  EXPECT_GT(at_last_action_[1].velocity, 0.2);
}

TEST_F(DualPlayer, BothComeBackAfterTheDriveWasDown) {
  EXPECT_EQ(play({kEnable, kMove, "5 fault a2 power_cycle", "7 prove", "8 end"}), "");
}

// The drive takes the reset after NMT stop alone, and that is not done to an axis under power.
TEST_F(DualPlayer, AnAxisIsDisabledWhereTheOtherAsksForItToComeBack) {
  bool disabled = false;
  const auto remember = [&](Stage&, const std::string& line) {
    disabled = disabled || line.find("> disable a2") != std::string::npos;
  };
  EXPECT_EQ(play({kEnable, "4 fault a1 overcurrent", "4.1 clear a1", "5 prove", "6 end"}, remember,
                 dualRobot("fault_reset_nmt_stop: 0.1", "quirks: {fault_reset_needs_stop: 0.1}")),
            "");
  EXPECT_TRUE(disabled);
}

}  // namespace
}  // namespace cia402::campaign
