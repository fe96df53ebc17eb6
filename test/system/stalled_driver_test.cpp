// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The driver's thread is held up, as on a machine that sleeps or is overloaded, while the bus and
// the kernel's queue go on: what came in time counts, though it is read late.
#include "bus/jobs/object_commands.h"
#include "sim/definition/drive_definition.h"
#include "system/interface_scene.h"
#include "system/synced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using fieldbus::Health;
using testing::HasSubstr;
using testing::Not;

/// Heartbeats every 0.1 s, missed by the driver after 0.3 s, by the drives after 10 s.
constexpr char kPatientDrive[] = ", error_control: {master_timeout: 10.0}";

/// Whoever sends and does not listen.
class Deaf : public sim::Listener {
  void onFrame(const can::Frame&, Time) override {}
};

class StalledDriver : public testing::Test {
 protected:
  void begin(const std::string& yaml) { begin(loadText(yaml)); }
  void begin(LoadedRobot loaded) {
    scene.emplace(std::move(loaded), sim::BusInterface::Options());
    ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 8s)) << scene->told();
    scene->run(500ms);
    scene->forgetTold();
  }
  /// At many places within a cycle and between heartbeats.
  template <typename Check>
  void stallInAllPhases(Duration duration, Check&& check) {
    for (int i = 0; i < 20; ++i) {
      scene->stall(duration);
      scene->run(200ms + i * 500us);
      ASSERT_NO_FATAL_FAILURE(check()) << "stall " << i;
    }
  }
  std::optional<InterfaceScene> scene;
};

TEST_F(StalledDriver, LosesNoDriveWhoseHeartbeatsWaitInTheQueue) {
  begin(genericPair(kPatientDrive, kPatientDrive));
  stallInAllPhases(1s, [&] {
    for (std::size_t i = 0; i < 2; ++i) {
      ASSERT_EQ(scene->state(i).health, Health::ready) << scene->told();
      ASSERT_TRUE(scene->state(i).feedback_valid) << scene->told();
    }
  });
  EXPECT_EQ(scene->told(), "");
}

TEST_F(StalledDriver, LosesNoDriveWhoseHeartbeatsWaitBehindManyOtherFrames) {
  begin(genericPair(kPatientDrive, kPatientDrive));
  Deaf deaf;
  sim::Port& stranger = scene->world().bus().attach(deaf, "stranger", 800);
  for (int i = 0; i < 800; ++i) {
    ASSERT_TRUE(stranger.send(can::Frame(0x7A0, {0, 1, 2, 3, 4, 5, 6, 7}), scene->now()));
  }
  scene->stall(1s);
  scene->run(1s);
  EXPECT_EQ(scene->told(), "");
  EXPECT_EQ(scene->interface().counters().receive_overflows, 0u);
}

TEST_F(StalledDriver, LosesADriveThatWasSilentMeanwhile) {
  begin(genericPair(kPatientDrive, kPatientDrive));
  scene->world().drive(0).powerOff(scene->now());
  scene->stall(1s);
  scene->run(20ms);
  EXPECT_EQ(scene->state(0).health, Health::lost);
  EXPECT_EQ(scene->state(1).health, Health::ready);
}

TEST_F(StalledDriver, TakesAnAnswerThatCameInTime) {
  begin(genericPair(kPatientDrive, kPatientDrive));
  for (int i = 0; i < 20; ++i) {
    std::optional<bus::Answer> answer;
    const auto take = [&answer](const bus::Answer& given) { answer = given; };
    scene->network().execute(bus::Command(bus::ReadObjectCommand{"left", "1008:00"}, take),
                             scene->now());
    scene->stall(5s);
    ASSERT_TRUE(scene->runUntil([&] { return answer.has_value(); }, 100ms)) << i;
    ASSERT_TRUE(answer->success) << i << ": " << answer->message;
    scene->run(100ms + i * 500us);
  }
  EXPECT_EQ(scene->network().master().nodes()[0].sdo().counters().timeouts, 0u);
}

