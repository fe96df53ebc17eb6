// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/history.h"

#include <algorithm>
#include <cstdio>

namespace cia402::campaign {
namespace {

class Author {
 public:
  Author(Random& random, const RobotPlan& robot) : random_(random), robot_(robot) {
    for (const AxisPlan& axis : robot.axes) modes_.push_back(axis.mode);
    troubled_ = random.chance(0.6);
    late_host_ = random.chance(0.4);
  }

  std::vector<Action> write(double seconds) {
    now_ = random_.between(2.0, 3.0);
    begin();
    while (now_ < seconds) {
      episode();
      if (random_.chance(0.12)) prove();
    }
    prove();
    add(now_, "end");
    std::stable_sort(actions_.begin(), actions_.end(),
                     [](const Action& a, const Action& b) { return a.at < b.at; });
    return std::move(actions_);
  }

 private:
  void add(double at, const std::string& words) {
    char line[32];
    std::snprintf(line, sizeof line, "%.6f ", at);
    actions_.push_back(parseAction(line + words).value());
  }
  const AxisPlan& anyAxis() { return robot_.axes[random_.below(robot_.axes.size())]; }
  const AxisPlan& oneInDriveOf(const AxisPlan& axis) {
    return axis.neighbour && random_.chance(0.5) ? robot_.axes[*axis.neighbour] : axis;
  }
  /// Often the one in the same drive, or that moves joints with it.
  const AxisPlan& another(const AxisPlan& axis) {
    const auto& near = axis.mate ? axis.mate : axis.neighbour;
    return near && random_.chance(0.5) ? robot_.axes[*near] : anyAxis();
  }
  std::string whom(const AxisPlan& axis, double all = 0.2) {
    return random_.chance(all) ? "all" : axis.name;
  }
  /// Procedures are of groups as well.
  std::string whomOrGroup(const AxisPlan& axis) {
    return random_.chance(0.15) ? random_.pick(robot_.groups).name : whom(axis);
  }
  char kindOf(const AxisPlan& axis) {
    const auto index = static_cast<std::size_t>(&axis - robot_.axes.data());
    for (const ModePlan& mode : axis.family->modes) {
      if (modes_[index] == mode.name) return mode.kind;
    }
    return 'p';
  }

  /// Enabled, and homed where that is asked for.
  void begin() {
    add(now_, "recover all");
    now_ += 1.0;
    bool moves = false;
    const bool action = random_.chance(0.3);
    if (action) homeAll();
    for (const AxisPlan& axis : robot_.axes) {
      if (!axis.homing) continue;
      if (!action) add(now_, "home " + axis.name);
      moves = moves || axis.homes_by_moving;
    }
    now_ += moves ? random_.between(0.3, 8.0) : 0.6;
  }
  /// By the action, some together, perhaps cancelled.
  void homeAll() {
    std::string names, orders;
    for (const AxisPlan& axis : robot_.axes) {
      if (!axis.homing || random_.chance(0.1)) continue;
      names += (names.empty() ? "" : ",") + axis.name;
      orders += (orders.empty() ? "" : ",") + std::to_string(random_.below(3));
    }
    if (names.empty()) return;
    if (random_.chance(0.1)) names = random_.pick(robot_.groups).name, orders = "0";
    add(now_, "homing " + names + (random_.chance(0.6) ? " " + orders : ""));
    if (random_.chance(0.3)) add(now_ + random_.between(0.0, 4.0), "cancel_home");
  }
  void prove() {
    now_ += 0.5;
    add(now_, "prove");  // what follows is counted from its end
    now_ += 0.5;
  }

