// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/robot_plan.h"

#include <algorithm>
#include <cstdio>

#include "campaign/habits.h"

namespace cia402::campaign {
namespace {

constexpr const char* kSharedPdos = "pdo_rules: {pdos_per_axis: 0}";
constexpr double kSearch = 0.4;  // of the velocity limit: how fast a home is searched for

/// Where an axis sits.
struct Seat {
  int node = 0;
  std::optional<std::size_t> neighbour{};  ///< the other axis in its drive
  int device_axis = 0;
  std::optional<std::size_t> mate{};  ///< with which it moves joints
  bool gantry = false;
  Habits habits{};  ///< of a drive with two axes; may be empty
};

const Family& drawFamily(Random& random) {
  double left = random.uniform();
  for (const Family& family : families()) {
    left -= family.share;
    if (left < 0.0) return family;
  }
  return families().front();
}

/// One axis; its YAML is a flow mapping on one line.
class AxisWriter {
 public:
  AxisWriter(Random& random, std::size_t number, const Seat& seat)
      : random_(random), family_(seat.neighbour ? families().front() : drawFamily(random)) {
    axis_.name = "a" + std::to_string(number + 1);
    axis_.neighbour = seat.neighbour;
    axis_.mate = seat.mate;
    differential_ = seat.mate && !seat.gantry;
    axis_.family = &family_;
    add("node_id", std::to_string(seat.node));
    if (seat.neighbour) add("device_axis", std::to_string(seat.device_axis));
    add("drive", family_.profile);
    const double kind = random.uniform();
    linear_ = !differential_ && !family_.joint_units && family_.long_range && kind < 0.15;
    axis_.continuous = !seat.mate && !linear_ && kind < 0.3;
    if (linear_) add("type", "prismatic");
    if (axis_.continuous) add("type", "continuous");
    axis_.yaml +=
        family_.options.empty() ? "" : ", " + family_.options.substr(0, family_.options.size() - 2);
    if (family_.joint_units) {
      directDrive();
    } else {
      geared();
    }
    drawMode();
    place();
    homing();
    options();
    if (seat.neighbour) {
      sitIn(seat);
    } else if (isGeneric()) {
      sitAlone();
    }
    add("simulation", "{" + simulation_ + "}");
    axis_.yaml += "}";
  }
  AxisPlan take() { return std::move(axis_); }

