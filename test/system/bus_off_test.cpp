// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The driver's own controller falls off the bus: what stops, what is said, what comes back.
#include "system/interface_scene.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using can::BusState;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Two axes in the middle of a move from 0 to 2 rad.
class BusOffOfTheDriver : public testing::Test {
 protected:
  void begin(const sim::BusInterface::Options& options = {}) {
    scene.emplace(loadText(genericPair()), options);
    ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 8s)) << scene->told();
    ASSERT_TRUE(scene->procedure(ProcedureKind::enable).success);
    ASSERT_TRUE(scene->move({2.0, -2.0}, 4s).success);
    scene->run(2s);
    ASSERT_TRUE(scene->truth(0).moving);
    scene->forgetTold();
  }
  bool back() {
    return scene->runUntil([&] { return scene->interface().state() == BusState::error_active; },
                           20s);
  }
  void expectLeftDisabled() {
    ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 8s)) << scene->told();
    scene->run(3s);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_FALSE(scene->truth(i).moving) << i;
      EXPECT_NE(scene->state(i).state, drive::State::operation_enabled) << i;
    }
  }
  void expectUsableAgain() {
    const auto recovered = scene->procedure(ProcedureKind::recover);
    ASSERT_TRUE(recovered.success) << recovered.message << "\n" << scene->told();
    ASSERT_TRUE(scene->move({1.0, 1.0}, 4s).success);
    scene->run(6s);
    EXPECT_NEAR(scene->state(0).position, 1.0, 1e-3);
  }
  std::optional<InterfaceScene> scene;
};

sim::BusInterface::Options kernelRestartsAfter(Duration time) {
  sim::BusInterface::Options options;
  options.restart_after = time;
  return options;
}

TEST_F(BusOffOfTheDriver, IsEndedByTheDriverAndLeavesTheAxesDisabled) {
  begin();
  scene->port().forceBusOff();
  ASSERT_TRUE(back());
  EXPECT_EQ(scene->interface().counters().restart_attempts, 1u);
  EXPECT_EQ(scene->interface().counters().restarts, 1u);
  EXPECT_THAT(scene->told(),
              AllOf(HasSubstr("can0 (simulated bus) is bus-off"),
                    HasSubstr("left (node 1): sim is bus-off: nothing reaches the drive")));
  scene->run(10ms);
  EXPECT_THAT(scene->told(), HasSubstr("sim is back"));
  expectLeftDisabled();
  EXPECT_THAT(scene->told(), HasSubstr("stopped: sim is bus-off")) << "told at rest";
  expectUsableAgain();
}

TEST_F(BusOffOfTheDriver, IsEndedByTheKernelWithoutAnAttemptOfTheDriver) {
  begin(kernelRestartsAfter(250ms));
  const Time off = scene->now();
  scene->port().forceBusOff();
  ASSERT_TRUE(back());
  EXPECT_GE(scene->now(), off + 250ms);
  EXPECT_LT(scene->now(), off + 260ms);
  EXPECT_EQ(scene->interface().counters().restart_attempts, 0u);
  expectLeftDisabled();
  expectUsableAgain();
}

TEST_F(BusOffOfTheDriver, ThatIsShortLeavesTheAxesDisabledToo) {
  begin(kernelRestartsAfter(8ms));
  scene->port().forceBusOff();
  ASSERT_TRUE(back());
  const double at_return = scene->state(0).position;
  expectLeftDisabled();
  EXPECT_EQ(scene->state(0).health, Health::ready) << "never lost";
  EXPECT_LT(std::abs(scene->state(0).position - at_return), 0.2) << "a quick stop, no move";
  expectUsableAgain();
}

TEST_F(BusOffOfTheDriver, ThatIsOverBeforeTheDriverLooksLeavesTheAxesDisabledToo) {
  begin();
  scene->port().forceBusOff();
  scene->port().requestRecovery();  // the kernel, with a short `restart-ms`
  scene->stall(50ms);
  ASSERT_EQ(scene->interface().state(), BusState::error_active);
  scene->run(10ms);
  EXPECT_THAT(scene->told(),
              AllOf(HasSubstr("sim was bus-off for a moment: check wiring"),
                    HasSubstr("left (node 1): sim was bus-off for a moment: nothing reaches"),
                    HasSubstr("sim is back")));
  const double at_return = scene->state(0).position;
  expectLeftDisabled();
  EXPECT_LT(std::abs(scene->state(0).position - at_return), 0.2) << "a quick stop, no move";
  EXPECT_THAT(scene->told(), HasSubstr("stopped: sim was bus-off for a moment"));
  expectUsableAgain();
}

