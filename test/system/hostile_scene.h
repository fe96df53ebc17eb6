// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "system/scene.h"

namespace cia402::hostile {

constexpr double kCycle = 0.004;  // s
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

struct Joint {
  const char* name;
  unsigned node;
  double lower, upper, velocity, acceleration, jerk, effort;
  bool floats;  ///< its objects hold IEEE floats in rad and N m, else counts
};

/// Two drives that count, the first with a limit of jerk, and one of floats.
constexpr std::array<Joint, 3> kJoints = {{
    {"smooth", 1, -0.5, 0.4, 1.5, 10.0, 400.0, 60.0, false},
    {"stiff", 2, -0.3, 0.6, 1.2, 12.0, kNoLimit, 60.0, false},
    {"direct", 4, -0.45, 0.45, 2.0, 15.0, kNoLimit, 5.0, true},
}};

/// A mode of the joints, and where its target travels: behind the controlword in RPDO 1.
struct Mode {
  std::array<const char*, kJoints.size()> names;
  std::uint16_t object;
  unsigned bytes;           ///< of the drives that count
  double numbers_per_unit;  ///< of these: rad, rad/s or N m
};

constexpr double kCounts = 131072.0 * 100.0 / 6.283185307179586;
constexpr Mode kPosition{{"csp", "csp", "csp"}, 0x607A, 4, kCounts};
constexpr Mode kVelocity{{"csv", "csv", "csv"}, 0x60FF, 4, kCounts};
/// In thousandths of 0.64 N m on 100 turns of the motor.
constexpr Mode kEffort{{"pt", "cst", "profile_torque"}, 0x6071, 2, 1000.0 / 64.0};

/// The mode whose drive gets no limit of speed of its own.
constexpr std::string_view kLifted = "cst";
constexpr double kTimeout = 0.05;  // s, command_timeout

inline std::string axis(const Joint& joint, const char* mode) {
  const auto text = [](double value) { return std::to_string(value); };
  std::string yaml =
      "  " + std::string(joint.name) + ": {node_id: " + std::to_string(joint.node) +
      ", mode: " + mode + ", modes: [" + mode + ", csp]" + ", command_timeout: " + text(kTimeout) +
      ", limits: {lower: " + text(joint.lower) + ", upper: " + text(joint.upper) +
      ", velocity: " + text(joint.velocity) + ", acceleration: " + text(joint.acceleration) +
      ", effort: " + text(joint.effort);
  if (std::isfinite(joint.jerk)) yaml += ", jerk: " + text(joint.jerk);
  if (joint.floats) return yaml + "}, drive: damiao_dm, simulation: {time_constant: 0.005}}\n";
  yaml +=
      "}, drive: generic_cia402, counts_per_turn: 131072, gear_ratio: 100.0, rated_torque: 0.64";
  return yaml + (mode == kLifted ? ", write: [{object: \"6080:00\", raw: 600000}]}\n" : "}\n");
}

inline std::string robot(const Mode& mode) {
  std::string yaml =
      "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
      "axes:\n";
  for (std::size_t i = 0; i < kJoints.size(); ++i) yaml += axis(kJoints[i], mode.names[i]);
  return yaml +
         "groups:\n  all: {joints: [smooth, stiff, direct], allow_partial_joints_goal: true}\n";
}

/// The number in a frame, as CiA 301 has it: the lowest byte first.
inline std::uint32_t bitsAt(const can::Frame& frame, unsigned place, unsigned bytes) {
  std::uint32_t bits = 0;
  for (unsigned i = 0; i < bytes; ++i) bits |= std::uint32_t{frame.data[place + i]} << (8 * i);
  return bits;
}
inline double integer(const can::Frame& frame, unsigned bytes) {
  const std::uint32_t bits = bitsAt(frame, 2, bytes);
  return bytes == 2 ? static_cast<std::int16_t>(bits) : static_cast<std::int32_t>(bits);
}
inline double real(const can::Frame& frame, unsigned place) {
  const std::uint32_t bits = bitsAt(frame, place, 4);
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

/// What the targets of a joint may be: each one, and their differences of rising order from SYNC to
/// SYNC.
struct Bounds {
  double lowest, highest;
  std::array<double, 3> differences;
};

/// Holds the targets of one joint, as they are on the wire, against its bounds.
class TargetWatch {
 public:
  TargetWatch(const Joint& joint, const Mode& mode, const Bounds& bounds)
      : joint_(joint),
        mode_(mode),
        bounds_(bounds),
        grain_(joint.floats ? std::ldexp(std::max(1.0, bounds.highest), -23)
                            : 1.0 / mode.numbers_per_unit) {}

  /// A frame of its RPDO 1. @return what is wrong with it; empty: nothing
  std::string look(const can::Frame& frame, Time time) {
    const unsigned bytes = joint_.floats ? 4 : mode_.bytes;
    if (frame.size < 2 + bytes) return "RPDO 1 of " + std::to_string(frame.size) + " bytes";
    const double since = toSeconds(time - std::exchange(came_, time));
    if (known_ && std::fabs(since - kCycle) > 0.1 * kCycle) {
      return "a target " + std::to_string(since) + " s after the one before";
    }
    const double target =
        joint_.floats ? real(frame, 2) : integer(frame, bytes) / mode_.numbers_per_unit;
    if (!std::isfinite(target)) return "a target that is not finite";
    lowest = std::min(lowest, target);
    highest = std::max(highest, target);
    if (target < bounds_.lowest - grain_ || target > bounds_.highest + grain_) {
      return "a target of " + std::to_string(target);
    }
    return differ(target);
  }
  void forget() {
    lowest = 1e9;
    highest = -1e9;
  }
  double lowest = 1e9, highest = -1e9;  ///< targets, since forget()

 private:
  /// Each target is rounded to half a grain, so that differences are off by a grain, two and four.
  std::string differ(double value) {
    std::string wrong;
    double rounding = grain_;
    for (std::size_t i = 0; i < last_.size(); ++i, rounding *= 2.0) {
      const double difference = known_ ? value - last_[i] : 0.0;
      last_[i] = std::exchange(value, difference);
      if (std::fabs(difference) > bounds_.differences[i] + rounding && wrong.empty()) {
        wrong = "difference " + std::to_string(i + 1) + " of its targets is " +
                std::to_string(1e6 * difference) + "e-6, beyond " +
                std::to_string(1e6 * bounds_.differences[i]) + "e-6";
      }
    }
    known_ = true;
    return wrong;
  }

  const Joint& joint_;
  const Mode& mode_;
  Bounds bounds_;
  /// A count of the drive; of floats the distance between two of them, at the most.
  double grain_;
  bool known_ = false;
  Time came_{};
  std::array<double, 3> last_{};  ///< the target, and its differences
};

}  // namespace cia402::hostile
