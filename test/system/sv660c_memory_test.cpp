// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What an SV660C keeps without power: H0C.13 [L9392-9414], H02.31 [L3726-3740].
#include "bus/jobs/factory_reset.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr unsigned kFactoryGain = 400;  // H08.00 of the factory [L6442]

/// Booted and at rest; not enabled.
struct Sv660cMemory : Scene {
  explicit Sv660cMemory(const std::string& yaml = sv660cJoint()) : Scene(loadText(yaml)) {
    EXPECT_TRUE(boot()) << told();
    run(500ms);
  }
  void powerCycle() {
    inject("joint", "power_cycle");
    run(5s);
  }
  /// What a person sets at the drive itself, which stays without power.
  void atThePanel(fieldbus::ObjectId object, std::uint64_t number) {
    sim::Entry* entry = drive("joint").dictionary().find(object);
    ASSERT_NE(entry, nullptr);
    entry->number = entry->initial_number = number;
  }
  std::uint64_t gain() { return sv660cNumber(*this, 0x2008, 1); }
  std::uint64_t keeps() { return sv660cNumber(*this, 0x200C, 0x0E); }
  bus::Answer save() { return procedure(ProcedureKind::save_parameters, "joint"); }
  bus::Answer reset(bool confirm) { return call(bus::FactoryResetCommand{"joint", confirm}); }
  /// "200C:0E=1" of every write by SDO from now on.
  std::vector<std::string>& watchWrites() {
    world().bus().setMonitor([this](const can::Frame& frame, Time) {
      if (frame.id != 0x601 || (frame.data[0] & 0xE0) != 0x20) return;
      const fieldbus::ObjectId id{static_cast<std::uint16_t>(frame.data[1] + 256U * frame.data[2]),
                                  frame.data[3]};
      const unsigned number = frame.data[4] + 256U * frame.data[5];
      writes_.push_back(fieldbus::toString(id) + "=" + std::to_string(number));
    });
    return writes_;
  }

 private:
  std::vector<std::string> writes_;
};

TEST(Sv660cSaving, IsWhatKeepsParametersAndNothingElse) {
  Sv660cMemory scene;
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  EXPECT_EQ(scene.keeps(), 0U) << "H0C.13";
  scene.powerCycle();
  EXPECT_EQ(scene.gain(), kFactoryGain) << "nobody has saved it";
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  ASSERT_TRUE(sv660cWrite(scene, "H08.09", "0").success) << "which the profile does not name";
  const auto& writes = scene.watchWrites();
  const bus::Answer saved = scene.save();
  EXPECT_TRUE(saved.success) << saved.message;
  EXPECT_THAT(saved.message, HasSubstr("joint (node 1): saved 2008:01 H08.00 speed_gain, "
                                       "2008:0A H08.09 in the drive's memory"));
  EXPECT_THAT(writes, ElementsAre("200C:0E=1", "2008:01=250", "2008:0A=0", "200C:0E=0"));
  scene.powerCycle();
  EXPECT_EQ(scene.gain(), 250U);
  EXPECT_EQ(sv660cNumber(scene, 0x2008, 0x0A), 0U);
  EXPECT_TRUE(allReady(scene.robot())) << scene.told();
}

TEST(Sv660cSaving, SavesNothingThatWasNotWrittenOrCommandsSomething) {
  Sv660cMemory scene;
  const auto& writes = scene.watchWrites();
  EXPECT_THAT(scene.save().message, HasSubstr("saved nothing, as no service has written"));
  EXPECT_THAT(writes, ElementsAre());
  ASSERT_TRUE(sv660cWrite(scene, "following_error_window", "1000").success);
  ASSERT_TRUE(sv660cWrite(scene, "emergency_stop", "0").success);
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  scene.watchWrites().clear();
  const bus::Answer saved = scene.save();
  EXPECT_TRUE(saved.success) << saved.message;
  EXPECT_THAT(saved.message, HasSubstr("but not 6065:00 following_error_window"));
  EXPECT_THAT(writes, ElementsAre("200C:0E=1", "2008:01=250", "200C:0E=0"));
  scene.watchWrites().clear();
  EXPECT_THAT(scene.save().message, HasSubstr("saved nothing")) << "it was saved already";
}

