// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// PDOs that fail to come, come with a wrong length, or are asked for; and plans on real drives.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

/// Every frame of an identifier is lost, at the driver only or at everybody.
void lose(Scene& scene, std::uint32_t id, std::string_view receiver = "master") {
  sim::FaultRule rule;
  rule.id = id;
  rule.count = 1000000;
  rule.receiver = receiver;
  scene.world().bus().faults().add(rule);
}

bus::AxisSnapshot snapshot(Scene& scene, const std::string& name) {
  bus::RobotSnapshot shot;
  scene.robot().robot().fill(shot);
  return shot.axes[scene.index(name)];
}

TEST(StaleFeedback, StopsAnEnabledAxisInWordsAndIsShownAsUnknown) {
  Scene scene(loadText(genericPair(", stale_after: 5", "", ", stop_group_on_fault: false")));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  scene.run(1s);
  lose(scene, 0x181);
  scene.run(20ms);
  EXPECT_FALSE(std::isnan(scene.state("left").position)) << "five may be missing";
  scene.run(10ms);
  EXPECT_TRUE(std::isnan(scene.state("left").position));
  EXPECT_TRUE(std::isnan(scene.state("left").velocity));
  scene.run(500ms);
  EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3);
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_THAT(
      scene.told(),
      HasSubstr("left (node 1): no usable statusword (6041:00) and position (6064:00): TPDO 1 "
                "(COB-ID 0x181) did not come for 6 cycles; quick stop is commanded"));
  scene.run(1s);
  const bus::AxisSnapshot shot = snapshot(scene, "left");
  EXPECT_EQ(shot.stale_feedback, 1u);
  EXPECT_THAT(shot.stale.str(), HasSubstr("TPDO 1 (COB-ID 0x181) did not come for"));
}

TEST(StaleFeedback, OfASlowPdoOnlyHidesItsValues) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.run(200ms);
  EXPECT_FALSE(std::isnan(scene.state("left").velocity));
  lose(scene, 0x281);  // velocity, torque and error code, with every second SYNC
  scene.run(60ms);
  EXPECT_FALSE(std::isnan(scene.state("left").velocity));
  scene.run(40ms);
  EXPECT_TRUE(std::isnan(scene.state("left").velocity));
  EXPECT_TRUE(std::isnan(scene.state("left").effort));
  EXPECT_FALSE(std::isnan(scene.state("left").position));
  EXPECT_TRUE(scene.state("left").ready_for_motion);
  EXPECT_THAT(scene.told(), HasSubstr("left (node 1): TPDO 2 (COB-ID 0x281) did not come for"));
}

/// Sends what it is told to: a device that should not be there.
class Intruder final : public sim::Participant {
 public:
  explicit Intruder(sim::World& world) : port_(world.addParticipant("intruder", *this)) {}
  void receive(const can::Frame&, Time) override {}
  void tick(Time) override {}
  Time nextDeadline() const override { return kNever; }
  void send(const can::Frame& frame) { port_.send(frame); }

 private:
  sim::Port& port_;
};

TEST(WrongLengths, AreCountedAndNamedButNotInAFlood) {
  Scene scene(loadText(genericPair()));
  Intruder intruder(scene.world());
  ASSERT_TRUE(scene.boot());
  for (int i = 0; i < 50; ++i) {
    intruder.send(can::Frame(0x181, {0x37, 0x02}));
    intruder.send(can::Frame(0x282, {1, 2, 3}));
    scene.run(10ms);
  }
  EXPECT_EQ(snapshot(scene, "left").wrong_lengths, 50u);
  EXPECT_EQ(snapshot(scene, "right").wrong_lengths, 50u);
  const std::string told = scene.told();
  EXPECT_THAT(told,
              HasSubstr("left (node 1): TPDO 1 (COB-ID 0x181) came with 2 bytes instead of 7: "
                        "too short, not taken (1 so far)"));
  EXPECT_THAT(told, HasSubstr("right (node 2): TPDO 2 (COB-ID 0x282) came with 3 bytes"));
  std::size_t lines = 0;
  for (std::size_t at = 0; (at = told.find("bytes instead of", at)) != std::string::npos; ++at) {
    ++lines;
  }
  EXPECT_EQ(lines, 2u) << told;
}

