// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Values that no TPDO brings: read by SDO beside the cycle, with the time at which they were true.
#include <utility>
#include <vector>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

/// Velocity of the left axis is polled, that of the right one comes by TPDO.
std::string withPolledVelocity() { return genericPair(", feedback: [digital_inputs]"); }

class PolledFeedback : public testing::Test {
 protected:
  PolledFeedback() : scene(loadText(withPolledVelocity())) {
    scene.watch([this] { look(); });
  }
  void begin() {
    ASSERT_TRUE(scene.boot()) << scene.told();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    scene.run(500ms);
    ASSERT_TRUE(scene.move({1.0, 1.0}, 3s).success);
  }
  Duration age() { return scene.now() - scene.state("left").stamps.velocity; }

  /// What was told must be what the motor did when it was stamped, or up to 20 ms (answer, TPDO and
  /// cycle) before.
  void look() {
    truth.emplace_back(scene.now(), scene.velocity("left"));
    const drive::AxisState& state = scene.state("left");
    if (std::isnan(state.velocity)) return;
    oldest = std::max(oldest, age());
    double nearest = 1e9;
    for (auto at = truth.rbegin(); at != truth.rend() && at->first >= state.stamps.velocity - 20ms;
         ++at) {
      if (at->first > state.stamps.velocity) continue;
      nearest = std::min(nearest, std::abs(at->second - state.velocity));
    }
    worst = std::max(worst, nearest);
  }

  Scene scene;
  std::vector<std::pair<Time, double>> truth;
  Duration oldest{0};
  double worst = 0.0;
};

TEST_F(PolledFeedback, IsStampedWithTheTimeAtWhichItWasTrue) {
  begin();
  oldest = Duration(0);
  worst = 0.0;
  scene.run(4s);
  EXPECT_LT(worst, 0.01) << "rad/s, of up to 0.6";
  EXPECT_GT(oldest, 50ms) << "or nothing is polled here";
  EXPECT_LT(oldest, 250ms);
  EXPECT_LT(scene.now() - scene.state("right").stamps.velocity, 12ms) << "by TPDO";
}

TEST_F(PolledFeedback, IsUnknownAfterASecondAndNotOld) {
  begin();
  scene.run(500ms);
  ASSERT_FALSE(std::isnan(scene.state("left").velocity));
  sim::FaultRule rule;  // the answers of its SDO server are lost
  rule.id = 0x581;
  rule.count = 1000000;
  rule.receiver = "master";
  scene.world().bus().faults().add(rule);
  oldest = Duration(0);
  scene.run(3s);
  EXPECT_TRUE(std::isnan(scene.state("left").velocity));
  EXPECT_GT(oldest, 900ms);
  EXPECT_LE(oldest, 1004ms) << "a second, and the cycle that notices";
  EXPECT_NEAR(scene.position("left"), 1.0, 0.001) << "nothing moves by it";
}

}  // namespace
}  // namespace cia402
