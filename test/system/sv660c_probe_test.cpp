// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Touch probes of the SV660C [L1831-1905]: both, each edge, by input and by index pulse, once and
// continuously. What is told is where the motor truly was.
#include <cmath>

#include "bus/jobs/touch_probe_job.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr double kSv660cProbed = 6.283185307179586 / 5e6;  // a user unit, rad of the joint

struct Sv660cProbing : Sv660cReady {
  Sv660cProbing() : Sv660cReady(sv660cJoint({}, "index_offset: 0.3")) {
    EXPECT_TRUE(sv660cWrite(*this, "di8_function", "38").success);
    EXPECT_TRUE(sv660cWrite(*this, "di9_function", "39").success);
    EXPECT_EQ(setpoint("joint", 2.0), "");
    run(700ms);
    EXPECT_GT(velocity("joint"), 0.5);
  }
  /// Begins to wait for an edge.
  void arm(unsigned number, const std::string& edge, bool by_index = false,
           bool continuous = false) {
    bus::ArmTouchProbeCommand command;
    command.axis = "joint";
    command.probe = number;
    command.edge = edge;
    command.index_pulse = by_index;
    command.continuous = continuous;
    command.timeout = 5.0;
    answer_ = ask(command);
    run(60ms);
    EXPECT_FALSE(answer_->has_value() && !by_index);
  }
  /// An edge of the input. @return where the joint truly is
  double touch(unsigned number, bool active) {
    const double at = position("joint");
    drive("joint").setProbe(number, active, now());
    run(20ms);
    return at;
  }
  bus::TouchProbeAnswer answer() {
    runUntil([this] { return answer_->has_value(); }, 5s);
    return answer_->value_or(bus::TouchProbeAnswer());
  }
  /// Half a millisecond of the simulated drive, and a unit.
  double tolerance() { return kSv660cProbed + 0.0005 * std::fabs(velocity("joint")); }

 private:
  std::shared_ptr<std::optional<bus::TouchProbeAnswer>> answer_;
};

class Sv660cTouchProbe : public testing::TestWithParam<unsigned> {};

INSTANTIATE_TEST_SUITE_P(Each, Sv660cTouchProbe, testing::Values(1U, 2U));

TEST_P(Sv660cTouchProbe, StoresEachEdge) {
  for (const char* edge : {"rising", "falling"}) {
    const bool rising = edge == std::string("rising");
    Sv660cProbing scene;
    if (!rising) scene.touch(GetParam(), true);
    scene.arm(GetParam(), edge);
    const double at = scene.touch(GetParam(), rising);
    const bus::TouchProbeAnswer told = scene.answer();
    ASSERT_TRUE(told.success) << told.message;
    EXPECT_NEAR(rising ? told.rising : told.falling, at, scene.tolerance()) << edge;
    EXPECT_TRUE(std::isnan(rising ? told.falling : told.rising)) << edge;
    EXPECT_EQ(sv660cNumber(scene, 0x60B8), 0U) << "single: it is disarmed";
  }
}

TEST_P(Sv660cTouchProbe, StoresBothEdgesAndCountsThem) {
  Sv660cProbing scene;
  scene.arm(GetParam(), "both");
  const double rising = scene.touch(GetParam(), true);
  const double falling = scene.touch(GetParam(), false);
  const bus::TouchProbeAnswer told = scene.answer();
  ASSERT_TRUE(told.success) << told.message;
  EXPECT_NEAR(told.rising, rising, scene.tolerance());
  EXPECT_NEAR(told.falling, falling, scene.tolerance());
  const std::string counter = "touch_probe_" + std::to_string(GetParam());
  EXPECT_EQ(sv660cRead(scene, counter + "_rising_count").number, 1.0);
  EXPECT_EQ(sv660cRead(scene, counter + "_falling_count").number, 1.0);
  const std::string stored = sv660cRead(scene, counter + "_rising").message;
  EXPECT_THAT(stored, HasSubstr(" rad"));
}

// Index pulses at 0.3 turns after each whole one.
TEST_P(Sv660cTouchProbe, StoresTheIndexPulse) {
  Sv660cProbing scene;
  scene.arm(GetParam(), "rising", true);
  const bus::TouchProbeAnswer told = scene.answer();
  ASSERT_TRUE(told.success) << told.message;
  const double turns = told.rising / 6.283185307179586 * 50.0;
  EXPECT_NEAR(turns - std::floor(turns), 0.3, 2e-5);
}

TEST_P(Sv660cTouchProbe, GoesOnStoringWhereItIsContinuous) {
  Sv660cProbing scene;
  scene.arm(GetParam(), "rising", false, true);
  const double first = scene.touch(GetParam(), true);
  const bus::TouchProbeAnswer told = scene.answer();
  ASSERT_TRUE(told.success) << told.message;
  EXPECT_NEAR(told.rising, first, scene.tolerance());
  scene.touch(GetParam(), false);
  const double second = scene.touch(GetParam(), true);
  EXPECT_GT(second - first, 0.01);
  const auto stored = sv660cRead(scene, "touch_probe_" + std::to_string(GetParam()) + "_rising");
  EXPECT_NEAR(stored.number * kSv660cProbed, second, scene.tolerance());
  EXPECT_EQ(sv660cRead(scene, "touch_probe_" + std::to_string(GetParam()) + "_rising_count").number,
            2.0);
}

}  // namespace
}  // namespace cia402