 private:
  void add(const std::string& key, const std::string& value) {
    axis_.yaml += (axis_.yaml.empty() ? "{" : ", ") + key + ": " + value;
  }
  void simulate(const std::string& key, const std::string& value) {
    simulation_ += (simulation_.empty() ? "" : ", ") + key + ": " + value;
  }
  /// The one that has habits, brakes and drives of two axes.
  bool isGeneric() const { return &family_ == &families().front(); }
  void directDrive() {
    time_constant_ = random_.between(0.003, 0.008);
    axis_.velocity = random_.between(0.5, 4.0);
    axis_.acceleration = axis_.velocity * random_.between(2.0, 8.0);
    axis_.effort = random_.between(3.0, 7.0);
  }
  void geared() {
    time_constant_ = random_.between(0.002, 0.006);
    const double counts = random_.pick(family_.counts);
    const double gear = linear_ ? random_.pick({1.0, 2.0, 5.0}) : random_.between(20.0, 160.0);
    const double lead = random_.pick({0.005, 0.01, 0.02});
    const double unit = (linear_ ? lead : kTwoPi) / gear;  // joint units a motor turn
    axis_.turn = unit;
    add("counts_per_turn", std::to_string(static_cast<long>(counts)));
    add("gear_ratio", text(gear));
    if (linear_) add("lead", text(lead));
    const double rated = family_.rated_torque;
    const double drawn = random_.between(1.5, 3.0);
    const double strength = family_.limits_effort ? drawn : family_.strongest;
    add("rated_torque", text(rated));
    axis_.effort = rated * strength * (linear_ ? kTwoPi / unit : gear);
    axis_.velocity = linear_ ? random_.between(0.05, 0.4) : random_.between(0.3, 3.0);
    axis_.velocity = std::min(axis_.velocity, family_.fastest * unit);
    const double hardest = std::min(0.25 * strength * family_.rated_acceleration, family_.hardest);
    axis_.acceleration = std::min(axis_.velocity * random_.between(2.0, 8.0), hardest * unit);
    // Narrow enough to notice what jumps, wide enough for honest motion.
    std::string writes = family_.writes;
    if (isGeneric()) {
      writes = "{object: following_error_window, value: " +
               text(5.0 * axis_.velocity * time_constant_ + 0.004 * axis_.velocity) + "}";
    }
    if (!writes.empty()) add("write", "[" + writes + "]");
  }
  void drawMode() {
    const std::vector<ModePlan>& modes = family_.modes;
    axis_.mode =
        random_.chance(axis_.mate ? 0.9 : 0.58) ? modes.front().name : random_.pick(modes).name;
    if (!family_.names_modes) return;
    std::string all;
    for (const ModePlan& mode : modes) all += (all.empty() ? "" : ", ") + std::string(mode.name);
    add("modes", "[" + all + "]");
  }
  void place() {
    const double reach = linear_ ? 0.4 : 2.5;
    at_ = random_.chance(0.3) ? 0.0 : random_.between(-reach, reach);
    axis_.lower = at_ - random_.between(0.15, 1.0) * reach;
    axis_.upper = at_ + random_.between(0.15, 1.0) * reach;
    if (random_.chance(0.4)) add("direction", "-1");
    if (random_.chance(0.25)) add("position_offset", text(random_.between(-0.3, 0.3) * reach));
    std::string limits;
    if (!axis_.continuous && !differential_) {  // those of its joints bound that
      limits = "lower: " + text(axis_.lower) + ", upper: " + text(axis_.upper) + ", ";
    }
    limits += "velocity: " + text(axis_.velocity) + ", acceleration: " + text(axis_.acceleration);
    if (!axis_.mate && random_.chance(0.25)) {
      limits += ", jerk: " + text(axis_.acceleration * random_.between(5.0, 40.0));
    }
    add("limits", "{" + limits + ", effort: " + text(axis_.effort) + "}");
    axis_.at = at_;
    simulate("initial_position", text(at_));
    simulate("time_constant", text(time_constant_));
  }
  void homing() {
    const double choice = random_.uniform();
    if (family_.joint_units) {
      if (choice < 0.3) declare({});
      return;
    }
    if (choice < 0.25) return;
    // Within the time that a home is searched for, 30 s where nothing is said.
    const bool soon = axis_.upper - axis_.lower < 20.0 * kSearch * axis_.velocity;
    const bool by_switch =
        choice > 0.8 && !axis_.continuous && !differential_ && family_.searches_switches && soon;
    if (choice < 0.55 || (!by_switch && family_.searches.empty())) {
      const std::string any = random_.pick<std::string>({"35", "37"});
      return declare("method: " + (family_.declares.empty() ? any : family_.declares) + ", ");
    }
    axis_.homing = axis_.homes_by_moving = true;
    std::string method;
    if (!by_switch) method = random_.pick(family_.searches);
    if (by_switch) {
      method = random_.pick<std::string>({"17", "18"});
      simulate("lower_limit_switch", text(axis_.lower - 0.05));
      simulate("upper_limit_switch", text(axis_.upper + 0.05));
    }
    add("homing", "{method: " + method + ", search_velocity: " + text(kSearch * axis_.velocity) +
                      ", zero_velocity: " + text(0.1 * axis_.velocity) + ", acceleration: " +
                      text(axis_.acceleration) + ", offset: " + text(at_) + required() + "}");
  }
  void declare(const std::string& method) {
    axis_.homing = true;
    const double offset = random_.chance(0.5) ? at_ : random_.between(axis_.lower, axis_.upper);
    add("homing", "{" + method + "offset: " + text(offset) + required() + "}");
  }
  std::string required() { return random_.chance(0.2) ? ", required: false" : ""; }
  void options() {
    add("mode", axis_.mode);
    axis_.command_timeout = random_.pick({0.05, 0.1, 0.2, 0.4});
    add("command_timeout", text(axis_.command_timeout));
    if (isGeneric() && random_.chance(0.3)) {
      simulate("brake_delay", text(random_.between(0.02, 0.25)));
    }
  }
  void sitAlone() {
    if (random_.chance(0.1)) {
      add("error_control", "guarding");
      simulate("drive", "generic_cia402_guarding");
    }
    if (random_.chance(0.35)) live(drawHabits(random_));
  }
  /// What is of the drive is said alike by all its axes.
  void sitIn(const Seat& seat) {
    simulate("drive", "generic_cia402_dual");
    live(seat.habits);
  }
  void live(const Habits& habits) {
    if (!habits.simulation.empty()) simulate("with", "{" + habits.simulation + "}");
    if (!habits.profile.empty()) add("profile_keys", "{" + habits.profile + "}");
  }