TEST(RequestedPdos, BringWhatRemoteFramesAskFor) {
  for (const char* type : {"252", "253"}) {
    Scene scene(loadText(genericPair(
        std::string(", pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, "
                    "position_actual, mode_display], tpdo2: {objects: [velocity_actual], "
                    "transmission: ") +
        type + ", request_every: 5}}")));
    unsigned requests = 0, answers = 0;
    ASSERT_TRUE(scene.boot()) << scene.told();
    scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
      if (frame.id == 0x281) ++(frame.remote ? requests : answers);
    });
    scene.run(1s);
    EXPECT_NEAR(requests, 50.0, 1.0) << type;
    EXPECT_NEAR(answers, 50.0, 2.0) << type;
    EXPECT_FALSE(std::isnan(scene.state("left").velocity)) << type;
    lose(scene, 0x281);
    scene.run(300ms);
    EXPECT_TRUE(std::isnan(scene.state("left").velocity)) << type;
  }
}

TEST(DriveDeadline, StopsADriveThatLosesOnlyItsRpdos) {
  Scene scene(loadText(damiaoJoint()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.run(200ms);
  ASSERT_TRUE(scene.truth("joint").power_stage_on);
  lose(scene, 0x204, "joint");
  scene.run(90ms);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  scene.run(1s);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_THAT(scene.told(), HasSubstr("joint (node 4): the drive reports EMCY 0x8250: no RPDO"));
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
}

/// Boots the plan of every mode of a family, enables it there and, where the drive has it, moves.
TEST(PlannedPdos, OfEveryModeBootOnTheGenericDrive) {
  for (const char* mode : {"pp", "pv", "csp", "csv"}) {
    for (const char* modes : {"", ", modes: []", ", modes: [csp, csv]", ", feedback: []",
                              ", feedback: [following_error, digital_inputs, velocity_actual]"}) {
      Scene scene(loadText(genericPair(", mode: " + std::string(mode) + modes)));
      ASSERT_TRUE(scene.boot()) << mode << modes << scene.told();
      const auto enabled = scene.procedure(ProcedureKind::enable, "left");
      EXPECT_TRUE(enabled.success) << mode << modes << ": " << enabled.message;
      EXPECT_EQ(scene.state("left").mode->name, drive::canonicalModeName(mode));
    }
  }
}

TEST(PlannedPdos, OfEveryModeBootOnTheDamiao) {
  for (const char* mode :
       {"profile_position", "position_velocity", "position_velocity_torque", "cyclic_position",
        "profile_velocity", "cyclic_velocity", "velocity_torque", "profile_torque"}) {
    for (const char* modes : {"", ", modes: []"}) {
      std::string yaml = damiaoJoint(modes);
      yaml.replace(yaml.find("mode: cyclic_position"), 21, "mode: " + std::string(mode));
      Scene scene(loadText(yaml));
      ASSERT_TRUE(scene.boot()) << mode << modes << scene.told();
      const auto enabled = scene.procedure(ProcedureKind::enable);
      EXPECT_TRUE(enabled.success) << mode << modes << ": " << enabled.message;
      EXPECT_EQ(scene.state("joint").mode->name, mode);
    }
  }
}

TEST(PlannedPdos, AModeThatWasNotPlannedIsRefusedInWords) {
  Scene scene(loadText(genericPair(", modes: []")));
  ASSERT_TRUE(scene.boot());
  const auto refused = scene.procedure(ProcedureKind::set_mode, "left", "cyclic_velocity");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("name the mode in `modes:` of the axis"));
}

TEST(PlannedPdos, AGenericAxisAtRestNeedsOneFrameEachWayPerCycle) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  unsigned rpdos = 0, tpdos = 0, further_rpdos = 0, syncs = 0;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x080) ++syncs;
    if (frame.id == 0x201) ++rpdos;
    if (frame.id == 0x301) ++further_rpdos;
    if (frame.id == 0x181) ++tpdos;
  });
  scene.run(2s);
  EXPECT_NEAR(rpdos, syncs, 1.0);
  EXPECT_NEAR(tpdos, syncs, 1.0);
  EXPECT_NEAR(further_rpdos, syncs / 10.0, 1.0);
}

}  // namespace
}  // namespace cia402
