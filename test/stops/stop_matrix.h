// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What is stopped, by what, and what happens just after: the cases of docs/stops.md.
#pragma once

#include <string>
#include <vector>

#include "stops/stop_drives.h"
#include "system/robot_fixture.h"

namespace cia402::stops {

using namespace std::chrono_literals;

/// What ends a motion.
enum class Stop {
  halt,
  quick_stop,
  disable,
  empty_trajectory,  ///< to the group of the joint, of which nobody leads it by a trajectory
  end_of_stream,
  set_mode,  ///< refused in motion; the stream ends with the call
  fault,     ///< to which the drive reacts by its ramp
  coasting_fault,
  shutdown,
  host_death,
};
constexpr Stop kStops[] = {
    Stop::halt,          Stop::quick_stop, Stop::disable, Stop::empty_trajectory,
    Stop::end_of_stream, Stop::set_mode,   Stop::fault,   Stop::coasting_fault,
    Stop::shutdown,      Stop::host_death};

/// What may come within 10 ms of it.
enum class Follower {
  nothing,
  halt,
  quick_stop,
  disable,
  set_mode,
  set_position,
  home,  ///< which declares the present position
  recover,
  enable,
  clear_faults,
  set_point,
  fault,
  shutdown,
  host_death,
  restart,  ///< of a process that died
};

inline const char* toString(Stop stop) {
  constexpr const char* kNames[] = {"halt",          "quick_stop", "disable", "empty_trajectory",
                                    "end_of_stream", "set_mode",   "fault",   "coasting_fault",
                                    "shutdown",      "host_death"};
  return kNames[static_cast<int>(stop)];
}

inline const char* toString(Follower follower) {
  constexpr const char* kNames[] = {"nothing",  "halt",         "quick_stop",   "disable",
                                    "set_mode", "set_position", "home",         "recover",
                                    "enable",   "clear_faults", "a set-point",  "a fault",
                                    "shutdown", "host death",   "a new process"};
  return kNames[static_cast<int>(follower)];
}

/// What the axis was given before the stop.
enum class Motion { stream, velocity, goal, effort };

/// One drive in one mode, and how it is brought to speed.
struct Mover {
  std::string drive, mode;
  Motion motion = Motion::stream;
  bool coasts = false;                                                   ///< command_timeout_action
  bool byVelocity() const { return mode == "position_by_velocity"; }     ///< the driver's loop
  bool bySetPoints() const { return mode == "position_by_set_points"; }  ///< of profile position
  double set_point = 0.0;  ///< rad/s of a stream or a velocity, rad of a goal, N m
  double speed = 0.0;      ///< rad/s that it runs at, when it is stopped
  std::string other_mode;  ///< for set_mode
  std::string name() const { return drive + "_" + mode + (coasts ? "_coasting" : ""); }
};

constexpr Duration kCycle = 4ms;
constexpr Duration kCommandTimeout = 60ms;

/// The mode in which the drive follows trajectories, without which no group has its joint.
inline std::string trajectoryMode(const Mover& mover) {
  if (mover.drive == "sv660c") return "interpolated_position";
  return mover.drive == "id286_cnfa" ? "position_by_velocity" : "cyclic_position";
}

/// @param grouped the joint is one of a group, too
inline std::string yamlOf(const Mover& mover, bool grouped) {
  const campaign::Family& family = campaign::family(mover.drive);
  const StopDrive& drive = stopDrive(mover.drive);
  std::string yaml =
      "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n" +
      std::string(grouped ? "groups: {arm: {joints: [joint]}}\n" : "") +
      "axes:\n"
      "  joint: {node_id: 1, command_timeout: 0.06, drive: " +
      mover.drive + ", mode: " + mover.mode + ", modes: [" + mover.mode + ", " + mover.other_mode +
      (grouped ? ", " + trajectoryMode(mover) : std::string()) + "],\n" + family.options;
  if (!family.writes.empty()) yaml += "    write: [" + family.writes + "],\n";
  if (mover.coasts) yaml += "    command_timeout_action: coast,\n";
  if (drive.float_numbers) {
    return yaml +
           "    homing: {required: false}, simulation: {time_constant: 0.005},\n"
           "    limits: {lower: -2.0, upper: 2.0, velocity: 2.0, acceleration: 15.0,\n"
           "             effort: 5.0}}\n";
  }
  const std::string declares = family.declares.empty() ? "37" : family.declares;
  return yaml + "    counts_per_turn: " + std::to_string(static_cast<long>(family.counts.back())) +
         ", gear_ratio: " + std::to_string(drive.mechanics.gear) +
         ", rated_torque: " + std::to_string(family.rated_torque) +
         ",\n"
         "    homing: {method: " +
         declares +
         ", required: false, search_velocity: 0.1, zero_velocity: 0.1,\n"
         "             acceleration: 1.0}, simulation: {time_constant: 0.004},\n"
         "    limits: {lower: -2.5, upper: 2.5, velocity: 1.5, acceleration: 6.0,\n"
         "             effort: " +
         drive.effort_limit + "}}\n";
}

/// Efforts accelerate a joint by 0.7 to 1.1 rad/s², but for the Damiao's.
inline std::vector<Mover> movers() {
  const std::string g = "generic_cia402", d = "damiao_dm", s = "sv660c", n = "nimotion_stepper",
                    i = "id286_cnfa", m = "megmeet_dm5";
  const std::string csp = "cyclic_position", csv = "cyclic_velocity", pv = "profile_velocity";
  const std::string ip = "interpolated_position", pp = "profile_position", pt = "profile_torque";
  return {
      {g, csp, Motion::stream, false, 1.2, 1.2, pv},
      {g, csv, Motion::velocity, false, 1.2, 1.2, pv},
      {g, ip, Motion::stream, false, 1.2, 1.2, pv},
      {g, pp, Motion::goal, false, 1.8, 1.5, pv},
      {g, "velocity", Motion::velocity, false, 1.2, 1.2, csp},
      {g, pv, Motion::velocity, false, 1.2, 1.2, csp},
      {g, pt, Motion::effort, false, 6.0, 0.5, csp},
      {g, "cyclic_torque", Motion::effort, false, 6.0, 0.5, csp},
      {g, "cyclic_torque", Motion::effort, true, 6.0, 0.5, csp},
      {d, csp, Motion::stream, false, 1.6, 1.6, pv},
      {d, csv, Motion::velocity, false, 1.6, 1.6, csp},
      {d, pp, Motion::goal, false, 1.8, 2.0, pv},
      {d, "position_velocity", Motion::goal, false, 1.8, 2.0, pv},
      {d, "position_velocity_torque", Motion::goal, false, 1.8, 2.0, pv},
      {d, pv, Motion::velocity, false, 1.6, 1.6, csp},
      {d, "velocity_torque", Motion::velocity, false, 1.6, 1.6, csp},
      {d, pt, Motion::effort, false, 0.2, 2.0, csp},
      {d, pt, Motion::effort, true, 0.2, 2.0, csp},
      {s, ip, Motion::stream, false, 1.2, 1.2, pv},
      {s, pp, Motion::goal, false, 1.8, 1.5, pv},
      {s, pv, Motion::velocity, false, 1.2, 1.2, ip},
      {s, csv, Motion::velocity, false, 1.2, 1.2, ip},
      {s, pt, Motion::effort, false, 10.0, 0.5, ip},
      {n, csp, Motion::stream, false, 1.2, 1.2, pv},
      {n, ip, Motion::stream, false, 1.2, 1.2, pv},
      {n, pp, Motion::goal, false, 1.8, 1.5, pv},
      {n, "velocity", Motion::velocity, false, 1.2, 1.2, csp},
      {n, pv, Motion::velocity, false, 1.2, 1.2, csp},
      {n, csv, Motion::velocity, false, 1.2, 1.2, csp},
      {i, "position_by_velocity", Motion::stream, false, 1.2, 1.2, pp},
      {i, "position_by_set_points", Motion::stream, false, 1.2, 1.2, pv},
      {i, pp, Motion::goal, false, 1.8, 1.5, pv},
      {i, pv, Motion::velocity, false, 1.2, 1.2, pp},
      {i, csv, Motion::velocity, false, 1.2, 1.2, pp},
      {i, pt, Motion::effort, false, 12.7, 0.5, pp},
      {m, csp, Motion::stream, false, 1.2, 1.2, pv},
      {m, pp, Motion::goal, false, 1.8, 1.5, pv},
      {m, pv, Motion::velocity, false, 1.2, 1.2, csp},
      {m, csv, Motion::velocity, false, 1.2, 1.2, csp},
      {m, pt, Motion::effort, false, 5.08, 0.5, csp},
      {m, "cyclic_torque", Motion::effort, false, 5.08, 0.5, csp},
  };
}

struct Case {
  Stop stop = Stop::halt;
  const Mover* mover = nullptr;
  Follower follower = Follower::nothing;
  Duration after{};              ///< of the stop, until what follows
  Duration late{}, late_from{};  ///< the process gets no processor for so long, from then on
  Duration young{};              ///< the stop comes so soon after the first set-point; 0: at speed
};

inline std::string text(Duration duration) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count()) +
         " ms";
}

