// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "system/families_scene.h"

namespace cia402 {

constexpr double kTurnOfMotor = 6.283185307179586 / 50.0;  ///< of the motor, in rad of the joint
constexpr double kReadAtHome = 0.25;                     ///< what the joint is to read at home, rad
constexpr double kSearchSpeed = 0.8, kZeroSpeed = 0.16;  ///< rad/s

/// Switches in turns of the motor: limits at -2 and 5, home from 1 to 2.6, index pulses at 0.3
/// turns after each whole one. From the search speed the motor stops within 0.64 turns.
struct FamilyHome {
  int method;
  double start, home;  ///< turns of the motor
};

/// Methods 17 to 30: limit switches and home switch, by the edge itself.
inline std::vector<FamilyHome> homesByEdges() {
  constexpr double kBelow = 0.0, kOn = 1.8, kAbove = 3.6;  // the home switch
  return {{17, kBelow, -2.0}, {17, -2.4, -2.0},  {18, kAbove, 5.0}, {18, 5.4, 5.0},
          {19, kBelow, 1.0},  {19, kOn, 1.0},    {20, kBelow, 1.0}, {20, kOn, 1.0},
          {21, kAbove, 2.6},  {21, kOn, 2.6},    {22, kAbove, 2.6}, {22, kOn, 2.6},
          {23, kBelow, 1.0},  {23, kOn, 1.0},    {23, kAbove, 1.0}, {24, kBelow, 1.0},
          {24, kOn, 1.0},     {24, kAbove, 1.0}, {25, kBelow, 2.6}, {25, kOn, 2.6},
          {25, kAbove, 2.6},  {26, kBelow, 2.6}, {26, kOn, 2.6},    {26, kAbove, 2.6},
          {27, kBelow, 2.6},  {27, kOn, 2.6},    {27, kAbove, 2.6}, {28, kBelow, 2.6},
          {28, kOn, 2.6},     {28, kAbove, 2.6}, {29, kBelow, 1.0}, {29, kOn, 1.0},
          {29, kAbove, 1.0},  {30, kBelow, 1.0}, {30, kOn, 1.0},    {30, kAbove, 1.0}};
}

/// Methods of which all manuals that have them say the same: with the index pulse, and 35.
inline std::vector<FamilyHome> homesByIndex() {
  constexpr double kBelow = 0.0, kOn = 1.8, kAbove = 3.6;
  return {
      {1, kBelow, -1.7}, {1, -2.4, -1.7},  {2, kAbove, 4.3},  {2, 5.4, 4.3},     {3, kBelow, 0.3},
      {3, kOn, 0.3},     {4, kBelow, 1.3}, {4, kOn, 1.3},     {5, kAbove, 3.3},  {5, kOn, 3.3},
      {6, kAbove, 2.3},  {6, kOn, 2.3},    {7, kBelow, 0.3},  {7, kOn, 0.3},     {8, kBelow, 1.3},
      {8, kOn, 1.3},     {8, kAbove, 1.3}, {9, kBelow, 2.3},  {9, kOn, 2.3},     {9, kAbove, 2.3},
      {12, kBelow, 2.3}, {12, kOn, 2.3},   {12, kAbove, 2.3}, {13, kBelow, 1.3}, {13, kOn, 1.3},
      {13, kAbove, 1.3}, {33, 1.8, 1.3},   {34, 1.8, 2.3},    {35, 1.8, 1.8}};
}

/// Methods that leave the home switch before they look for the index pulse.
inline std::vector<FamilyHome> homesOffTheSwitch() {
  constexpr double kBelow = 0.0, kOn = 1.8, kAbove = 3.6;
  return {{7, kAbove, 0.3},  {10, kBelow, 3.3}, {10, kOn, 3.3},    {10, kAbove, 3.3},
          {11, kBelow, 3.3}, {11, kOn, 3.3},    {11, kAbove, 3.3}, {14, kBelow, 0.3},
          {14, kOn, 0.3},    {14, kAbove, 0.3}};
}

/// The same as the DM5 prints them, where the index pulse may be one on the switch. By the search
/// speed it comes to rest 0.64 turns behind the edge that it met.
inline std::vector<FamilyHome> homesOnTheSwitch() {
  constexpr double kBelow = 0.0, kOn = 1.8, kAbove = 3.6;
  return {{7, kAbove, 2.3},  {10, kBelow, 1.3}, {10, kOn, 2.3},    {10, kAbove, 2.3},
          {11, kBelow, 1.3}, {11, kOn, 2.3},    {11, kAbove, 2.3}, {14, kBelow, 1.3},
          {14, kOn, 1.3},    {14, kAbove, 2.3}};
}

/// Starts for which the DM5 alone prints a way: the home switch behind the joint, no index pulse
/// before the limit switch, and one right here, of which the rotor is at the far end.
inline std::vector<FamilyHome> homesByTurning() {
  constexpr double kEnd = 4e-7;
  return {{4, 3.6, 1.3},
          {33, -1.8, -1.7},
          {34, 4.6, 4.3},
          {33, 1.3 - kEnd, 1.3},
          {34, 1.3 + kEnd, 1.3}};
}

struct FamilyHoming {
  FamilyMode tested;
  const char* switches;  ///< what the family wants to be told of them, as options of the axis
  FamilyHome home;
};

inline void PrintTo(const FamilyHoming& homing, std::ostream* out) {
  *out << homing.tested.family << " method " << homing.home.method << " from " << homing.home.start;
}

inline std::vector<FamilyHoming> withFamily(const FamilyMode& tested, const char* switches,
                                            const std::vector<FamilyHome>& homes) {
  std::vector<FamilyHoming> all;
  for (const FamilyHome& home : homes) all.push_back({tested, switches, home});
  return all;
}

inline std::string homingJoint(const FamilyHoming& homing) {
  const auto place = [](double turns) { return std::to_string(turns * kTurnOfMotor); };
  std::ostringstream start;  // exact: an index pulse is narrow
  start << std::setprecision(17) << homing.home.start * kTurnOfMotor;
  return familyJoint(
      homing.tested,
      ", homing: {method: " + std::to_string(homing.home.method) + ", offset: " +
          std::to_string(kReadAtHome) + ", search_velocity: " + std::to_string(kSearchSpeed) +
          ", zero_velocity: " + std::to_string(kZeroSpeed) + ", acceleration: 4.0}" +
          homing.switches + ", simulation: {initial_position: " + start.str() +
          ", lower_limit_switch: " + place(-2.0) + ", upper_limit_switch: " + place(5.0) +
          ", home_switch: [" + place(1.0) + ", " + place(2.6) + "], index_offset: 0.3}");
}

/// What the motor does in a search, as "+F -S": forwards by the search speed, back by the slow one.
class HomingWays {
 public:
  void see(double velocity) {  // rad/s, each millisecond
    const double speed = std::fabs(velocity);
    const char direction = velocity > 0.0 ? '+' : '-';
    if (direction != direction_) turn(direction);
    highest_ = std::max(highest_, speed);
    held_ = std::fabs(speed - kZeroSpeed) < 0.1 * kZeroSpeed ? held_ + 1 : 0;
    if (speed > 1.5 * kZeroSpeed) add('F');
    if (held_ > 15) add('S');  // a ramp is there for 8 ms
  }
  const std::string& said() {
    turn(' ');
    return said_;
  }