TEST(Sv660cSaving, EndsWithTheMemoryClosedWhateverComesOfIt) {
  Sv660cMemory scene;
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  scene.drive("joint").dictionary().find({0x2008, 1})->access = sim::Access::ro;
  const bus::Answer refused = scene.save();
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("cannot save parameters"), HasSubstr("2008:01"),
                                     HasSubstr("0x06010002")));
  EXPECT_EQ(scene.keeps(), 0U);
}

TEST(Sv660cSaving, IsRefusedWhileTheAxisIsEnabled) {
  Sv660cReady scene;
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  const bus::Answer refused = scene.procedure(ProcedureKind::save_parameters, "joint");
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("disable it first"));
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 0x0E), 0U);
}

// H01.61 counts from the next power-on [L3149], and only what is in the memory is there then.
TEST(Sv660cSaving, KeepsTheCommandRateThatTheDriverWasToAdjust) {
  Sv660cMemory scene(sv660cJoint(
      ", adjust: [command_rate]",
      sv660cDelivered("[0x2001, 0x3E, command_scheduling_2_for_ip_mode, uint16, rw, -, 3]")));
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("call save_parameters, for it is not kept otherwise, "
                                         "then switch it off and on"));
  const bus::Answer saved = scene.save();
  EXPECT_THAT(saved.message, HasSubstr("saved 2001:3E H01.61 command_rate"));
  scene.powerCycle();
  EXPECT_EQ(sv660cNumber(scene, 0x2001, 0x3E), 2U);
  const bus::Answer again = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(again.success) << again.message;
}

TEST(Sv660cFactoryReset, IsNotDoneUnlessThatIsConfirmed) {
  Sv660cMemory scene;
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  const auto& writes = scene.watchWrites();
  const bus::Answer asked = scene.reset(false);
  EXPECT_FALSE(asked.success);
  EXPECT_THAT(asked.message,
              AllOf(HasSubstr("joint (node 1): nothing was restored"),
                    HasSubstr("initialise_parameters (2002:20) = 1: node-ID, bit rate and the "
                              "choice of CANopen become those of the factory"),
                    HasSubstr("confirm: true")));
  const bus::Answer trigger = scene.procedure(ProcedureKind::restore_parameters, "joint");
  EXPECT_FALSE(trigger.success);
  EXPECT_THAT(trigger.message, HasSubstr("~joint/factory_reset with confirm: true"));
  EXPECT_THAT(writes, ElementsAre());
  EXPECT_EQ(scene.gain(), 250U);
}

// H02.00 is 1 from the factory, H0E.10 is 0: no CANopen from the next power-on [L9629-9647].
TEST(Sv660cFactoryReset, BringsBackWhatTheFactoryHasSetAndSaysWhatMustFollow) {
  Sv660cMemory scene(sv660cWith(sv660cJoint(), "bitrate: 1000000", "bitrate: 500000"));
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  ASSERT_TRUE(scene.save().success);
  const bus::Answer reset = scene.reset(true);
  EXPECT_TRUE(reset.success) << reset.message;
  EXPECT_THAT(reset.message, AllOf(HasSubstr("restored the factory's values of all parameters by "
                                             "initialise_parameters (2002:20)"),
                                   HasSubstr("at its panel set H0E.10 to 2, H02.00 to 8"),
                                   HasSubstr("not homed")));
  EXPECT_EQ(scene.gain(), kFactoryGain);
  EXPECT_EQ(sv660cNumber(scene, 0x2002, 1), 1U);
  EXPECT_EQ(sv660cNumber(scene, 0x2002, 0x20), 0U) << "the command itself does not stay";
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success);
  EXPECT_THAT(enabled.message, HasSubstr("set H02.00 to 8"));
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  scene.powerCycle();
  EXPECT_FALSE(allReady(scene.robot())) << "it has no CANopen any more";
}

