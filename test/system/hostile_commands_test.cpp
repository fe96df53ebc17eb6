// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Commands that no reasonable program gives, without end: the targets on the wire, and the motors,
// keep to the limits all the same. Nothing is reset between the sequences.
//
// A sequence is ten cycles, in each of which a joint gets a command more often than not. The seeds
// of a kind together run some thousands of them, or as many as CIA402_HOSTILE_SEQUENCES says, e.g.
// for a quarter of a million of velocities:
//   CIA402_HOSTILE_SEQUENCES=1000000 test_system --gtest_filter='*HostileCommands.*/velocity_2'
#include <cstdlib>
#include <ostream>
#include <tuple>
#include <vector>

#include "system/hostile_storm.h"

namespace cia402::hostile {
namespace {

using drive::ProcedureKind;

constexpr unsigned kSeeds = 4;
constexpr int kCyclesOfSequence = 10;

int sequencesOfSeed(int round) {
  const char* const given = std::getenv("CIA402_HOSTILE_SEQUENCES");
  return std::max(round, given != nullptr ? std::atoi(given) / static_cast<int>(kSeeds) : 0);
}

/// A kind of command: how it attacks, and what the joints keep to.
struct Kind {
  const char* name;
  const Mode& mode;
  void (Storm::*attack)(int cycle);
  bool jerk;         ///< its limit counts: of streams
  double rest{0.0};  ///< rad/s, a velocity from which one may leave as if it were none

  bool pushes() const { return mode.object == kEffort.object; }
  /// Sequences, after which it is looked whether the joints are still enabled, and were led to
  /// their limits: efforts seldom lead as far, and most of them are refused there.
  int round() const { return pushes() ? 3000 : 750; }
};
std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }

constexpr Kind kCommands[] = {
    {"position", kPosition, &Storm::attackAxes, true},
    {"velocity", kVelocity, &Storm::attackAxes, true},
    {"effort", kEffort, &Storm::attackAxes, false},
    {"group_position", kPosition, &Storm::attackGroup, true},
    {"group_velocity", kVelocity, &Storm::attackGroup, true},
    {"group_effort", kEffort, &Storm::attackGroup, false},
    {"trajectory", kPosition, &Storm::attackByTrajectories, false,
     motion::Trajectory::kRestVelocity},
};

Bounds boundsOf(const Kind& kind, const Joint& joint) {
  const double gain = joint.acceleration * kCycle + kind.rest;  // of velocity in a cycle
  const double change = kind.jerk ? joint.jerk * kCycle * kCycle : kNoLimit;
  if (kind.pushes()) return {-joint.effort, joint.effort, {kNoLimit, kNoLimit, kNoLimit}};
  if (kind.mode.object == kVelocity.object) {
    return {-joint.velocity, joint.velocity, {gain, change, kNoLimit}};
  }
  return {joint.lower, joint.upper, {joint.velocity * kCycle, gain * kCycle, change * kCycle}};
}

/// What a motor may do that is led within the limits, or pushed.
struct Allowed {
  double beyond, speed;  ///< rad beyond a limit of position, rad/s
};

Allowed allowedBy(const Kind& kind, std::size_t index) {
  const Joint& joint = kJoints[index];
  if (!kind.pushes()) return {1e-4, 1.001 * joint.velocity};
  constexpr double kBeyond = 0.1;  // rad, of a brake that begins late; see EffortLimits
  // Drives keep to their own limit, but for the one whose limit was lifted: the driver notices its
  // speed late. Its rotor gets 300 turns/s^2 from 64 N m, on 100 turns.
  const double pushed = joint.effort / 64.0 * 3.0 * 6.283185307179586;
  const bool lifted = kind.mode.names[index] == kLifted;
  return {kBeyond, lifted ? joint.velocity + 4.0 * kCycle * pushed : 1.051 * joint.velocity};
}

/// A float in an RPDO.
struct FloatPlace {
  std::uint32_t cob_id;
  unsigned byte;
};

using Tested = std::tuple<Kind, unsigned>;

class HostileCommands : public testing::TestWithParam<Tested> {
 protected:
  HostileCommands() {
    for (std::size_t i = 0; i < kJoints.size(); ++i) {
      targets_.emplace_back(kJoints[i], kind_.mode, boundsOf(kind_, kJoints[i]));
      allowed_.push_back(allowedBy(kind_, i));
    }
  }
  void begin();
  void findTargets();
  void findFloats(const Joint& joint);
  void runSequence();
  void look(const can::Frame& frame, Time time);
  void lookAtMotors();
  void enableAgain();
  bool ready();
  void expectReached();
  std::uint64_t object(const Joint& joint, unsigned index, unsigned sub) {
    const fieldbus::ObjectId id{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)};
    return scene_.drive(joint.name).dictionary().find(id)->number;
  }
  void blame(std::size_t joint, const std::string& what) {
    if (wrong_.empty()) wrong_ = std::string(kJoints[joint].name) + ": " + what;
  }

