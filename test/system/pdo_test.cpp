// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// PDOs that fail to come, come with a wrong length, or are asked for.
#include <fstream>
#include <iterator>

#include "folders.h"
#include "system/scene.h"
#include "system/stranger.h"

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
  bus::NetworkSnapshot shot;
  scene.robot().network().fill(shot);
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
  EXPECT_THAT(shot.words.stale.str(), HasSubstr("TPDO 1 (COB-ID 0x181) did not come for"));
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

TEST(StaleFeedback, OfDigitalInputsIsNotShownAsLow) {
  Scene scene(loadText(genericPair()));
  ASSERT_TRUE(scene.boot());
  scene.run(200ms);
  EXPECT_TRUE(scene.state("left").digital_inputs_valid);
  lose(scene, 0x381);  // inputs and following error, with every tenth SYNC
  scene.run(500ms);
  EXPECT_FALSE(scene.state("left").digital_inputs_valid);
  EXPECT_EQ(scene.state("left").digital_inputs, 0u);
  EXPECT_TRUE(scene.state("right").digital_inputs_valid);
}

TEST(WrongLengths, AreCountedAndNamedButNotInAFlood) {
  Scene scene(loadText(genericPair()));
  Stranger stranger(scene.world());
  ASSERT_TRUE(scene.boot());
  for (int i = 0; i < 50; ++i) {
    stranger.send(can::Frame(0x181, {0x37, 0x02}));
    stranger.send(can::Frame(0x282, {1, 2, 3}));
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

/// One axis whose velocity comes by a TPDO of its own, in a move that takes two seconds.
std::string velocityBy(const std::string& tpdo2) {
  return genericPair(
      ", pdos: {rpdo1: [controlword, target_position], tpdo1: [statusword, position_actual, "
      "mode_display], tpdo2: {objects: [velocity_actual], " +
      tpdo2 + "}}");
}

struct Rates {
  unsigned moving = 0, standing = 0;  // per second
};

Rates velocityRates(const std::string& tpdo2) {
  Scene scene(loadText(velocityBy(tpdo2)));
  EXPECT_TRUE(scene.boot()) << scene.told();
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  Rates rates;
  unsigned* count = nullptr;
  scene.world().bus().setMonitor([&](const can::Frame& frame, Time) {
    if (frame.id == 0x281 && count != nullptr) ++*count;
  });
  EXPECT_TRUE(scene.move({1.0, 1.0}, 2s).success);
  scene.run(500ms);
  EXPECT_NEAR(scene.state("left").velocity, scene.velocity("left"), 0.1) << tpdo2;
  count = &rates.moving;
  scene.run(1s);
  count = nullptr;
  scene.run(1500ms);
  EXPECT_NEAR(scene.state("left").velocity, 0.0, 0.01) << tpdo2;
  count = &rates.standing;
  scene.run(1s);
  return rates;
}

TEST(TransmissionTypes, OfTpdosComeWhenTheyShould) {
  const Rates acyclic = velocityRates("transmission: 0");
  EXPECT_NEAR(acyclic.moving, 250.0, 5.0) << "with the SYNC after each change";
  EXPECT_LE(acyclic.standing, 60u);
  const Rates fifth = velocityRates("transmission: 5");
  EXPECT_NEAR(fifth.moving, 50.0, 1.0);
  EXPECT_NEAR(fifth.standing, 50.0, 1.0);
  for (const char* type : {"254", "255"}) {
    const std::string event = "transmission: " + std::string(type);
    EXPECT_GT(velocityRates(event).moving, 240u);
    const Rates inhibited = velocityRates(event + ", inhibit: 0.05");
    EXPECT_NEAR(inhibited.moving, 20.0, 1.0);
    const Rates timed = velocityRates(event + ", inhibit: 0.05, event_timer: 0.1");
    EXPECT_GE(timed.standing, 9u);
  }
}

TEST(TransmissionTypes, OfRpdosAreTakenByTheDrive) {
  for (const char* type : {"0", "1", "254", "255"}) {
    Scene scene(loadText(genericPair(
        std::string(", pdos: {rpdo1: {objects: [controlword, target_position], transmission: ") +
        type + "}, tpdo1: [statusword, position_actual, mode_display]}")));
    ASSERT_TRUE(scene.boot()) << type << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << type << scene.told();
    ASSERT_TRUE(scene.move({0.5, 0.5}, 1s).success) << type;
    scene.run(1500ms);
    EXPECT_NEAR(scene.position("left"), 0.5, 1e-3) << type;
  }
}

/// Two PDOs each way of two objects each, on identifiers that cannot be changed.
class NarrowDrive : public testing::Test {
 protected:
  std::string yaml(const std::string& rules) {
    std::ifstream file(cia402::test::configFolder() + "/drives/generic_cia402.yaml");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    const auto replace = [&](const std::string& what, const std::string& with) {
      ASSERT_NE(text.find(what), std::string::npos) << what;
      text.replace(text.find(what), what.size(), with);
    };
    replace("\"6060:00\", type: int8, pdo: rpdo", "\"6060:00\", type: int8");
    replace("access: ro, pdo: tpdo}\n  supported_modes", "access: ro}\n  supported_modes");
    replace("\nunits:", "\npdo_rules: {" + rules + "}\nunits:");
    const std::string path = testing::TempDir() + "narrow_drive.yaml";
    std::ofstream(path) << text;
    return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
           "axes:\n  left: {node_id: 1, drive: " +
           path +
           ", counts_per_turn: 131072, gear_ratio: 100.0, rated_torque: 0.64,\n"
           "    simulation: {drive: generic_cia402_narrow},\n"
           "    limits: {lower: -2.5, upper: 2.5, velocity: 1.5, acceleration: 4.0, jerk: 40.0}}\n";
  }
  void bootAndMove(Scene& scene) {
    scene.world().bus().setMonitor([this](const can::Frame& frame, Time) {
      const unsigned index = frame.data[1] | frame.data[2] << 8;
      const bool download = frame.id == 0x601 && (frame.data[0] & 0xE0) == 0x20;
      if (download && index >= 0x1600 && index <= 0x17FF) ++mapping_writes;
      if (download && index >= 0x1A00 && index <= 0x1BFF) ++mapping_writes;
    });
    ASSERT_TRUE(scene.boot()) << scene.told();
    const auto enabled = scene.procedure(ProcedureKind::enable);
    ASSERT_TRUE(enabled.success) << enabled.message;
    ASSERT_TRUE(scene.move({0.5}, 1s).success);
    scene.run(1500ms);
    EXPECT_NEAR(scene.position("left"), 0.5, 1e-3);
    EXPECT_FALSE(std::isnan(scene.state("left").velocity));
  }
  unsigned mapping_writes = 0;
};

TEST_F(NarrowDrive, GetsAPlanThatItCanHold) {
  Scene scene(loadText(yaml("max_pdos: 2, max_entries: 2, cob_ids: drive")));
  bootAndMove(scene);
  EXPECT_GT(mapping_writes, 0u);
}

TEST_F(NarrowDrive, WithMappingsOfItsOwnIsNeverMapped) {
  Scene scene(loadText(
      yaml("max_pdos: 2, max_entries: 2, cob_ids: drive, fixed: {rpdo1: [controlword], rpdo2: "
           "[controlword, target_position], tpdo1: [statusword], tpdo2: [statusword, "
           "position_actual]}")));
  bootAndMove(scene);
  EXPECT_EQ(mapping_writes, 0u);
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

// 1029h:02, what a communication error other than a missing heartbeat leads to (CiA 301, 7.5.2.36):
// 1 from the factory, nothing; 0, out of operational.
TEST(DriveDeadline, OfADriveThatHearsNothingElseIsKeptByItsErrorBehaviour) {
  struct Case {
    const char* options;
    bool power;
    canopen::NmtState nmt;
  };
  for (const Case& c : {Case{"", true, canopen::NmtState::operational},
                        Case{", write: [{object: other_error_behaviour, raw: 0}]", false,
                             canopen::NmtState::pre_operational}}) {
    Scene scene(loadText(damiaoJoint(c.options)));
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    ASSERT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "csv").success);
    scene.stream("joint", -0.5, 500ms);
    ASSERT_NEAR(scene.velocity("joint"), -0.5, 0.05);
    lose(scene, 0x204, "joint");
    lose(scene, 0x604, "joint");  // nor the quick stop by SDO
    scene.run(1s);
    EXPECT_EQ(scene.truth("joint").power_stage_on, c.power) << c.options;
    EXPECT_EQ(scene.truth("joint").nmt, c.nmt) << c.options;
    EXPECT_LT(std::abs(scene.velocity("joint")), 0.01) << c.options;
  }
}

}  // namespace
}  // namespace cia402
