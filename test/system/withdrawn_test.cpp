// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What was asked for before everything had to stop enables nothing afterwards.
#include "system/interface_scene.h"
#include "system/lss_scene.h"
#include "system/synced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr ProcedureKind kEnabling[] = {ProcedureKind::enable, ProcedureKind::recover,
                                       ProcedureKind::home};
constexpr int kSurelyRunning = 12;  // ms: three cycles, enabling takes more
const char kHoming[] = ", homing: {method: 37, timeout: 10.0}";

bool powered(State state) {
  return state == State::switched_on || state == State::operation_enabled;
}

class Interrupted : public testing::TestWithParam<int> {};  // ms from the command to the loss

TEST_P(Interrupted, ByBusOffNothingIsEnabledWhenTheBusIsBack) {
  for (const ProcedureKind kind : kEnabling) {
    SCOPED_TRACE(toString(kind));
    sim::BusInterface::Options options;
    options.restart_after = 100ms;
    InterfaceScene scene(loadText(genericPair(kHoming, kHoming)), options);
    ASSERT_TRUE(scene.runUntil([&] { return scene.allReady(); }, 8s)) << scene.told();
    std::optional<bus::Answer> answer;
    bus::ProcedureCommand procedure;
    procedure.request.kind = kind;
    const auto take = [&answer](const bus::Answer& given) { answer = given; };
    scene.network().execute(bus::Command(procedure, take), scene.now());
    scene.run(std::chrono::milliseconds(GetParam()));
    if (answer) {  // enabled at rest before the loss
      EXPECT_GE(GetParam(), kSurelyRunning);
      continue;
    }
    scene.port().forceBusOff();
    ASSERT_TRUE(
        scene.runUntil([&] { return scene.interface().state() == can::BusState::bus_off; }, 1s));
    ASSERT_TRUE(scene.runUntil(
        [&] { return scene.interface().state() == can::BusState::error_active; }, 10s));
    scene.run(1s);  // what was enabled already gets its quick stop
    ASSERT_TRUE(answer);
    EXPECT_FALSE(answer->success) << answer->message;
    EXPECT_THAT(answer->message, HasSubstr("bus-off"));
    for (const Time end = scene.now() + 5s; scene.now() < end; scene.run(10ms)) {
      for (std::size_t i = 0; i < 2; ++i) {
        ASSERT_FALSE(powered(scene.state(i).state)) << i << "\n" << scene.told();
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(After, Interrupted, testing::Values(0, 1, 3, 7, 12, 20, 35, 60));

/// SYNC is another device's; `left` moves and `right` is being enabled when some are missing.
class InterruptedBySync : public testing::TestWithParam<int> {};

TEST_P(InterruptedBySync, NothingIsEnabledAndWhatMovedStops) {
  for (const ProcedureKind kind : kEnabling) {
    SCOPED_TRACE(toString(kind));
    std::string yaml = syncExternal(genericPair({}, kHoming));
    yaml.replace(yaml.find("joints: [left, right]"), 21, "joints: [left]");
    SyncedScene scene(yaml);
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "left").success) << scene.told();
    ASSERT_TRUE(scene.move({1.5}, 4s).success);
    scene.run(1s);
    const auto answer = scene.begin(kind, "right");
    scene.run(std::chrono::milliseconds(GetParam()));
    if (*answer) {  // enabled at rest before the loss
      EXPECT_GE(GetParam(), kSurelyRunning);
      continue;
    }
    scene.cease();
    scene.run(24ms);
    scene.produce();
    scene.run(1s);
    ASSERT_TRUE(*answer);
    EXPECT_FALSE((*answer)->success) << (*answer)->message;
    EXPECT_THAT((*answer)->message, HasSubstr("no SYNC"));
    EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3);
    for (const Time end = scene.now() + 3s; scene.now() < end; scene.run(10ms)) {
      ASSERT_FALSE(powered(scene.state("right").state)) << scene.told();
      ASSERT_FALSE(powered(scene.state("left").state)) << scene.told();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(After, InterruptedBySync, testing::Values(0, 3, 7, 12, 20, 35));

class ARecoverThatWaitsForLss : public testing::Test {
 protected:
  /// `right` was switched off and is being looked for by LSS.
  void beginRecover(const std::string& axes) {
    ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 20s)) << scene.told();
    scene.inject("right", "power_cycle");
    ASSERT_TRUE(
        scene.runUntil([&] { return scene.state("right").health == fieldbus::Health::lost; }, 2s));
    scene.run(400ms);
    recovering = scene.begin(ProcedureKind::recover, axes);
    scene.run(5ms);
    ASSERT_FALSE(*recovering) << (*recovering)->message;
  }
  void SetUp() override { scene.robot().start(); }

  Scene scene{loadText(genericPair({}, lssOf(222) + unconfigured(222)))};
  std::shared_ptr<std::optional<bus::Answer>> recovering;
};

TEST_F(ARecoverThatWaitsForLss, IsWithdrawnFromAllAxesThatAreDisabled) {
  beginRecover("");
  EXPECT_FALSE(scene.procedure(ProcedureKind::disable).success) << "right is away";
  scene.run(10s);
  ASSERT_TRUE(*recovering);
  EXPECT_FALSE((*recovering)->success);
  EXPECT_THAT((*recovering)->message,
              AllOf(HasSubstr("left: not started, for disable was called"),
                    HasSubstr("right: not started, for disable was called")));
  EXPECT_FALSE(scene.truth("left").power_stage_on);
  EXPECT_FALSE(scene.truth("right").power_stage_on);
}

TEST_F(ARecoverThatWaitsForLss, IsWithdrawnByAHaltThatIsRefused) {
  beginRecover("right");
  EXPECT_FALSE(scene.procedure(ProcedureKind::halt, "right").success) << "it is away";
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 20s)) << scene.told();
  scene.run(3s);
  ASSERT_TRUE(*recovering);
  EXPECT_THAT((*recovering)->message, HasSubstr("right: not started, for halt was called"));
  EXPECT_FALSE(scene.truth("right").power_stage_on);
}

TEST(AQuickStopBySdo, ThatTheDriveDoesNotTakeIsTold) {
  SyncedScene scene;
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.inject("left", "sdo_silent");
  scene.cease();
  scene.run(3s);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("left (node 1): the quick stop by SDO failed: "),
                                  HasSubstr("switch its power off")));
  EXPECT_THAT(scene.told(), Not(HasSubstr("right (node 2): the quick stop by SDO failed")));
}

}  // namespace
}  // namespace cia402