  void episode() {
    const AxisPlan& axis = anyAxis();
    if (random_.chance(0.35)) {
      add(now_, (random_.chance(0.7) ? "recover " : "enable ") + whom(axis, 0.6));
      now_ += random_.between(0.3, 1.2);
    }
    if (axis.homing && random_.chance(0.1)) {
      if (random_.chance(0.4)) {
        homeAll();
      } else {
        add(now_, "home " + axis.name);
      }
      if (troubled_ && random_.chance(0.15)) unheard(now_ + random_.between(0.1, 2.0), axis);
      now_ += random_.between(0.05, 3.0);
    }
    if (random_.chance(0.08)) changeMode(axis);
    move(axis);
    if (random_.chance(0.3)) move(another(axis));
    // Often before the feedback shows that the axis has begun to move.
    const bool young = random_.chance(0.25);
    double at = now_ + (young ? random_.between(0.001, 0.03) : random_.between(0.005, 1.5));
    if (late_host_ && random_.chance(0.4)) late(at + random_.between(-0.02, 0.08));
    if (troubled_ && random_.chance(0.3))
      trouble(at + random_.between(-0.05, 0.15), oneInDriveOf(axis));
    const int calls = random_.pick({0, 1, 1, 2, 2, 3, 4});
    for (int i = 0; i < calls; ++i) {
      call(at, random_.chance(0.8) ? axis : another(axis));
      at += random_.chance(0.7) ? random_.between(0.0, 0.01) : random_.between(0.01, 0.4);
    }
    if (axis.neighbour && random_.chance(0.3)) {
      touchDrive(at + random_.between(-0.1, 0.3), robot_.axes[*axis.neighbour]);
    }
    now_ = at + random_.between(0.05, 2.0);
  }

  void changeMode(const AxisPlan& axis) {
    const std::string mode = random_.pick(axis.family->modes).name;
    modes_[static_cast<std::size_t>(&axis - robot_.axes.data())] = mode;
    add(now_, "set_mode " + axis.name + " " + mode);
    now_ += random_.between(0.3, 1.5);
  }

  double position(const AxisPlan& axis) { return random_.between(axis.lower, axis.upper); }

  void move(const AxisPlan& axis) {
    const char kind = kindOf(axis);
    if (kind == 'p' && random_.chance(axis.mate ? 0.85 : 0.4)) return trajectory();
    const std::string rate = text(random_.between(50.0, 250.0));
    const std::string length = text(random_.between(0.005, 1.5));
    double value = position(axis);
    if (kind == 'v') value = axis.velocity * random_.between(-1.2, 1.2);
    if (kind == 't') value = axis.effort * random_.between(-0.5, 0.5);
    if (random_.chance(0.05)) value = random_.pick({0.0, -0.0, 1e9, -1e9});
    if (random_.chance(0.15)) {
      add(now_, "point " + axis.name + " " + text(value));
    } else if (kind == 'p' && random_.chance(0.2)) {
      add(now_, "nudge " + axis.name + " " + text(0.2 * axis.velocity * random_.between(-1, 1)) +
                    " " + length + " " + rate);
    } else if (random_.chance(0.3)) {
      const double amplitude = kind == 'p' ? 0.2 * (axis.upper - axis.lower) : 0.3 * axis.velocity;
      add(now_, "sine " + axis.name + " " + text(value) + " " + text(amplitude) + " " +
                    text(random_.between(0.3, 3.0)) + " " + length + " " + rate);
    } else {
      add(now_, "stream " + axis.name + " " + text(value) + " " + length + " " + rate);
    }
    if (random_.chance(0.04)) {
      add(now_ + random_.between(0.0, 0.3),
          "point " + axis.name + " " + random_.pick<std::string>({"nan", "inf", "-inf", "1e300"}));
    }
  }

