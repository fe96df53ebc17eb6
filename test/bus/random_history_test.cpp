// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What is told and recorded of an axis is looked for by comparing little in a cycle; here all of it
// is compared in each cycle of random histories.
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <random>
#include <tuple>
#include <utility>

#include "bus/flight_recorder.h"
#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

class AcceptingSink : public can::Sink {
 public:
  bool send(const can::Frame&) override { return true; }
};

/// Everything of an axis whose change is recorded at once.
auto recordedOf(const drive::Axis& axis) {
  const drive::AxisState& state = axis.state();
  const drive::ProcedureStatus& procedure = axis.procedure();
  return std::make_tuple(state.state, state.health, state.homed, state.warning,
                         state.internal_limit, state.ready_for_motion, procedure.running,
                         procedure.success, !axis.stream().at_rest, procedure.id, state.error_code,
                         state.mode_value);
}
using Recorded = decltype(recordedOf(std::declval<const drive::Axis&>()));

class RandomHistory : public testing::TestWithParam<unsigned> {
 protected:
  static config::RobotConfig configuration() {
    config::RobotConfig robot = test::testRobot();
    robot.recorder.keep = 5;
    return robot;
  }
  bool chance(double share) { return std::uniform_real_distribution<>()(random_) < share; }
  template <typename Value, std::size_t N>
  Value anyOf(const std::array<Value, N>& values) {
    return values[std::uniform_int_distribution<std::size_t>(0, N - 1)(random_)];
  }

  /// Something that people or a drive may do.
  void happen() {
    static constexpr std::array<const char*, 2> kAxes = {"shoulder", "elbow"};
    static constexpr std::array<ProcedureKind, 8> kKinds = {
        ProcedureKind::enable,     ProcedureKind::enable,  ProcedureKind::disable,
        ProcedureKind::halt,       ProcedureKind::recover, ProcedureKind::clear_faults,
        ProcedureKind::quick_stop, ProcedureKind::home};
    static constexpr std::array<unsigned, 5> kBits = {0x0000, 0x0080, 0x0800, 0x0400, 0x4000};
    static constexpr std::array<std::uint16_t, 3> kFaults = {0x8611, 0x2310, 0x5441};
    test::FakeDrive& drive = world.drives[chance(0.5) ? 0 : 1];
    if (chance(0.4)) (void)world.begin(anyOf(kKinds), anyOf(kAxes));
    if (chance(0.2)) drive.statusword_bits = anyOf(kBits);
    if (chance(0.06)) drive.fault(anyOf(kFaults));
    if (chance(0.04)) drive.statusword = 0x0218;  // a fault without an EMCY
    if (chance(0.05)) drive.tpdo_bytes = chance(0.5) ? 0 : 7;
    if (chance(0.05)) drive.silent = !drive.silent;
    if (chance(0.2)) (void)world.begin(world.trajectory("arm", {{{0.1, -0.1}, 0.3}}));
    if (chance(0.2)) (void)world.begin(SetpointCommand{0, chance(0.5) ? 0.2 : -0.2});
    if (chance(0.05)) world.drives[0].tpdo_bytes = world.drives[1].tpdo_bytes = 7;
  }

  void compare(std::size_t index) {
    const drive::Axis& axis = world.axis(index);
    const auto recorded = recordedOf(axis);
    if (recorded_[index] && *recorded_[index] != recorded) {
      ++changes;
      const AxisRecord last = newest(index);
      EXPECT_EQ(last.stamp, world.network.now());
      EXPECT_EQ(last.state, static_cast<std::uint8_t>(axis.state().state));
      EXPECT_EQ(last.health, static_cast<std::uint8_t>(axis.state().health));
      EXPECT_EQ(last.error_code, axis.state().error_code);
      EXPECT_EQ(last.mode, axis.state().mode_value);
    }
    recorded_[index] = recorded;
    const drive::AxisState& state = axis.state();
    const bool known = state.health == fieldbus::Health::ready && state.feedback_valid &&
                       state.state != drive::State::unknown;
    if (!known || world.node(index).health() != fieldbus::Health::ready) return;
    EXPECT_EQ(world.unit(index).news.words().problem.str(), axis.faultText());
  }
  AxisRecord newest(std::size_t index) const {
    AxisRecord last;
    for (const AxisRecord& record : recorder.copy(world.now).axes) {
      if (record.axis == index) last = record;
    }
    return last;
  }

  AcceptingSink sink;
  config::RobotConfig config = configuration();
  FlightRecorder recorder{config, sink};
  test::RobotWorld world{config};
  int changes = 0;

 private:
  std::mt19937 random_{GetParam()};
  std::array<std::optional<Recorded>, 2> recorded_;
};

TEST_P(RandomHistory, EveryChangeIsRecordedAndToldInItsCycle) {
  recorder.watch(world.network);
  world.enable();
  for (int i = 0; i < 4000; ++i) {
    if (i % 10 == 0) happen();
    const Time cycle = world.network.cycle().lastCycle();
    ASSERT_TRUE(world.runUntil([&] { return world.network.cycle().lastCycle() != cycle; }));
    recorder.observe();
    compare(0);
    compare(1);
    if (HasFailure()) FAIL() << "in cycle " << i << "\n" << world.allEvents();
  }
  EXPECT_GT(changes, 100);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomHistory, testing::Range(1U, 6U));

}  // namespace
}  // namespace cia402::bus
