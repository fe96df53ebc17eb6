// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Driver and simulated drives in one process that gets no processor for a while: their time stands
// still, and neither notices.
#include <random>

#include "bus/bus_loop.h"
#include "bus/bus_time.h"
#include "sim/world/simulated_interface.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

/// What BusRunner does, on a clock that jumps when the test says so.
class StalledProcess : public testing::Test, private bus::EventSink {
 protected:
  void begin(const std::string& yaml) {
    loaded = loadText(yaml);
    simulation.emplace(loaded.drives, loaded.robot.bus.bitrate, clock);
    loop.emplace(loaded.robot, loaded.master, *simulation, static_cast<bus::EventSink&>(*this));
    ASSERT_TRUE(runUntil([&] { return allReady(); }, 8s)) << told;
  }
  /// A round of the loop; then the thread sleeps until the next, and wakes up `late` after it.
  void round(Duration late) {
    now = time.advance(due);
    loop->step(now);
    due = loop->nextDeadline();
    const Time bus = std::clamp(due, now, now + Duration(20ms));
    clock = std::max(clock + 20us, time.toClock(bus)) + late;
  }
  template <typename Condition>
  bool runUntil(Condition&& condition, Duration limit) {
    for (const Time end = now + limit; !condition();) {
      if (now >= end) return false;
      round(lateness ? lateness() : 0us);
    }
    return true;
  }
  void run(Duration duration) {
    for (const Time end = now + duration; now < end;) round(lateness ? lateness() : 0us);
  }
  bool allReady() {
    const auto& units = loop->network().cycle().units();
    return std::all_of(units.begin(), units.end(), [](const bus::AxisUnit& unit) {
      const drive::AxisState& state = unit.axis.state();
      return state.health == fieldbus::Health::ready && state.feedback_valid;
    });
  }
  template <typename Request>
  bus::Answer call(Request request) {
    std::optional<bus::Answer> answer;
    const auto take = [&answer](const bus::Answer& given) { answer = given; };
    loop->network().execute(bus::Command(std::move(request), take), now);
    EXPECT_TRUE(runUntil([&answer] { return answer.has_value(); }, 60s));
    return answer.value_or(bus::Answer());
  }
  void enable() {
    drive::ProcedureRequest request;
    request.kind = ProcedureKind::enable;
    const bus::Answer answer = call(bus::ProcedureCommand{"", request});
    ASSERT_TRUE(answer.success) << answer.message;
  }
  void onEvent(const bus::Event& event) override { told += event.text.str() + "\n"; }
  void onEmergency(const bus::EmergencyEvent& event) override {
    told += "emergency " + std::to_string(event.emergency.code) + "\n";
  }

  Time clock{100s}, now{100s}, due = kNever;
  bus::BusTime time{bus::BusTime::Kind::simulated, [this] { return clock; }};
  LoadedRobot loaded;
  std::optional<sim::SimulatedInterface> simulation;
  std::optional<bus::BusLoop> loop;
  std::function<Duration()> lateness;
  std::string told;
};

TEST_F(StalledProcess, NoDriveMissesAHeartbeatHoweverLongTheStall) {
  begin(mixedPair());
  enable();
  told.clear();
  for (const Duration stall : {Duration(30ms), Duration(60ms), Duration(350ms), Duration(5s),
                               Duration(1h), Duration(24h * 365)}) {
    for (int phase = 0; phase < 20; ++phase) {
      round(stall);
      run(20ms + phase * 700us);
      for (const bus::AxisUnit& unit : loop->network().cycle().units()) {
        const drive::Axis& axis = unit.axis;
        ASSERT_EQ(axis.state().state, drive::State::operation_enabled) << told;
      }
    }
  }
  EXPECT_EQ(told, "");
  EXPECT_GE(time.lost(), 20 * 24h * 365);
  EXPECT_EQ(loop->network().statistics().overruns(), 0U);
  EXPECT_LE(loop->network().statistics().maxLateness(), 1e-6);
}

TEST_F(StalledProcess, AMachineThatNeverKeepsUpBreaksNothing) {
  begin(mixedPair());
  std::mt19937 random(1);
  std::exponential_distribution<double> seconds(1.0 / 0.004);
  lateness = [&] { return fromSeconds(seconds(random)); };  // as long as a cycle, every time
  enable();
  told.clear();
  const double start = loop->network().axis(0).state().position;
  bus::TrajectoryCommand trajectory;
  trajectory.group = "pair";
  trajectory.joints = {"left", "right"};
  trajectory.points = {{{start + 1.0, 0.5}, {0.0, 0.0}, {}, 2s}};
  ASSERT_TRUE(call(trajectory).success);
  run(3s);
  EXPECT_THAT(told, HasSubstr("goal"));
  EXPECT_EQ(told.find("emergency"), std::string::npos) << told;
  EXPECT_NEAR(loop->network().axis(0).state().position, start + 1.0, 0.005);
  EXPECT_NEAR(loop->network().axis(1).state().position, 0.5, 0.005);
  EXPECT_EQ(loop->network().statistics().overruns(), 0U);
}

TEST_F(StalledProcess, WithoutStallsTheBusKeepsUpWithTheClock) {
  begin(genericPair());
  lateness = [] { return 80us; };
  run(10s);
  EXPECT_EQ(time.lost(), 0s);
  EXPECT_LE(clock - time.toClock(now), 25ms);
}

}  // namespace
}  // namespace cia402