// Each step at the panel is asked for in turn while the bus is still there; H0E.10 [L9629-9647],
// H02.00 [L3334], H01.61 [L866, L3149], of which the first and the last count from the next
// power-on.
TEST(Sv660cFactoryReset, IsLivedWithOnceThePanelHasWhatIsAskedFor) {
  Sv660cMemory scene(sv660cWith(sv660cJoint(), "bitrate: 1000000", "bitrate: 500000"));
  ASSERT_TRUE(scene.reset(true).success);
  struct Step {
    const char* told;
    fieldbus::ObjectId object;
    std::uint64_t number;
  };
  for (const Step& step :
       {Step{"set H02.00 to 8", {0x2002, 0x01}, 8},
        Step{"set H0E.10 to 2 and switch the drive off and on", {0x200E, 0x0B}, 2},
        Step{"set H01.61 to 2", {0x2001, 0x3E}, 2}}) {
    const bus::Answer refused = scene.procedure(ProcedureKind::enable);
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, HasSubstr(step.told));
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
    scene.atThePanel(step.object, step.number);
  }
  scene.powerCycle();
  ASSERT_TRUE(allReady(scene.robot())) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(scene.state("joint").state, drive::State::operation_enabled);
  ASSERT_TRUE(declare(scene, "joint", 0.0).success);
  const double from = scene.position("joint");
  ASSERT_EQ(scene.setpoint("joint", 0.3), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint") - from, 0.3, 1e-5) << scene.told();
}

// As it comes from the factory: no CANopen, whatever is asked of it.
TEST(Sv660cFactoryState, IsSilentUntilThePanelHasWhatTheDriverNames) {
  Scene scene(loadText(sv660cWith(sv660cJoint(), "bitrate: 1000000", "bitrate: 500000")));
  const auto panel = [&](fieldbus::ObjectId object, std::uint64_t number) {
    sim::Entry* entry = scene.drive("joint").dictionary().find(object);
    entry->number = entry->initial_number = number;
  };
  panel({0x200E, 0x0B}, 0);
  panel({0x2002, 0x01}, 1);
  panel({0x2001, 0x3E}, 3);
  scene.robot().start();
  scene.inject("joint", "power_cycle");
  scene.run(30s);
  EXPECT_FALSE(allReady(scene.robot()));
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable).success);
  EXPECT_THAT(scene.told(), HasSubstr("at its panel set H0E.10 to 2 and H02.00 to 8, compare "
                                      "H0C.00 (node-ID) and H0C.08 (bit rate), then switch it off "
                                      "and on"));
  panel({0x200E, 0x0B}, 2);
  panel({0x2002, 0x01}, 8);
  scene.inject("joint", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 40s)) << scene.told();
  const bus::Answer refused = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("set H01.61 to 2"));
  panel({0x2001, 0x3E}, 2);
  scene.inject("joint", "power_cycle");
  scene.run(5s);
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(scene.state("joint").state, drive::State::operation_enabled);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
}

// H0C.08 is 5, 500 kbit/s, from the factory [L9277].
TEST(Sv660cFactoryReset, TakesTheDriveFromABusOfAnotherBitRateWhichIsTold) {
  Sv660cMemory scene;
  const bus::Answer reset = scene.reset(true);
  EXPECT_FALSE(reset.success);
  EXPECT_THAT(reset.message,
              AllOf(HasSubstr("restored the factory's values"), HasSubstr("it did not boot"),
                    HasSubstr("has it got the factory's node-ID or bit rate?")));
  EXPECT_EQ(sv660cNumber(scene, 0x200C, 9), 5U);
}

TEST(Sv660cFactoryReset, IsRefusedWhileTheAxisIsEnabledAndMovesNothing) {
  Sv660cReady scene;
  scene.forget();
  for (const bool confirm : {false, true}) {
    const bus::Answer refused = scene.call(bus::FactoryResetCommand{"joint", confirm});
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, HasSubstr("the axis is not disabled"));
  }
  scene.run(200ms);
  EXPECT_TRUE(scene.truth("joint").power_stage_on);
  EXPECT_EQ(sv660cNumber(scene, 0x2002, 1), 8U);
  expectNothingMoved(scene, "joint");
}

TEST(Sv660cFactoryReset, ThatTheDriveRefusesIsToldAndChangesNothing) {
  Sv660cMemory scene;
  scene.drive("joint").dictionary().find({0x2002, 0x20})->access = sim::Access::ro;
  const bus::Answer refused = scene.reset(true);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message,
              AllOf(HasSubstr("cannot restore parameters"), HasSubstr("0x06010002")));
  EXPECT_EQ(sv660cNumber(scene, 0x2002, 1), 8U);
  EXPECT_EQ(scene.node("joint").bootUps(), 1U) << "not reset";
}

}  // namespace
}  // namespace cia402