TEST_F(StalledDriver, SaysEnabledOnlyOfADriveThatIs) {
  // A drive whose SDO answers come between its TPDO and the cycle that would look at it.
  LoadedRobot loaded = loadText(damiaoJoint());
  sim::DriveDefinition definition = *loaded.drives[0].definition;
  definition.communication.sdo_latency = 2600us;
  loaded.drives[0].definition = std::make_shared<const sim::DriveDefinition>(std::move(definition));
  begin(std::move(loaded));
  bool reading = false;
  const auto read = [&] {  // so that an answer is under way all the time
    if (std::exchange(reading, true)) return;
    const auto take = [&](const bus::Answer&) { reading = false; };
    scene->network().execute(bus::Command(bus::ReadObjectCommand{"joint", "6041:00"}, take),
                             scene->now());
  };
  int enabled = 0;
  for (Duration offset{}; offset < 120ms; offset += 500us) {
    drive::ProcedureRequest request;
    request.kind = drive::ProcedureKind::enable;
    bool answered = false;
    const auto take = [&](const bus::Answer& answer) {
      answered = true;
      if (!answer.success) return;
      ++enabled;
      EXPECT_TRUE(scene->truth(0).power_stage_on)
          << answer.message << ", stalled at " << toSeconds(offset) << " s";
    };
    scene->network().execute(bus::Command(bus::ProcedureCommand{"joint", request}, take),
                             scene->now());
    for (const Time end = scene->now() + offset; scene->now() < end; scene->run(500us)) read();
    scene->stall(500ms);  // it misses its master after 0.3 s
    ASSERT_TRUE(scene->runUntil([&] { return answered; }, 5s));
    scene->run(300ms);  // it is lost, if it is
    ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 8s)) << scene->told();
    ASSERT_TRUE(scene->procedure(drive::ProcedureKind::disable).success) << scene->told();
  }
  EXPECT_GT(enabled, 0);
}

TEST_F(StalledDriver, DoesNotMissTheSyncOfAnotherDeviceThatWaitsInTheQueue) {
  scene.emplace(loadText(syncExternal(genericPair(kPatientDrive, kPatientDrive))),
                sim::BusInterface::Options());
  sim::SyncProducer producer(11);
  producer.connect(scene->world().addParticipant("producer", producer));
  producer.start({}, scene->now() + 4ms);
  ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 8s)) << scene->told();
  scene->run(2s);
  scene->forgetTold();
  stallInAllPhases(100ms, [&] { ASSERT_THAT(scene->told(), Not(HasSubstr("no SYNC"))); });
}

// Drives that have missed their master stop by themselves. A reset takes their power, and their
// motors would coast: whoever asks for it as the driver wakes up has to wait.
TEST_F(StalledDriver, ResetsNoDriveThatStillStopsItsMotor) {
  using drive::ProcedureKind;
  int refused = 0;
  for (int moment = 0; moment < 20; ++moment) {
    begin(genericPair(", mode: cyclic_velocity, error_control: {master_timeout: 0.15}"));
    ASSERT_TRUE(scene->procedure(ProcedureKind::enable, "left").success) << scene->told();
    for (const Time end = scene->now() + 600ms; scene->now() < end; scene->run(20ms)) {
      ASSERT_TRUE(scene->network().axis(0).command(1.4, scene->now()).ok()) << scene->told();
    }
    scene->stall(140ms + moment * 20ms);
    scene->run(500us);  // what waited in the queue is read
    std::optional<bus::Answer> answer;
    scene->network().execute(
        bus::Command(
            bus::NmtServiceCommand{"left", moment % 2 ? "reset_node" : "reset_communication"},
            [&](const bus::Answer& given) { answer = given; }),
        scene->now());
    const auto coasts = [&] {
      const sim::DriveTruth truth = scene->truth(0);
      return !truth.power_stage_on && std::abs(truth.velocity_turns) > 0.1;
    };
    const bool coasted = scene->runUntil(coasts, 2s);
    EXPECT_FALSE(coasted) << "stalled for " << 140 + moment * 20 << " ms: " << scene->told();
    ASSERT_TRUE(answer.has_value());
    const bool waits = answer->message.find("wait for the end of the boot") != std::string::npos;
    refused += waits ? 1 : 0;
    ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 10s)) << scene->told();
    EXPECT_TRUE(scene->procedure(ProcedureKind::disable, "left").success) << scene->told();
    answer = scene->call(bus::NmtServiceCommand{"left", "reset_node"});
    EXPECT_TRUE(answer->success) << answer->message;
  }
  EXPECT_GT(refused, 2);
}

}  // namespace
}  // namespace cia402