  void trajectory() {
    const GroupPlan& group = random_.pick(robot_.groups);
    std::string shares;
    for (std::size_t i = 0; i < group.joints.size(); ++i) shares += " " + text(random_.uniform());
    const std::string length = text(random_.between(0.1, 2.5));
    const double choice = random_.uniform();
    if (group.partial && random_.chance(0.4)) {
      parts(group);
    } else if (choice < 0.65) {
      add(now_, "move " + group.name + " " + length + shares);
    } else if (choice < 0.9) {
      add(now_, "path " + group.name + " " + text(random_.between(-0.5, 1.0)) + " " +
                    std::to_string(1 + random_.below(4)) + " " + length + shares);
    } else {
      std::string goal;
      for (std::size_t i = 0; i < group.joints.size(); ++i) {
        goal += " " + random_.pick<std::string>({"nan", "1e9", "0", "-0.0", "99"});
      }
      add(now_, "goal " + group.name + " " + length + goal);
    }
    if (random_.chance(0.3)) {  // another one takes over on the way
      add(now_ + random_.between(0.0, 1.0),
          "move " + group.name + " " + text(random_.between(0.3, 2.0)) + shares);
    }
    if (random_.chance(0.15)) add(now_ + random_.between(0.0, 1.0), "stop " + group.name);
    if (random_.chance(0.2)) add(now_ + random_.between(0.0, 1.5), "cancel " + group.name);
  }
  /// Some of a group's joints, at least one: "a1,a3".
  std::string someOf(const GroupPlan& group) {
    std::string names;
    const std::size_t sure = random_.below(group.joints.size());
    for (std::size_t i = 0; i < group.joints.size(); ++i) {
      if (i != sure && random_.chance(0.5)) continue;
      names += (names.empty() ? "" : ",") + group.joints[i];
    }
    return names;
  }
  /// Trajectories of some of the joints, one beside another, or in its way.
  void parts(const GroupPlan& group) {
    double at = now_;
    for (std::size_t count = 1 + random_.below(3); count > 0; --count) {
      std::string shares;
      for (std::size_t i = 0; i < group.joints.size(); ++i) shares += " " + text(random_.uniform());
      add(at, "part " + group.name + " " + someOf(group) + " " + text(random_.between(0.1, 2.5)) +
                  shares);
      at += random_.between(0.0, 0.8);
    }
    if (random_.chance(0.3)) add(at, "stop " + group.name + " " + someOf(group));
  }

  void call(double at, const AxisPlan& axis) {
    const std::string who = whomOrGroup(axis);
    const double choice = random_.uniform();
    if (choice < 0.22) return add(at, "halt " + who);
    if (choice < 0.32) return add(at, "quick_stop " + who);
    if (choice < 0.44) return add(at, "disable " + who);
    if (choice < 0.54) return add(at, "enable " + who);
    if (choice < 0.64) return add(at, "recover " + who);
    if (choice < 0.72) {
      const std::string mode = random_.pick(axis.family->modes).name;
      return add(at, "set_mode " + axis.name + " " + mode);
    }
    if (choice < 0.80) return add(at, "set_position " + axis.name + " " + text(position(axis)));
    if (choice < 0.84) {
      return add(at, "home " + (random_.chance(0.15) ? random_.pick(robot_.groups).name
                                                     : std::string(axis.name)));
    }
    if (choice < 0.87) return add(at, "clear_faults " + who);
    if (choice < 0.90) return add(at, "point " + axis.name + " " + text(position(axis)));
    if (choice < 0.92) return add(at, "stop " + random_.pick(robot_.groups).name);
    if (choice < 0.94) return add(at, "read " + axis.name + " " + object());
    if (choice < 0.96) return write(at, axis);
    if (choice < 0.98) return add(at, "nmt " + whom(axis) + " " + nmtCommand());
    add(at, random_.pick<std::string>({"save ", "restore ", "history "}) + axis.name);
  }
  /// What may be done to a drive for one of its axes.
  void touchDrive(double at, const AxisPlan& axis) {
    if (random_.chance(0.4)) {  // it may be done then, unless the other one is quicker
      const AxisPlan& other = robot_.axes[*axis.neighbour];
      add(at, "disable " + axis.name);
      add(at, "disable " + other.name);
      at += random_.between(0.3, 1.0);
      add(at + random_.between(-0.05, 0.15),
          random_.pick<std::string>({"enable ", "recover "}) + other.name);
    }
    const auto verb =
        random_.pick<std::string>({"recover", "clear_faults", "save", "restore", "nmt"});
    add(at, verb + " " + axis.name + (verb == "nmt" ? " " + nmtCommand() : ""));
  }
  std::string nmtCommand() {
    return random_.pick<std::string>(
        {"start", "stop", "pre_operational", "reset_node", "reset_communication"});
  }
  std::string object() {
    return random_.pick<std::string>(
        {"position_actual", "6041:00", "following_error_window", "1018:04", "6502:00", "5FFF:01"});
  }
  void write(double at, const AxisPlan& axis) {
    add(at, "write " + axis.name + " " + random_.pick(axis.family->values));
  }

