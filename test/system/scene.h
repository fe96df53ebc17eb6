// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/canopen/history_command.h"
#include "bus/canopen/lss_commands.h"
#include "bus/canopen/nmt_command.h"
#include "bus/jobs/object_commands.h"
#include "system/robot_fixture.h"

namespace cia402 {

inline LoadedRobot loadText(const std::string& yaml) { return loadTree(YAML::Load(yaml)); }

/// Two revolute axes of the generic drive, 131072 counts on 100 turns of the motor, in a group.
/// @param left, right more options of the axis, e.g. ", homing: {...}".
inline std::string genericPair(const std::string& left = {}, const std::string& right = {},
                               const std::string& group = {}) {
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "defaults: {drive: generic_cia402, counts_per_turn: 131072, gear_ratio: 100.0,\n"
         "  rated_torque: 0.64, command_timeout: 0.2, mode: cyclic_position,\n"
         "  limits: {lower: -2.5, upper: 2.5, velocity: 1.5, acceleration: 4.0,\n"
         "           effort: 120.0}}\n"
         "axes:\n"
         "  left: {node_id: 1" +
         left +
         "}\n"
         "  right: {node_id: 2" +
         right +
         "}\n"
         "groups:\n"
         "  pair: {joints: [left, right]" +
         group + "}\n";
}

/// The same with further keys of `bus`.
inline std::string withBus(const std::string& more, std::string yaml = genericPair()) {
  return yaml.replace(yaml.find("heartbeat: 0.1"), 14, "heartbeat: 0.1, " + more);
}

/// A drive without heartbeat, as the end of its axis' mapping.
constexpr char kGuarded[] =
    ", error_control: guarding, simulation: {drive: generic_cia402_guarding}";

/// One Damiao joint that stands at 1.1 rad.
inline std::string damiaoJoint(const std::string& more = {}) {
  return "bus: {interface: sim, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "axes:\n"
         "  joint: {node_id: 4, drive: damiao_dm, mode: cyclic_position, command_timeout: 0.2,\n"
         "    limits: {lower: -2.0, upper: 2.0, velocity: 2.0, acceleration: 15.0,\n"
         "             effort: 5.0}, simulation: {initial_position: 1.1, time_constant: 0.005}" +
         more + "}\n";
}

/// The pair with a Damiao as its right axis: one drive that faults when the master's heartbeat is
/// missing for 0.3 s, and one that minds SYNC that is late.
inline std::string mixedPair(std::string yaml = genericPair()) {
  const std::string damiao =
      "{node_id: 2, drive: damiao_dm, limits: {lower: -2.0, upper: 2.0, velocity: 2.0,\n"
      "    acceleration: 15.0, effort: 5.0}}\n";
  return yaml.replace(yaml.find("{node_id: 2}"), 13, damiao);
}

/// A whole robot under test. Knows the truth in the simulated drives in the joints' own units, and
/// looks at it every millisecond.
class Scene {
 public:
  explicit Scene(LoadedRobot loaded, std::uint64_t seed = 1)
      : loaded_(std::move(loaded)),
        robot_(loaded_.robot, loaded_.master, loaded_.drives, seed),
        seen_(loaded_.robot.axes.size()) {
    for (const drive::AxisConfig& axis : loaded_.robot.axes) {
      places_.push_back(sim::findAxis(loaded_.drives, axis.name).value());
    }
  }

  struct Seen {  // of the truth, since forget()
    double lowest = 1e9, highest = -1e9, fastest = 0.0;
    double travel() const { return highest - lowest; }
  };

  tools::VirtualRobot& robot() { return robot_; }
  sim::World& world() { return robot_.world(); }
  const LoadedRobot& loaded() const { return loaded_; }
  std::string told() const { return cia402::told(robot_); }
  Time now() const { return robot_.now(); }