  Random& random_;
  const Family& family_;
  AxisPlan axis_;
  std::string simulation_;
  bool linear_ = false, differential_ = false;
  double at_ = 0.0, time_constant_ = 0.004;
};

/// Those of a drive with two axes, whose axes may share its PDOs.
Habits drawDualHabits(Random& random) {
  Habits habits;
  if (random.chance(0.35)) habits = drawHabits(random);
  const bool has_rules = habits.profile.find("pdo_rules") != std::string::npos;
  if (has_rules || !random.chance(0.25)) return habits;
  habits.profile += (habits.profile.empty() ? "" : ", ") + std::string(kSharedPdos);
  return habits;
}

/// Two of them move joints together.
std::vector<Seat> coupleTwo(Random& random, std::vector<Seat> seats) {
  const std::size_t one = random.below(seats.size());
  const std::size_t other = (one + 1 + random.below(seats.size() - 1)) % seats.size();
  seats[one].mate = other;
  seats[other].mate = one;
  seats[one].gantry = seats[other].gantry = random.chance(0.5);
  return seats;
}

std::vector<Seat> planSeats(Random& random, std::size_t count) {
  const int first = 1 + static_cast<int>(random.below(30));
  std::vector<Seat> seats(count);
  std::vector<std::size_t> alone;
  for (std::size_t i = 0; i < count; ++i) {
    seats[i].node = first + 3 * static_cast<int>(i);
    alone.push_back(i);
  }
  if (random.chance(1.0 / 6.0)) return coupleTwo(random, std::move(seats));
  if (!random.chance(1.0 / 6.0)) return seats;
  const auto draw = [&] {
    const auto drawn = alone.begin() + static_cast<std::ptrdiff_t>(random.below(alone.size()));
    const std::size_t index = *drawn;
    alone.erase(drawn);
    return index;
  };
  for (int pairs = count >= 4 && random.chance(0.5) ? 2 : 1; pairs > 0; --pairs) {
    const std::size_t one = draw(), other = draw();
    const Habits habits = drawDualHabits(random);
    seats[one] = {seats[one].node, other, 0, {}, false, habits};
    seats[other] = {seats[one].node, one, 1, {}, false, habits};
  }
  return seats;
}

bool cyclic(const AxisPlan& axis) { return axis.mode == axis.family->modes.front().name; }

/// The other side of a gantry: the same but for its node, and sometimes its turn.
AxisPlan otherSide(Random& random, const AxisPlan& side, std::size_t number, const Seat& seat) {
  AxisPlan other = side;
  other.name = "a" + std::to_string(number + 1);
  other.mate = seat.mate;
  const std::string node = "{node_id: ";
  const std::size_t end = side.yaml.find(',');
  other.yaml = node + std::to_string(seat.node) + side.yaml.substr(end);
  const std::string turned = ", direction: -1";
  const std::size_t turn = other.yaml.find(turned);
  const bool searches = side.homes_by_moving;  // would find its switch at the other end
  if (turn != std::string::npos && !searches && random.chance(0.5)) {
    other.yaml.erase(turn, turned.size());
  }
  return other;
}

void planAxes(Random& random, const std::vector<Seat>& seats, RobotPlan& robot) {
  for (std::size_t i = 0; i < seats.size(); ++i) {
    const auto& mate = seats[i].mate;
    const bool second = mate && *mate < i;
    robot.axes.push_back(second && seats[i].gantry
                             ? otherSide(random, robot.axes[*mate], i, seats[i])
                             : AxisWriter(random, i, seats[i]).take());
    if (second) {
      robot.couplings.push_back(planCoupling(random, robot.axes, {*mate, i}, seats[i].gantry));
    }
  }
}

/// Joints of one coupling are in a group together: those whose mate was left out are as well.
void pairUp(const std::vector<AxisPlan>& axes, GroupPlan& group) {
  const std::vector<std::size_t> drawn = group.axes;
  const auto alone = [&](std::size_t i) {
    const std::optional<std::size_t>& mate = axes[i].mate;
    return mate && std::count(drawn.begin(), drawn.end(), *mate) == 0;
  };
  group.axes.erase(std::remove_if(group.axes.begin(), group.axes.end(), alone), group.axes.end());
}

void nameJoints(const RobotPlan& robot, GroupPlan& group) {
  for (std::size_t i : group.axes) {
    if (!robot.axes[i].mate) group.joints.push_back(robot.axes[i].name);
  }
  for (const CouplingPlan& coupling : robot.couplings) {
    if (std::count(group.axes.begin(), group.axes.end(), coupling.axes[0]) == 0) continue;
    group.joints.insert(group.joints.end(), coupling.joints.begin(), coupling.joints.end());
  }
}

GroupPlan planGroup(Random& random, const RobotPlan& robot, std::size_t number) {
  const std::vector<AxisPlan>& axes = robot.axes;
  GroupPlan group;
  group.name = "g" + std::to_string(number + 1);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (cyclic(axes[i]) || random.chance(0.1)) group.axes.push_back(i);
  }
  if (number > 0 && group.axes.size() > 1) {
    group.axes.erase(group.axes.begin() +
                     static_cast<std::ptrdiff_t>(random.below(group.axes.size())));
  }
  pairUp(axes, group);
  if (group.axes.empty()) {
    group.axes.push_back(random.below(axes.size()));
    const std::optional<std::size_t>& mate = axes[group.axes.front()].mate;
    if (mate) group.axes.push_back(*mate);
  }
  nameJoints(robot, group);
  group.partial = group.joints.size() > 1 && random.chance(0.5);
  return group;
}

std::string groupYaml(Random& random, const GroupPlan& group) {
  std::string joints;
  for (const std::string& joint : group.joints) joints += (joints.empty() ? "" : ", ") + joint;
  std::string yaml = "  " + group.name + ": {joints: [" + joints + "]";
  if (random.chance(0.4)) yaml += ", stop_group_on_fault: false";
  if (group.partial) yaml += ", allow_partial_joints_goal: true";
  if (random.chance(0.3)) {
    yaml += ", stop_trajectory_duration: " + text(random.between(0.05, 0.6));
  }
  return yaml + "}\n";
}

}  // namespace