  const Kind kind_ = std::get<0>(GetParam());
  const unsigned seed_ = std::get<1>(GetParam());
  Scene scene_{loadText(robot(kind_.mode))};
  Storm storm_{scene_, kind_.mode, seed_};
  std::mt19937 moments_{seed_};
  std::vector<TargetWatch> targets_;
  std::vector<Allowed> allowed_;
  std::vector<FloatPlace> floats_;
  std::array<Scene::Seen, kJoints.size()> motors_;
  std::string wrong_;
  int sequence_ = 0, cycle_ = 0;
};

void HostileCommands::begin() {
  ASSERT_TRUE(scene_.boot()) << scene_.told();
  const bus::Answer enabled = scene_.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  scene_.run(std::chrono::milliseconds(100));
  ASSERT_NO_FATAL_FAILURE(findTargets());
  scene_.world().bus().setMonitor(
      [this](const can::Frame& frame, Time time) { look(frame, time); });
}

/// The drives take them from where the watches look for them.
void HostileCommands::findTargets() {
  for (const Joint& joint : kJoints) {
    const unsigned bits = 8 * (joint.floats ? 4 : kind_.mode.bytes);
    ASSERT_EQ(object(joint, 0x1400, 1) & 0x800007FF, 0x200 + joint.node);
    ASSERT_EQ(object(joint, 0x1600, 1), 0x60400010U);
    ASSERT_EQ(object(joint, 0x1600, 2), (std::uint64_t{kind_.mode.object} << 16) | bits);
    if (joint.floats) findFloats(joint);
  }
  ASSERT_FALSE(floats_.empty());
}

/// Whatever of such a drive has 32 bits and is mapped is a float.
void HostileCommands::findFloats(const Joint& joint) {
  for (unsigned rpdo = 0; rpdo < 4; ++rpdo) {
    const std::uint64_t cob_id = object(joint, 0x1400 + rpdo, 1);
    if ((cob_id & 0x80000000U) != 0) continue;
    unsigned bit = 0;
    for (unsigned i = 1; i <= object(joint, 0x1600 + rpdo, 0); ++i) {
      const auto bits = static_cast<unsigned>(object(joint, 0x1600 + rpdo, i) & 0xFF);
      if (bits == 32) floats_.push_back({static_cast<std::uint32_t>(cob_id & 0x7FF), bit / 8});
      bit += bits;
    }
  }
}

void HostileCommands::look(const can::Frame& frame, Time time) {
  for (std::size_t i = 0; i < kJoints.size(); ++i) {
    if (frame.id != 0x200 + kJoints[i].node) continue;
    const std::string what = targets_[i].look(frame, time);
    if (!what.empty()) blame(i, what);
  }
  for (const FloatPlace& place : floats_) {
    if (frame.id != place.cob_id) continue;
    if (!std::isfinite(real(frame, place.byte))) blame(2, "a float that is not finite");
  }
}