  std::size_t index(const std::string& name) const {
    const auto& axes = loaded_.robot.axes;
    const auto axis = std::find_if(axes.begin(), axes.end(),
                                   [&](const drive::AxisConfig& a) { return a.name == name; });
    EXPECT_TRUE(axis != axes.end()) << name;
    return static_cast<std::size_t>(axis - axes.begin());
  }
  drive::Axis& axis(const std::string& name) { return robot_.network().axis(index(name)); }
  canopen::Node& node(const std::string& name) { return robot_.network().node(index(name)); }
  const drive::AxisState& state(const std::string& name) { return axis(name).state(); }
  sim::Port& port(const std::string& name) { return world().port(places_[index(name)].drive); }
  sim::Drive& drive(const std::string& name) { return world().drive(places_[index(name)].drive); }
  sim::DriveTruth truth(std::size_t i) {
    return world().drive(places_[i].drive).truth(now(), places_[i].axis);
  }
  sim::DriveTruth truth(const std::string& name) { return truth(index(name)); }
  void inject(const std::string& name, const std::string& fault) {
    const auto done = drive(name).inject(fault, now(), places_[index(name)].axis);
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
  }

  /// Where the joint truly stands, rad or m, in the coordinates of its `simulation:` section.
  double position(std::size_t i) {
    return truth(i).position_turns * unitsPerTurn(i) +
           loaded_.robot.axes[i].geometry.position_offset;
  }
  double position(const std::string& name) { return position(index(name)); }
  double velocity(std::size_t i) { return truth(i).velocity_turns * unitsPerTurn(i); }
  double velocity(const std::string& name) { return velocity(index(name)); }
  const Seen& seen(const std::string& name) const { return seen_[index(name)]; }
  void forget() { std::fill(seen_.begin(), seen_.end(), Seen()); }
  /// Called every millisecond.
  void watch(std::function<void()> look) { look_ = std::move(look); }

  void run(Duration duration) {
    const Time end = now() + duration;
    while (now() < end) step();
  }
  bool runUntil(const std::function<bool()>& condition, Duration limit) {
    const Time end = now() + limit;
    while (!condition()) {
      if (now() >= end) return false;
      step();
    }
    return true;
  }
  /// Powers the drives on, starts the driver and boots all nodes.
  bool boot(Duration limit = std::chrono::seconds(8)) {
    robot_.start();
    return runUntil([this] { return allReady(robot_); }, limit);
  }

  template <typename Request>
  typename Request::Answer call(Request request, Duration limit = std::chrono::seconds(120)) {
    const auto answer = ask(std::move(request));
    runUntil([&answer] { return answer->has_value(); }, limit);
    if (*answer) return **answer;
    typename Request::Answer none;
    none.message = "no answer";
    return none;
  }
  /// Asks and does not wait; the answer goes to the returned place.
  template <typename Request>
  std::shared_ptr<std::optional<typename Request::Answer>> ask(Request request) {
    const auto answer = std::make_shared<std::optional<typename Request::Answer>>();
    const auto take = [answer](const typename Request::Answer& given) { *answer = given; };
    robot_.network().execute(bus::Command(std::move(request), take), now());
    return answer;
  }
  bus::Answer procedure(drive::ProcedureKind kind, const std::string& name = {},
                        const std::string& mode = {}) {
    drive::ProcedureRequest request;
    request.kind = kind;
    request.mode = mode;
    return call(bus::ProcedureCommand{name, request});
  }
  /// Starts a procedure and does not wait; its answer goes to the returned place.
  std::shared_ptr<std::optional<bus::Answer>> begin(drive::ProcedureKind kind,
                                                    const std::string& name,
                                                    const std::string& mode = {}) {
    drive::ProcedureRequest request;
    request.kind = kind;
    request.mode = mode;
    return ask(bus::ProcedureCommand{name, request});
  }
  /// Gives one set-point. @return why it was refused; empty if not.
  std::string setpoint(const std::string& name, double value) {
    const auto answer = ask(bus::SetpointCommand{index(name), value});
    return *answer ? (*answer)->message : std::string();
  }
  /// Streams a set-point every 20 ms.
  void stream(const std::string& name, double value, Duration duration) {
    const Time end = now() + duration;
    while (now() < end) {
      const std::string refusal = setpoint(name, value);
      ASSERT_EQ(refusal, "");
      run(std::chrono::milliseconds(20));
    }
  }
  /// Sends a group to one goal, all joints at rest there after `duration`.
  bus::Answer move(std::vector<double> goal, Duration duration, std::size_t group = 0) {
    const config::GroupConfig& config = loaded_.robot.groups[group];
    bus::TrajectoryCommand trajectory;
    trajectory.group = config.name;
    trajectory.joints = config.joints;
    std::vector<double> rest(goal.size(), 0.0);
    trajectory.points = {{std::move(goal), std::move(rest), {}, duration}};
    return call(trajectory);
  }
  bus::Answer stopGroup(std::size_t group = 0) {
    bus::TrajectoryCommand trajectory;
    trajectory.group = loaded_.robot.groups[group].name;
    return call(trajectory);
  }
  unsigned badFloats() {
    unsigned sum = 0;
    for (std::size_t i = 0; i < world().driveCount(); ++i) {
      sum += world().drive(i).truth(now()).bad_floats_received;
    }
    return sum;
  }