  void late(double at) {
    const double choice = random_.uniform();
    if (choice < 0.6) {
      add(at, "stall " + text(random_.pick({0.005, 0.012, 0.02, 0.06, 0.15, 0.5})));
    } else if (choice < 0.8) {
      add(at,
          "late " + text(random_.between(0.0005, 0.006)) + " " + text(random_.between(0.5, 3.0)));
    } else if (choice < 0.93) {
      add(at, "kill " + text(random_.between(0.01, 1.5)));
      now_ += 1.0;
    } else {
      add(at, "shutdown " + text(random_.between(0.1, 1.0)));
      now_ += 3.0;
    }
  }

  /// Its feedback is stale at once, and it is lost where that lasts: who stops it is not told how.
  void unheard(double at, const AxisPlan& axis) {
    const std::string length = text(random_.between(0.05, 2.5));
    const bool all = random_.chance(0.6);
    add(at, "unheard " + axis.name + (all ? " all " : " service ") + length);
    const double choice = random_.uniform();
    if (choice < 0.25) add(at, "loss 0.25 " + length);
    if (choice > 0.6) add(at, "nmt_loss " + axis.name + " " + std::to_string(1 + random_.below(3)));
    double call = at + random_.between(0.03, 0.3);
    while (!random_.chance(0.35)) {  // a stop upon a stop, that nobody can see
      add(call,
          random_.pick<std::string>({"disable ", "halt ", "quick_stop ", "recover "}) + axis.name);
      call += random_.between(0.005, 0.1);
    }
  }
  void trouble(double at, const AxisPlan& axis) {
    if (random_.chance(0.08)) return unheard(at, axis);
    const std::string length = text(random_.between(0.02, 1.5));
    const double choice = random_.uniform();
    if (choice < 0.12) {
      add(at, "loss " + text(random_.pick({0.01, 0.1, 0.25})) + " " + length);
    } else if (choice < 0.18) {
      add(at, "delay " + text(random_.between(0.01, 0.2)) + " " + length + " " +
                  text(random_.between(0.002, 0.02)));
    } else if (choice < 0.24) {
      add(at, random_.pick<std::string>({"corrupt ", "duplicate "}) +
                  text(random_.between(0.01, 0.1)) + " " + length);
    } else if (choice < 0.50) {
      fault(at, axis);
    } else if (choice < 0.57) {
      add(at, "power " + axis.name + " " + length);
    } else if (choice < 0.63) {
      add(at, "silent " + axis.name + " " + length);
    } else if (choice < 0.68) {
      add(at, "mute " + axis.name + " " + length);
    } else if (choice < 0.76) {
      add(at, "block " + axis.name + " " + length);
    } else if (choice < 0.83) {
      if (axis.family->joint_units) return;  // has none
      add(at, "switch " + axis.name + random_.pick<std::string>({" lower ", " upper "}) +
                  text(random_.between(0.2, 2.0)));
    } else if (choice < 0.88) {
      add(at, "cable " + (random_.chance(0.5) ? "host" : axis.name) + " " + length);
    } else if (choice < 0.93) {
      add(at, "bus_off " + (random_.chance(0.5) ? "host" : axis.name) + " " + length);
    } else if (choice < 0.96) {
      add(at, "sync " + text(random_.pick({0.004, 0.01, 0.05})) + " " + length);
    } else {
      const std::string who = whom(axis);
      add(at, "foreign_nmt " + who + " " +
                  random_.pick<std::string>({"stop", "stop", "pre_operational", "reset_node",
                                             "reset_communication", "start"}));
      if (random_.chance(0.6)) {  // what the master answers to that is lost
        add(at + 0.002, "nmt_loss " + who + " " + std::to_string(1 + random_.below(4)));
      }
      if (random_.chance(0.5)) add(at + random_.between(0.02, 0.8), "recover " + axis.name);
    }
  }
  void fault(double at, const AxisPlan& axis) {
    add(at, "fault " + axis.name + " " + random_.pick(axis.family->faults));
    // While it still coasts or brakes.
    if (random_.chance(0.3)) add(at + random_.between(0.001, 0.3), "recover " + axis.name);
  }

  Random& random_;
  const RobotPlan& robot_;
  std::vector<std::string> modes_;
  std::vector<Action> actions_;
  double now_ = 0.0;
  bool troubled_ = false, late_host_ = false;
};

}  // namespace

std::vector<Action> planHistory(Random& random, const RobotPlan& robot, double seconds) {
  return Author(random, robot).write(seconds);
}

}  // namespace cia402::campaign
