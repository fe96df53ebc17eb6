// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace cia402::campaign {

/// A mode that an axis of a family can be in, and what its set-points are.
struct ModePlan {
  const char* name;
  char kind;  ///< p position, v velocity, t torque
};

/// What those who write robots of a drive family must know of it: what it wants to be told, what
/// its motor can do (`motor` of its simulated drive), and what can be done to it.
struct Family {
  const char* profile;
  double share;                  ///< of the axes of random robots that sit alone in their drive
  bool joint_units = false;      ///< floats at the joint's side of the gear; knows no limit switch
  std::vector<double> counts{};  ///< of a turn of the motor, to choose from
  double rated_torque = 1.0;     ///< N m of the motor
  double rated_acceleration = 1.0;  ///< turns/s^2 of the motor, by the rated torque
  double strongest = 1.0;           ///< of the rated torque
  double fastest = 1.0;             ///< turns/s that a robot may ask of the motor
  bool limits_effort = true;        ///< its limit of effort counts in all modes
  bool counts_sync = true;          ///< takes SYNC with a counter
  double hardest = 1e9;             ///< turns/s^2 that its objects hold, with twice that to stop
  bool long_range = true;           ///< its positions hold thousands of turns
  std::string options{};  ///< of the axis, as "key: value, "; what it has to say before enabling
  std::string writes{};   ///< entries of `write` of the axis
  /// Those that a history may ask for, the one that follows a stream of positions first.
  std::vector<ModePlan> modes{};
  bool names_modes = true;              ///< the axis lists them; else they are the profile's own
  std::string declares{};               ///< homing method that moves nothing; empty: none is named
  std::vector<std::string> searches{};  ///< homing methods that need no switch
  bool searches_switches = false;       ///< and 17 and 18
  std::vector<std::string> faults{};    ///< to inject
  std::vector<std::string> values{};    ///< to write: object and value
};

/// All families of config/drives.
const std::vector<Family>& families();
/// That of a profile. @pre there is one
const Family& family(const std::string& profile);

}  // namespace cia402::campaign