 private:
  double unitsPerTurn(std::size_t i) const {
    constexpr double kTwoPi = 6.283185307179586;
    const drive::AxisConfig& axis = loaded_.robot.axes[i];
    const bool linear = axis.geometry.type == drive::AxisGeometry::Type::prismatic;
    const double ratio = axis.profile->output_shaft ? 1.0 : axis.geometry.gear_ratio;
    return (linear ? axis.geometry.lead : kTwoPi) / ratio * axis.geometry.direction;
  }
  void step() {
    robot_.run(std::chrono::milliseconds(1));
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const double at = position(i);
      seen_[i].lowest = std::min(seen_[i].lowest, at);
      seen_[i].highest = std::max(seen_[i].highest, at);
      seen_[i].fastest = std::max(seen_[i].fastest, std::abs(velocity(i)));
    }
    if (look_) look_();
  }

  LoadedRobot loaded_;
  tools::VirtualRobot robot_;
  std::vector<Seen> seen_;
  std::vector<sim::AxisPlace> places_;  ///< of the axes among the drives
  std::function<void()> look_;
};

template <typename Request>
typename Request::Answer call(Scene& scene, Request request) {
  return scene.call(std::move(request));
}

/// Asks and does not wait; the answer goes to the returned place.
template <typename Request>
std::shared_ptr<std::optional<typename Request::Answer>> ask(Scene& scene, Request request) {
  return scene.ask(std::move(request));
}

/// A robot that is enabled, in the mode that its YAML says or in another one.
struct ReadyScene : Scene {
  explicit ReadyScene(const std::string& yaml, const std::string& mode = {})
      : Scene(loadText(yaml)) {
    EXPECT_TRUE(boot()) << told();
    if (!mode.empty()) {
      EXPECT_TRUE(procedure(drive::ProcedureKind::set_mode, {}, mode).success);
    }
    const bus::Answer enabled = procedure(drive::ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message;
    run(std::chrono::milliseconds(100));
  }
};

/// Calls the place where a joint stands `position`.
inline bus::Answer declare(Scene& scene, const std::string& name, double position) {
  drive::ProcedureRequest request;
  request.kind = drive::ProcedureKind::set_position;
  request.position = position;
  return call(scene, bus::ProcedureCommand{name, request});
}

/// Since forget(), by its motor; and it has no error.
inline void expectNothingMoved(Scene& scene, const std::string& name) {
  EXPECT_LT(scene.seen(name).travel(), 1e-3) << scene.told();
  EXPECT_LT(scene.seen(name).fastest, 0.02);
  EXPECT_EQ(scene.state(name).error_code, 0) << scene.told();
}

}  // namespace cia402