TEST_F(BusOffOfTheDriver, RefusesCommandsWithTheReason) {
  sim::BusInterface::Options options;
  options.may_restart = false;
  begin(options);
  scene->port().forceBusOff();
  scene->run(1s);
  EXPECT_THAT(scene->procedure(ProcedureKind::enable).message,
              HasSubstr("refused: sim is bus-off, nothing reaches the drive"));
  EXPECT_THAT(scene->move({0.0, 0.0}, 4s).message, HasSubstr("refused: sim is bus-off"));
  EXPECT_THAT(scene->call(bus::SetpointCommand{0, 0.1}).message, HasSubstr("sim is bus-off"));
  EXPECT_THAT(scene->told(), HasSubstr("the driver may not restart it"));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_FALSE(scene->truth(i).moving) << "stopped by itself for want of a heartbeat";
    EXPECT_EQ(scene->state(i).health, Health::lost);
  }
  scene->run(10s);
  EXPECT_EQ(scene->interface().state(), BusState::bus_off);
  scene->port().requestRecovery();  // the administrator
  ASSERT_TRUE(back());
  expectLeftDisabled();
  expectUsableAgain();
}

TEST_F(BusOffOfTheDriver, ThatComesAgainAndAgainIsAnsweredMoreAndMoreSlowly) {
  begin();
  std::vector<Duration> delays;
  for (int i = 0; i < 8; ++i) {
    const Time off = scene->now();
    scene->port().forceBusOff();
    ASSERT_TRUE(back());
    delays.push_back(std::chrono::duration_cast<std::chrono::milliseconds>(scene->now() - off));
    scene->run(20ms);
  }
  // 128 sequences of 11 recessive bits and the heartbeats between them take some milliseconds.
  const Duration expected[] = {100ms, 200ms, 400ms, 800ms, 1600ms, 3200ms, 5000ms, 5000ms};
  for (std::size_t i = 0; i < delays.size(); ++i) {
    EXPECT_GE(delays[i], expected[i]) << i;
    EXPECT_LE(delays[i], expected[i] + 10ms) << i;
  }
  expectLeftDisabled();
  scene->run(10s);
  const Time off = scene->now();
  scene->port().forceBusOff();
  ASSERT_TRUE(back());
  EXPECT_LE(scene->now() - off, 110ms) << "calm for ten seconds: as at the start";
  expectLeftDisabled();
  expectUsableAgain();
}

TEST_F(BusOffOfTheDriver, AStormOfItIsSummedUpInTheLog) {
  begin(kernelRestartsAfter(2ms));
  for (int i = 0; i < 200; ++i) {
    scene->port().forceBusOff();
    ASSERT_TRUE(back());
    scene->run(5ms);
  }
  scene->run(6s);
  EXPECT_EQ(scene->interface().counters().bus_off_events, 200u);
  EXPECT_THAT(scene->told(), HasSubstr("sim became bus-off "));
  std::size_t lines = 0;
  for (const char c : scene->told()) lines += c == '\n' ? 1 : 0;
  EXPECT_LT(lines, 60u) << scene->told();
}

TEST_F(BusOffOfTheDriver, ThatIsThereFromTheStartIsWaitedFor) {
  scene.emplace(loadText(genericPair()), sim::BusInterface::Options());
  scene->port().forceBusOff();
  scene->run(50ms);
  EXPECT_FALSE(scene->network().started());
  ASSERT_TRUE(scene->runUntil([&] { return scene->allReady(); }, 8s)) << scene->told();
  expectUsableAgain();
}

TEST_F(BusOffOfTheDriver, ACablePulledAndPluggedAgainNeedsNoRestart) {
  begin();
  scene->port().setAttached(false);
  scene->run(2s);
  EXPECT_EQ(scene->interface().state(), BusState::error_passive) << "nobody acknowledges";
  EXPECT_THAT(scene->told(), HasSubstr("error passive"));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_FALSE(scene->truth(i).moving);
    EXPECT_EQ(scene->state(i).health, Health::lost);
  }
  scene->port().setAttached(true);
  expectLeftDisabled();
  EXPECT_EQ(scene->interface().counters().bus_off_events, 0u);
  expectUsableAgain();
}

}  // namespace
}  // namespace cia402