void HostileCommands::lookAtMotors() {
  for (std::size_t i = 0; i < kJoints.size(); ++i) {
    const Joint& joint = kJoints[i];
    const double position = scene_.position(i), speed = std::fabs(scene_.velocity(i));
    Scene::Seen& seen = motors_[i];
    seen.lowest = std::min(seen.lowest, position);
    seen.highest = std::max(seen.highest, position);
    seen.fastest = std::max(seen.fastest, speed);
    const double beyond = std::max(position - joint.upper, joint.lower - position);
    if (beyond > allowed_[i].beyond) blame(i, "its motor is beyond by " + std::to_string(beyond));
    if (speed > allowed_[i].speed) blame(i, "its motor turns at " + std::to_string(speed));
  }
}

void HostileCommands::runSequence() {
  storm_.beginSequence();
  const auto period = std::chrono::duration_cast<Duration>(std::chrono::milliseconds(4));
  for (cycle_ = 0; cycle_ < kCyclesOfSequence; ++cycle_) {
    const Duration before{
        std::uniform_int_distribution<Duration::rep>(0, period.count() - 1)(moments_)};
    scene_.robot().run(before);
    (storm_.*kind_.attack)(cycle_);
    scene_.robot().run(period - before);
    lookAtMotors();
    ASSERT_EQ(wrong_, "") << "seed " << seed_ << ", sequence " << sequence_ << ", cycle " << cycle_;
  }
  if (kind_.pushes()) enableAgain();
}

/// What nothing but a quick stop brakes is enabled again.
void HostileCommands::enableAgain() {
  for (const Joint& joint : kJoints) {
    const drive::Axis& axis = scene_.axis(joint.name);
    if (axis.state().ready_for_motion || axis.procedure().running) continue;
    (void)scene_.begin(ProcedureKind::enable, joint.name);
  }
}

bool HostileCommands::ready() {
  if (kind_.pushes()) enableAgain();
  return std::all_of(kJoints.begin(), kJoints.end(), [this](const Joint& joint) {
    return scene_.state(joint.name).ready_for_motion;
  });
}

void HostileCommands::expectReached() {
  for (std::size_t i = 0; i < kJoints.size(); ++i) {
    const Joint& joint = kJoints[i];
    Scene::Seen& motor = motors_[i];
    EXPECT_GT(motor.fastest, 0.9 * joint.velocity) << joint.name;
    EXPECT_LT(motor.lowest, joint.lower + 0.05) << joint.name;
    EXPECT_GT(motor.highest, joint.upper - 0.05) << joint.name;
    const Bounds bounds = boundsOf(kind_, joint);
    const double middle = 0.5 * (bounds.lowest + bounds.highest);
    EXPECT_LT(targets_[i].lowest - middle, 0.9 * (bounds.lowest - middle)) << joint.name;
    EXPECT_GT(targets_[i].highest - middle, 0.9 * (bounds.highest - middle)) << joint.name;
    motor = {};
    targets_[i].forget();
  }
}

TEST_P(HostileCommands, ExceedNoLimit) {
  ASSERT_NO_FATAL_FAILURE(begin());
  const int all = sequencesOfSeed(kind_.round());
  for (sequence_ = 0; sequence_ < all; ++sequence_) {
    ASSERT_NO_FATAL_FAILURE(runSequence());
    if ((sequence_ + 1) % kind_.round() != 0) continue;
    const Duration enabling = std::chrono::seconds(kind_.pushes() ? 2 : 0);
    ASSERT_TRUE(scene_.runUntil([this] { return ready(); }, enabling)) << scene_.told();
    expectReached();
    ASSERT_FALSE(HasFailure()) << "seed " << seed_ << ", until sequence " << sequence_;
  }
  EXPECT_EQ(scene_.badFloats(), 0U);
  EXPECT_GT(storm_.refused, 0U);
  EXPECT_GT(storm_.given, storm_.refused);
  RecordProperty("given", std::to_string(storm_.given));
  RecordProperty("refused", std::to_string(storm_.refused));
}

INSTANTIATE_TEST_SUITE_P(Kinds, HostileCommands,
                         testing::Combine(testing::ValuesIn(kCommands),
                                          testing::Range(1U, kSeeds + 1)),
                         [](const auto& tested) {
                           return std::get<0>(tested.param).name + std::string("_") +
                                  std::to_string(std::get<1>(tested.param));
                         });

}  // namespace
}  // namespace cia402::hostile