inline std::string text(const Case& tested) {
  std::string text = std::string(toString(tested.stop)) + " in " + tested.mover->name();
  if (tested.follower != Follower::nothing) {
    text +=
        ", " + std::string(toString(tested.follower)) + " " + stops::text(tested.after) + " later";
  }
  if (tested.late > 0ms) {
    text += ", a cycle " + stops::text(tested.late) + " late from " +
            stops::text(tested.late_from) + " on";
  }
  if (tested.young > 0ms) text += ", " + stops::text(tested.young) + " after it set off";
  return text;
}

/// It turns on for ever without a master: only those stop that follow positions.
inline bool goesOnAlone(const Mover& mover) {
  const bool follows = mover.motion == Motion::stream && !mover.byVelocity();
  return stopDrive(mover.drive).orphaned == Orphaned::goes_on && !follows &&
         mover.motion != Motion::goal;
}

/// Whether the stop means anything there.
inline bool applies(Stop stop, const Mover& mover) {
  if (stop == Stop::end_of_stream) return mover.motion != Motion::goal;
  if (stop == Stop::fault && stopDrive(mover.drive).braked_fault == nullptr) return false;
  if (stop == Stop::host_death && goesOnAlone(mover)) return false;
  return !mover.coasts;
}

/// @param whole with everything late that there is, else with a quarter of it.
inline std::vector<Case> casesOf(Stop stop, const Mover& mover, bool whole) {
  std::vector<Case> cases;
  int count = 0;
  const auto add = [&](Follower follower, Duration after, std::initializer_list<Duration> froms) {
    cases.push_back({stop, &mover, follower, after, 0ms, 0ms, 0ms});
    if (stop == Stop::host_death) return;  // no cycle is left that could be late
    for (const Duration late : {20ms, 60ms, 150ms}) {
      for (const Duration from : froms) {
        const bool chosen = whole || follower == Follower::nothing || ++count % 4 == 0;
        if (chosen) cases.push_back({stop, &mover, follower, after, late, from, 0ms});
      }
    }
  };
  add(Follower::nothing, 0ms, {1ms, 4ms, 7ms, 10ms});  // each phase of the cycle
  const int last = static_cast<int>(Follower::restart);
  for (int i = 1; i <= last; ++i) {
    const auto follower = static_cast<Follower>(i);
    const bool restarts = follower == Follower::restart;
    if (restarts != (stop == Stop::host_death)) continue;  // nobody is there to be called
    if (follower == Follower::host_death && goesOnAlone(mover)) continue;
    add(follower, 3ms, {1ms, 7ms});
    add(follower, 8ms, {4ms, 10ms});
  }
  const bool by_fault = stop == Stop::fault || stop == Stop::coasting_fault;
  const bool goes_on = stop == Stop::set_mode && mover.motion == Motion::goal;
  if (by_fault || goes_on || stop == Stop::host_death) return cases;
  for (const Duration young : {4ms, 8ms, 16ms, 32ms}) {  // feedback does not show it yet
    for (const Follower follower : {Follower::nothing, Follower::halt, Follower::set_position}) {
      cases.push_back({stop, &mover, follower, 3ms, 0ms, 0ms, young});
    }
  }
  return cases;
}

}  // namespace cia402::stops
