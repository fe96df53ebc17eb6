// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SYNC and interpolation of the SV660C under the driver: how far SYNC may be off, and what follows
// when the drive does not interpolate any more. And how its statusword is read.
#include "drive/axis/state_machine.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using testing::HasSubstr;
using testing::Not;

/// In ip, every 4 ms, with H0E.13 as given.
struct Sv660cSynced : Sv660cReady {
  explicit Sv660cSynced(int tolerance)
      : Sv660cReady(
            sv660cWrites("{object: sync_tolerance, raw: " + std::to_string(tolerance) + "}")) {
    world().bus().setMonitor([this](const can::Frame& frame, Time at) {
      if (frame.id != 0x080) return;
      if (last_ != Time{}) {
        shortest = std::min(shortest, at - last_);
        longest = std::max(longest, at - last_);
      }
      last_ = at;
    });
    run(100ms);
  }
  /// The next SYNC leaves so late.
  void delaySync(Duration late) {
    const Time seen = last_;
    while (last_ == seen) robot().run(100us);
    robot().freeze(last_ + 4ms + late - now());
    run(100ms);
  }
  Duration shortest{Duration::max()}, longest{0};

 private:
  Time last_{};
};

// A quarter of 4 ms is tolerated from the factory [L9661-9685].
TEST(Sv660cSync, OfTheDriverIsWithinTheToleranceOfTheFactory) {
  Sv660cSynced scene(0);
  ASSERT_TRUE(scene.move({1.5}, 3s).success);
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), 1.5, 1e-4) << scene.told();
  EXPECT_GT(scene.shortest, 3ms);
  EXPECT_LT(scene.longest, 5ms);
}

struct Sv660cLate {
  int tolerance;  // H0E.13
  Duration tolerated, beyond;
};

class Sv660cTolerance : public testing::TestWithParam<Sv660cLate> {};

TEST_P(Sv660cTolerance, IsWhatADriverMayBeLateBy) {
  {
    Sv660cSynced scene(GetParam().tolerance);
    scene.delaySync(GetParam().tolerated);
    EXPECT_EQ(scene.state("joint").state, State::operation_enabled) << scene.told();
    EXPECT_THAT(scene.told(), Not(HasSubstr("0x8700")));
  }
  if (GetParam().beyond == Duration(0)) return;
  Sv660cSynced scene(GetParam().tolerance);
  scene.delaySync(GetParam().beyond);
  EXPECT_EQ(scene.state("joint").state, State::fault) << scene.told();
  EXPECT_THAT(scene.told(), HasSubstr("the cause is that this program sent SYNC"));
}

INSTANTIATE_TEST_SUITE_P(
    OfH0E13, Sv660cTolerance,
    testing::Values(Sv660cLate{0, 700us, 1500us}, Sv660cLate{1, 1700us, 2500us},
                    Sv660cLate{2, 2700us, 3500us}, Sv660cLate{3, 3700us, 4500us},
                    Sv660cLate{4, 7700us, 8500us}, Sv660cLate{5, 20000us, Duration(0)}),
    [](const auto& tested) { return "Is" + std::to_string(tested.param.tolerance); });

/// On its way, when something happens.
struct Sv660cInterpolating : Sv660cReady {
  explicit Sv660cInterpolating(const std::string& with)
      : Sv660cReady(sv660cJoint(", mode: ip", "with: {" + with + "}")) {
    bus::TrajectoryCommand trajectory;
    trajectory.group = "arm";
    trajectory.joints = {"joint"};
    trajectory.points = {{{2.0}, {0.0}, {}, 4s}};
    answer_ = ask(trajectory);
    run(1500ms);
    EXPECT_GT(velocity("joint"), 0.4);
  }

 private:
  std::shared_ptr<std::optional<bus::TrajectoryAnswer>> answer_;
};

// Bit 12 goes: interpolation is interrupted, here by a terminal that inhibits position commands.
TEST(Sv660cInterpolation, ThatEndsEndsTheTrajectory) {
  Sv660cInterpolating scene("faults: {inhibit: {code: 0xFF00, warning: true, holds: true}}");
  ASSERT_NE(scene.truth("joint").statusword & 0x1000, 0);
  scene.inject("joint", "inhibit");
  scene.run(20ms);
  EXPECT_EQ(scene.truth("joint").statusword & 0x1000, 0);
  scene.run(1s);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
  const double stood = scene.position("joint");
  EXPECT_THAT(scene.told(), HasSubstr("joint (node 1)"));
  scene.inject("joint", "clear");
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), stood, 2e-3) << "nobody commanded that" << scene.told();
  ASSERT_EQ(scene.setpoint("joint", stood - 0.3), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), stood - 0.3, 1e-3) << "what is commanded since counts";
}

// Bit 13 [L942-949], of a drive that says no more than that.
TEST(Sv660cInterpolation, ThatStaysBehindEndsTheTrajectory) {
  Sv660cInterpolating scene("state_machine: {following_error_is_fault: false}");
  bool told = false;
  scene.watch([&] { told = told || (scene.truth("joint").statusword & 0x2000) != 0; });
  scene.inject("joint", "blocked_rotor");
  scene.run(1s);
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
  EXPECT_TRUE(told);
  const double stood = scene.position("joint");
  scene.inject("joint", "clear");
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), stood, 0.02) << scene.told();
}

// The patterns of the manual [L620-630]: each with every value of the bits that do not matter.
TEST(Sv660cStatusword, IsReadByThePatternsOfTheManual) {
  struct Pattern {
    const char* bits;  // 7 to 0
    State state;
  };
  constexpr Pattern kPatterns[] = {
      {"x0xx0000", State::not_ready_to_switch_on}, {"x1xx0000", State::switch_on_disabled},
      {"x01x0001", State::ready_to_switch_on},     {"x01x0011", State::switched_on},
      {"x01x0111", State::operation_enabled},      {"x00x0111", State::quick_stop_active},
      {"x0xx1111", State::fault_reaction_active},  {"x0xx1000", State::fault}};
  const auto fits = [](const char* bits, unsigned word) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      const char wanted = bits[7 - bit];
      if (wanted != 'x' && (wanted == '1') != (((word >> bit) & 1U) != 0)) return false;
    }
    return true;
  };
  unsigned told = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    State expected = State::unknown;
    for (const Pattern& pattern : kPatterns) {
      if (fits(pattern.bits, word)) expected = pattern.state;
    }
    if (expected == State::unknown) continue;  // the manual says nothing of it
    ASSERT_EQ(drive::decodeState(static_cast<std::uint16_t>(word)), expected) << word;
    ++told;
  }
  // Of eight bits: 8 + 8 + 4 + 4 + 4 + 4 + 8 + 8 words, each with 256 others.
  EXPECT_EQ(told, 48U * 256U);
}

// Its drive shows the bits that the manual leaves undefined as it likes: 8 and 14 [L599-618].
TEST(Sv660cStatusword, IsReadWhateverItsUndefinedBitsAre) {
  Sv660cReady scene(sv660cJoint({}, "with: {quirks: {vendor_bits: 0x4100}}"));
  ASSERT_EQ(scene.setpoint("joint", 0.5), "");
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.5, 1e-5) << scene.told();
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success) << scene.told();
}

}  // namespace
}  // namespace cia402
