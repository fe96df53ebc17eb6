// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The drives of the matrix of stops: what their joints are made of, and what they do by their
// makers' manuals where a stop is not the driver's alone.
#pragma once

#include <map>
#include <string>

#include "campaign/families.h"

namespace cia402::stops {

constexpr double kTurn = 6.283185307179586;

/// What a drive does once its master is gone.
enum class Orphaned {
  brakes,   ///< by 6085h, three heartbeats later
  coasts,   ///< three heartbeats later
  goes_on,  ///< it watches no master
};

/// What the robots below are made of, rad and s.
struct Mechanics {
  double velocity, acceleration;  ///< limits of the axis
  double gear;                    ///< turns of the motor for one of the joint, where it counts
  double lag_s;                   ///< of the motor behind its demand
  double rated;                   ///< N m of the joint
  double by_rated;        ///< rad/s² of the joint by it; `motor` of config/simulated_drives
  double friction_share;  ///< of the rated torque
  double strongest;       ///< of the rated torque, by the limit of effort or the motor's own

  double friction() const { return friction_share * by_rated; }  ///< of a motor that coasts
  double hardest() const { return strongest * by_rated; }        ///< as it brakes at most
};

struct StopDrive {
  Mechanics mechanics;
  const char* effort_limit;
  const char* braked_fault;  ///< nullptr: each of its faults lets the motor go
  const char* coasting_fault;
  Orphaned orphaned = Orphaned::brakes;
  bool halt_bit_brakes_efforts = false;
  bool efforts_by_mode = false;  ///< `stop_mode` of its profile brakes them
  bool float_numbers =
      false;  ///< at the joint's side of the gear, and approaches its targets itself
  double dynamic_brake = 0.0;  ///< of the rated torque, by which its coasting_fault ends
  bool sync_fault = false;     ///< where SYNC is late in interpolated position mode
};

inline Mechanics geared(double rated, double turns_per_s2, double friction, double strongest,
                        double gear = 100.0) {
  return {1.5, 6.0, gear, 0.004, rated * gear, turns_per_s2 * kTurn / gear, friction, strongest};
}

inline const StopDrive& stopDrive(const std::string& profile) {
  static const std::map<std::string, StopDrive> kDrives = [] {
    std::map<std::string, StopDrive> drives;
    StopDrive generic{geared(0.64, 300.0, 0.05, 120.0 / 64.0), "120.0", "following_error",
                      "encoder"};
    generic.halt_bit_brakes_efforts = true;
    drives["generic_cia402"] = generic;
    // Its hardest braking is that of 5 N m.
    StopDrive damiao{{2.0, 15.0, 1.0, 0.005, 3.0, 400.0 * kTurn, 0.02, 150.0 / (400.0 * kTurn)},
                     "5.0",
                     "following_error",
                     "encoder"};
    damiao.float_numbers = true;
    drives["damiao_dm"] = damiao;
    StopDrive sv660c{geared(2.39, 1000.0, 0.03, 450.0 / 239.0), "450.0", "following_error",
                     "encoder"};
    sv660c.orphaned = Orphaned::goes_on;
    sv660c.efforts_by_mode = true;
    sv660c.dynamic_brake = 0.3;
    sv660c.sync_fault = true;
    drives["sv660c"] = sv660c;
    // Its 600/min are 1.57 rad/s behind this gear; 605Eh, which it has for reading only, says
    // "coasts".
    StopDrive nimotion{geared(1.27, 300.0, 0.03, 2.0, 40.0), "101.6", nullptr, "over_current"};
    nimotion.orphaned = Orphaned::goes_on;
    drives["nimotion_stepper"] = nimotion;
    StopDrive id286{geared(1.27, 250.0, 0.05, 1.2), "152.4", nullptr, "encoder"};
    id286.orphaned = Orphaned::goes_on;  // it has no 1016h
    id286.efforts_by_mode = true;
    drives["id286_cnfa"] = id286;
    StopDrive dm5{geared(1.27, 1740.0, 0.03, 240.0 / 127.0), "240.0", nullptr, "encoder"};
    dm5.orphaned = Orphaned::coasts;
    dm5.efforts_by_mode = true;
    drives["megmeet_dm5"] = dm5;
    return drives;
  }();
  return kDrives.at(profile);
}

inline const Mechanics& mechanicsOf(const std::string& profile) {
  return stopDrive(profile).mechanics;
}

}  // namespace cia402::stops
