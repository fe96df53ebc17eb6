// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How far and how long an axis may go on after a stop, and what its motor did. The bounds are those
// of docs/stops.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "stops/stop_run.h"

namespace cia402::stops {

/// From the stop to rest: rad, s, and the speed on the way, rad/s.
struct Bound {
  double distance = 0.0, time = 0.0, speed = 0.0;
};

/// A way to rest: on at `speed` for `reaction_s`, then by `deceleration`.
struct Braking {
  double reaction_s = 0.0, deceleration = 0.0;
};

constexpr double kCycleS = 0.004;
/// A set-point is computed and sent within a cycle, taken with the SYNC of the next, and followed
/// for one more.
constexpr double kReactionS = 3 * kCycleS;
/// The drive takes the master for lost after three heartbeats of 0.1 s.
constexpr double kMasterLostS = 0.3;

inline bool brakesByHaltBit(const Mover& mover) {
  return stopDrive(mover.drive).halt_bit_brakes_efforts && mover.mode != "cyclic_torque";
}

/// A set-point of profile position mode leads six cycles ahead of its stream, behind which the
/// motor is by three; the next one comes three cycles later.
constexpr double kSetPointsLeadS = 9 * kCycleS, kSetPointsApartS = 3 * kCycleS;

/// The mode that brakes an effort is asked for, shown and then given its first set-point.
constexpr double kModeChangeS = 3 * kCycleS;

/// What brakes an effort by a mode of velocities, whatever the stop.
inline Braking brakingByMode(Stop stop, const Mover& mover) {
  const bool ends = stop == Stop::end_of_stream || stop == Stop::set_mode;
  const double waits = ends ? toSeconds(kCommandTimeout) + kCycleS : 0.0;
  return {waits + kReactionS + kModeChangeS, mechanicsOf(mover.drive).acceleration};
}

inline Braking brakingOfOrphan(const Mover& mover) {
  const Mechanics& mechanics = mechanicsOf(mover.drive);
  const double quick = 2.0 * mechanics.acceleration;
  const bool interpolated = mover.mode == "interpolated_position";
  if (interpolated && stopDrive(mover.drive).sync_fault) return {3 * kCycleS, quick};
  if (mover.bySetPoints()) return {kSetPointsLeadS, mechanics.acceleration};
  if (mover.motion == Motion::stream) return {2 * kCycleS, mechanics.hardest()};
  const bool coasts = stopDrive(mover.drive).orphaned == Orphaned::coasts;
  return {kMasterLostS, coasts ? mechanics.friction() : quick};
}

/// What brakes, for a stop that comes in time.
inline Braking brakingOf(Stop stop, const Mover& mover) {
  const Mechanics& mechanics = mechanicsOf(mover.drive);
  const double ramp = mechanics.acceleration, quick = 2.0 * ramp;
  const bool effort = mover.motion == Motion::effort;
  const double effort_ramp = brakesByHaltBit(mover) ? ramp : quick;
  const bool by_fault = stop == Stop::fault || stop == Stop::coasting_fault;
  const bool by_mode = effort && stopDrive(mover.drive).efforts_by_mode;
  if (by_mode && !by_fault && stop != Stop::host_death) return brakingByMode(stop, mover);
  switch (stop) {
    case Stop::halt:
    case Stop::empty_trajectory:
      return {kReactionS, effort ? effort_ramp : ramp};
    case Stop::quick_stop:
    case Stop::disable:
      return {kReactionS, quick};
    case Stop::end_of_stream:
    case Stop::set_mode:
      if (mover.motion == Motion::stream) return {kReactionS + kCycleS, ramp};
      return {toSeconds(kCommandTimeout) + kReactionS + kCycleS, mover.coasts ? mechanics.friction()
                                                                 : effort     ? effort_ramp
                                                                              : ramp};
    case Stop::fault:
      return {0.001, quick};
    case Stop::coasting_fault:
      return {0.001,
              mechanics.friction() + stopDrive(mover.drive).dynamic_brake * mechanics.by_rated};
    case Stop::shutdown:
      if (effort || mover.motion == Motion::goal) return {kReactionS + kCycleS, quick};
      return {kReactionS, ramp};
    case Stop::host_death:
      return brakingOfOrphan(mover);
  }
  return {};
}

/// The motor behind its demand. A Damiao approaches a streamed target by a profile of its own, with
/// ten times the acceleration.
inline double lagOf(const Mover& mover) {
  const Mechanics& mechanics = mechanicsOf(mover.drive);
  double lag = mechanics.lag_s;
  if (stopDrive(mover.drive).float_numbers && mover.motion == Motion::stream) {
    lag += mover.speed / (2.0 * 10.0 * mechanics.acceleration);
  }
  return lag;
}

/// N m to rad/s², behind friction.
inline double pushOf(const Mover& mover) {
  if (mover.motion != Motion::effort || stopDrive(mover.drive).float_numbers)
    return 0.0;  // at its speed
  const Mechanics& mechanics = mechanicsOf(mover.drive);
  return mover.set_point / mechanics.rated * mechanics.by_rated - mechanics.friction();
}

inline Bound boundOf(Stop stop, const Mover& mover, double late_s) {
  const bool alone = stop == Stop::host_death && mover.motion == Motion::goal;
  if (alone && stopDrive(mover.drive).orphaned == Orphaned::goes_on) stop = Stop::set_mode;
  const Mechanics& mechanics = mechanicsOf(mover.drive);
  Braking braking = brakingOf(stop, mover);
  const double lag = lagOf(mover), settling = 8.0 * lag;
  double speed = mover.speed;
  const bool by_goal = mover.motion == Motion::goal && stopDrive(mover.drive).float_numbers;
  if (stop == Stop::set_mode && mover.motion == Motion::goal) {  // it goes on to its goal
    const double ramp = speed * speed / (2.0 * mechanics.acceleration);
    const double way = mover.set_point - ramp;
    return {way + 0.002, way / speed + speed / (2.0 * mechanics.acceleration) + late_s + settling,
            speed * 1.02};
  }
  const bool halts = stop == Stop::halt || stop == Stop::empty_trajectory;
  if (halts && by_goal) braking.reaction_s += 8 * kCycleS;  // the nearest goal
  const double reaction = braking.reaction_s + late_s;
  speed += pushOf(mover) * reaction;
  const double stopping = speed / braking.deceleration;
  return {1.02 * (speed * (reaction + lag) + 0.5 * speed * stopping) + 0.001,
          1.02 * (reaction + stopping) + settling, 1.02 * speed + 0.005};
}

/// A drive that gets no SYNC stands at its last target. Its next SYNC brings the one set-point that
/// was sent before.
inline bool starved(const Case& tested) {
  return tested.mover->motion == Motion::stream && !tested.mover->byVelocity() &&
         (tested.late > 0ms || tested.follower == Follower::host_death ||
          tested.stop == Stop::host_death);
}
/// The motor swings beyond the last target by what it cannot brake, once it has begun to.
inline double swingOf(const Mover& mover) {
  if (mover.bySetPoints()) return 0.0;  // it stops there by its ramp
  const Mechanics& mechanics = mechanicsOf(mover.drive);
  return mover.speed * mover.speed / (2.0 * mechanics.hardest()) + mover.speed * mechanics.lag_s;
}

/// The speed that one set-point gives it is braked by its own ramp.
inline double stepOf(const Mover& mover) {
  if (mover.bySetPoints()) return mover.speed * kSetPointsApartS;
  const Mechanics& mechanics = mechanicsOf(mover.drive);
  const double reached = mover.speed * (1.0 - std::exp(-kCycleS / mechanics.lag_s));
  return mover.speed * kCycleS +
         std::max(swingOf(mover), reached * reached / (4.0 * mechanics.acceleration));
}
/// The first set-point after a gap is compared with feedback from before it: by so much the
/// driver's own position loop may turn faster (`gain` of the profile, 1/s).
inline double hurryOf(const Mover& mover) {
  constexpr double kGain = 10.0;
  return mover.byVelocity() ? kGain * mover.speed * kReactionS : 0.0;
}

/// With what follows.
inline Bound boundOf(const Case& tested, const Trace& trace) {
  const double late = toSeconds(tested.late), after = toSeconds(tested.after);
  const Mover& mover = *tested.mover;
  Bound bound = boundOf(tested.stop, mover, late);
  const auto orElse = [&bound](const Bound& other) {
    bound.distance = std::max(bound.distance, other.distance);
    bound.time = std::max(bound.time, other.time);
    bound.speed = std::max(bound.speed, other.speed);
  };
  if (tested.follower == Follower::host_death) {
    orElse(boundOf(Stop::host_death, mover, late + after));
  }
  const StopDrive& drive = stopDrive(mover.drive);
  if (tested.follower == Follower::fault && drive.braked_fault == nullptr) {
    orElse(boundOf(Stop::coasting_fault, mover, late + after));
  }
  if (tested.follower == Follower::restart) {
    orElse(boundOf(Stop::quick_stop, mover, after));
    bound.time += after + 2 * kCycleS;  // the first SYNC of the new process, and its set-point
  }
  if (tested.late > 0ms) bound.speed += hurryOf(mover);
  // It was brought to speed by 0.8 of the limit, by which it fell behind: it makes that good.
  if (mover.bySetPoints()) bound.speed = 1.02 * mechanicsOf(mover.drive).velocity;
  if (starved(tested)) bound.time += 2.0 * mover.speed / mechanicsOf(mover.drive).hardest();
  if (!trace.taken) return bound;
  if (mover.motion == Motion::stream || mover.motion == Motion::goal) {
    const double way = *trace.taken - trace.samples.front().position;
    const Mechanics& mechanics = mechanicsOf(mover.drive);
    bound.distance = std::max(bound.distance, way + 0.002);
    bound.speed = 1.02 * mechanics.velocity;
    bound.time += way / mover.speed + mover.speed / mechanics.acceleration + after;
  } else {  // the stream ends with this one
    bound = boundOf(tested.stop, mover, late + after);
  }
  return bound;
}

/// What follows may take the power away from a motor that turns.
inline bool mayCoast(const Case& tested) {
  const StopDrive& drive = stopDrive(tested.mover->drive);
  const bool orphan = tested.stop == Stop::host_death || tested.follower == Follower::host_death ||
                      toSeconds(tested.late) > kMasterLostS;
  return tested.stop == Stop::coasting_fault ||
         (tested.follower == Follower::fault && drive.braked_fault == nullptr) ||
         (orphan && drive.orphaned == Orphaned::coasts);
}

struct Verdict {
  double distance = 0.0, time = 0.0;
  Bound bound;
  std::vector<std::string> findings;
};

constexpr double kSlow = 0.05;         ///< rad/s, below it the power stage may be switched
constexpr double kRest = 0.01;         ///< rad/s, below it an axis stands
constexpr double kTolerance = 0.0005;  ///< rad, that it may swing back

inline std::string number(double value) {
  char text[32];
  (void)std::snprintf(text, sizeof text, "%.4f", value);
  return text;
}

/// Success of these says that the axis stands; of `set_mode` where the power stage is on.
inline bool needsRest(const std::string& call, bool power) {
  return call == "halt" || call == "empty_trajectory" || call == "quick_stop" ||
         call == "set_position" || call == "disable" || (power && call == "set_mode");
}

inline Verdict judge(const Case& tested, const Trace& trace) {
  Verdict verdict;
  if (!trace.problem.empty()) {
    verdict.findings.push_back("cannot be played: " + trace.problem);
    return verdict;
  }
  verdict.bound = boundOf(tested, trace);
  const auto find = [&](std::string what) { verdict.findings.push_back(std::move(what)); };
  const Mover& mover = *tested.mover;
  const double swing = kTolerance + (starved(tested) ? swingOf(mover) : 0.0);
  const double step = 2 * kTolerance + (starved(tested) ? kTolerance + stepOf(mover) : 0.0);
  const double from = trace.samples.front().position;
  double furthest = from, back = 0.0, fastest = 0.0, stood = 0.0, again = 0.0;
  std::size_t quiet = 0, last = 0;
  bool rested = false;
  for (std::size_t i = 0; i < trace.samples.size(); ++i) {
    const auto& [position, velocity, power] = trace.samples[i];
    furthest = std::max(furthest, position);
    back = std::max(back, furthest - position);
    fastest = std::max(fastest, std::fabs(velocity));
    const bool still = std::fabs(velocity) <= kRest;
    const bool switched = i > 0 && power != trace.samples[i - 1].power;
    if (switched && std::fabs(velocity) > kSlow && (power || !mayCoast(tested))) {
      find(std::string(power ? "gets" : "loses") + " power at " + number(velocity) + " rad/s");
    }
    if (!still) last = i + 1;
    quiet = still ? quiet + 1 : 0;
    if (!rested && quiet >= 20) {
      rested = true;
      stood = position;
    }
    if (rested) again = std::max(again, std::fabs(position - stood));
  }
  verdict.distance = furthest - from;
  verdict.time = 0.001 * static_cast<double>(last);
  const Bound& bound = verdict.bound;
  if (verdict.distance > bound.distance) {
    find("goes on for " + number(verdict.distance) + " rad, bound " + number(bound.distance));
  }
  if (verdict.time > bound.time) {
    find("rests after " + number(verdict.time) + " s, bound " + number(bound.time));
  }
  if (fastest > bound.speed) {
    find("turns at " + number(fastest) + " rad/s, bound " + number(bound.speed));
  }
  if (back > swing) find("turns back by " + number(back) + " rad");
  if (!trace.taken && again > step) {
    find("starts again after it stood, by " + number(again) + " rad");
  }
  if (trace.unanswered) find("a call is not answered");
  for (const Trace::Answered& answer : trace.answers) {
    const double turning = std::fabs(trace.samples[answer.at].velocity);
    if (answer.success && needsRest(answer.call, answer.power) && turning > 2 * kRest) {
      find(answer.call + " is answered at " + number(turning) + " rad/s: " + answer.message);
    }
  }
  return verdict;
}

}  // namespace cia402::stops