 private:
  void turn(char direction) {
    if (highest_ > 0.5 * kZeroSpeed && kind_ == ' ') add('S');
    direction_ = direction;
    kind_ = ' ';
    highest_ = 0.0;
    held_ = 0;
  }
  void add(char kind) {
    if (kind != kind_) said_ += (said_.empty() ? "" : " ") + std::string{direction_, kind};
    kind_ = kind;
  }

  std::string said_;
  char direction_ = ' ', kind_ = ' ';  ///< now
  double highest_ = 0.0;               ///< speed since it turned, rad/s
  int held_ = 0;                       ///< the slow speed, ms
};

/// The lines of a method in a manual: its starts in turns of the motor, and what is printed for
/// each, as HomingWays says it.
struct PrintedHoming {
  int method;
  std::vector<std::pair<double, const char*>> ways;
};
inline void PrintTo(const PrintedHoming& printed, std::ostream* out) {
  *out << "method " << printed.method;
}
inline std::string printedHomingName(const testing::TestParamInfo<PrintedHoming>& tested) {
  return "Method" + std::to_string(tested.param.method);
}

/// Searches home, and compares what the motor does with that.
inline void expectHomingWays(const std::string& joint, const char* printed) {
  Scene scene(loadText(joint));
  ASSERT_TRUE(scene.boot(std::chrono::seconds(20))) << scene.told();
  HomingWays ways;
  scene.watch([&] { ways.see(scene.velocity("joint")); });
  const bus::Answer homed = scene.procedure(drive::ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_EQ(ways.said(), printed);
}

}  // namespace cia402