std::string text(double value) {
  char written[32];
  std::snprintf(written, sizeof written, "%.5g", value);
  return written;
}

RobotPlan planRobot(Random& random) {
  RobotPlan robot;
  const std::size_t count = 2 + random.below(5);
  const std::vector<Seat> seats = planSeats(random, count);
  planAxes(random, seats, robot);
  const double period =
      count <= 2 && random.chance(0.3) ? 0.002 : random.pick({0.004, 0.004, 0.005, 0.01});
  const double heartbeat = random.pick({0.05, 0.1, 0.1, 0.2});
  const bool external_sync = random.chance(0.12);
  const bool counts = std::all_of(robot.axes.begin(), robot.axes.end(),
                                  [](const AxisPlan& axis) { return axis.family->counts_sync; });
  robot.yaml = "bus: {interface: can0, bitrate: 1000000, sync_period: " + text(period) +
               ", heartbeat: " + text(heartbeat) + (external_sync ? ", sync: external" : "") +
               (counts ? "" : ", sync_counter: 0") + "}\n" +
               "recorder: {duration: 1, keep: 0}\naxes:\n";
  for (const AxisPlan& axis : robot.axes) robot.yaml += "  " + axis.name + ": " + axis.yaml + "\n";
  if (!robot.couplings.empty()) robot.yaml += "couplings:\n";
  for (const CouplingPlan& coupling : robot.couplings) {
    robot.yaml += "  - " + coupling.yaml + "\n";
  }
  robot.yaml += "groups:\n";
  const std::size_t groups = random.chance(0.3) ? 2 : 1;
  for (std::size_t i = 0; i < groups; ++i) {
    robot.groups.push_back(planGroup(random, robot, i));
    robot.yaml += groupYaml(random, robot.groups.back());
  }
  return robot;
}

}  // namespace cia402::campaign
