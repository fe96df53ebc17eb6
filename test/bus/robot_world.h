// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/canopen/dcf_command.h"
#include "bus/canopen/history_command.h"
#include "bus/canopen/lss_commands.h"
#include "bus/canopen/nmt_command.h"
#include "bus/fake_drive.h"
#include "bus/jobs/object_commands.h"
#include "bus/jobs/procedure_command.h"
#include "bus/network.h"
#include "config/drive_family.h"
#include "config/robot.h"

namespace cia402::bus::test {

inline constexpr Duration kPeriod = std::chrono::milliseconds(4);
inline constexpr Duration kFrameTime = std::chrono::microseconds(100);

inline const config::DriveFamily& testFamily() {
  static const char* const kText = R"(
name: test_drive
description: Drive of the tests
units:
  position: {unit: rad, scale: 0.00001}
  velocity: {unit: rad/s, scale: 0.00001}
  torque: per_mille_of_rated
objects:
  controlword: {object: "6040:00", type: uint16, pdo: rpdo}
  statusword: {object: "6041:00", type: uint16, access: ro, pdo: tpdo}
  mode_of_operation: {object: "6060:00", type: int8, pdo: rpdo}
  mode_display: {object: "6061:00", type: int8, access: ro, pdo: tpdo}
  target_position: {object: "607A:00", type: int32, quantity: position, pdo: rpdo}
  position_actual: {object: "6064:00", type: int32, quantity: position, access: ro, pdo: tpdo}
  target_velocity: {object: "60FF:00", type: int32, quantity: velocity, pdo: rpdo}
  target_torque: {object: "6071:00", type: int16, quantity: torque, pdo: rpdo}
  following_error_window: {object: "6065:00", type: uint32, quantity: distance}
  homing_method: {object: "6098:00", type: int8}
modes:
  profile_position:
    value: 1
    control: position
    target: target_position
    handshake: new_set_point
    controlword_bits: 0x0020
    status_bits: {target_reached: 10, set_point_acknowledge: 12}
  homing: {value: 6, control: homing, status_bits: {target_reached: 10, homing_attained: 12, homing_error: 13}}
  cyclic_position: {value: 8, control: position, cyclic: true, target: target_position}
  cyclic_velocity: {value: 9, control: velocity, cyclic: true, target: target_velocity}
  cyclic_torque: {value: 10, control: torque, cyclic: true, target: target_torque}
homing:
  kind: drive
  methods: {17: negative limit switch, 37: the present position}
  writes: [{object: homing_method, from: homing.method}]
pdos:
  rpdo1: [controlword, mode_of_operation, target_position]
  rpdo2: [target_velocity, target_torque]
  tpdo1: [statusword, mode_display, position_actual]
timing: {boot: 2.0, state_change: 1.0, mode_change: 0.5, sdo: 0.1, sdo_retries: 0}
errors:
  0x8611: {text: following error, cause: blocked, remedy: check the mechanics}
)";
  static const config::DriveFamily kFamily = [] {
    Problems problems;
    config::DriveFamily family = config::parseDriveFamily(kText, "test_drive.yaml", problems);
    if (!problems.empty()) throw std::invalid_argument(problems.text());
    return family;
  }();
  return kFamily;
}

inline std::shared_ptr<const drive::DriveProfile> testProfile() {
  return std::make_shared<const drive::DriveProfile>(testFamily().drive);
}

/// An axis that needs no homing: -3..3 rad, 2 rad/s, 10 rad/s², 5 N m.
inline drive::AxisConfig testAxis(const std::string& name, canopen::NodeId node) {
  drive::AxisConfig axis;
  axis.name = axis.joint = name;
  axis.place = "node " + std::to_string(node);
  axis.profile = testProfile();
  axis.geometry.counts_per_turn = 1000;
  axis.geometry.rated_torque = 10.0;
  axis.limits.lower = -3.0;
  axis.limits.upper = 3.0;
  axis.limits.velocity = 2.0;
  axis.limits.acceleration = 10.0;
  axis.limits.effort = 5.0;
  axis.mode = "cyclic_position";
  axis.cycle = kPeriod;
  axis.outputs = {"controlword", "mode_of_operation", "target_position", "target_velocity",
                  "target_torque"};
  return axis;
}

/// The device that such an axis sits in.
inline canopen::DeviceConfig testDevice(const drive::AxisConfig& axis, canopen::NodeId node) {
  canopen::DeviceConfig device;
  device.name = axis.name;
  device.title = drive::whoIs(axis);
  device.node_id = node;
  device.profile = std::make_shared<const canopen::DeviceProfile>(testFamily().device);
  device.axes[0].pdos = device.profile->pdos;
  return device;
}

/// Adds an axis of that name in a device of its own.
inline void addAxis(config::RobotConfig& robot, const std::string& name, canopen::NodeId node) {
  robot.axes.push_back(testAxis(name, node));
  robot.axes.back().device = robot.devices.size();
  robot.devices.push_back(testDevice(robot.axes.back(), node));
}

inline drive::HomingOptions homingOfOrder(int order) {
  drive::HomingOptions homing;
  homing.method = 17;
  homing.search_velocity = homing.zero_velocity = homing.acceleration = 1.0;
  homing.timeout = std::chrono::seconds(5);
  homing.order = order;
  return homing;
}

/// Shoulder (node 1) and elbow (node 2), together the group "arm".
inline config::RobotConfig testRobot() {
  config::RobotConfig robot;
  robot.bus.interface = "can0";
  robot.bus.sync_period = kPeriod;
  robot.bus.listen = Duration::zero();
  robot.recorder.keep = 0;  // no files
  addAxis(robot, "shoulder", 1);
  addAxis(robot, "elbow", 2);
  config::GroupConfig arm;
  arm.name = "arm";
  arm.joints = {"shoulder", "elbow"};
  robot.groups = {arm};
  return robot;
}

inline canopen::MasterConfig masterOf(const config::RobotConfig& robot) {
  Problems problems;
  canopen::MasterConfig master = config::makeMasterConfig(robot, problems);
  if (!problems.empty()) throw std::invalid_argument(problems.text());
  return master;
}

/// A robot with fake drives in virtual time; each answer takes kFrameTime.
class RobotWorld : private can::Sink, private EventSink {
 public:
  struct Sent {
    Time time;
    can::Frame frame;
  };

  explicit RobotWorld(const config::RobotConfig& config = testRobot())
      : network(config, masterOf(config), *this, *this) {
    for (const canopen::DeviceConfig& device : config.devices) drives.emplace_back(device.node_id);
  }

  Time now{std::chrono::seconds(1)};
  std::vector<Sent> sent;
  std::vector<Event> events;
  std::vector<EmergencyEvent> emergencies;
  std::deque<FakeDrive> drives;  ///< in the order of the axes
  /// Other devices: hear what is sent, and may answer.
  std::function<std::optional<can::Frame>(const can::Frame&)> bystanders;
  Network network;
  bool* in_cycle = nullptr;  ///< set while the network's own code runs in a cycle, if given

  drive::Axis& axis(std::size_t index) { return network.axis(index); }
  canopen::Node& node(std::size_t index) { return network.node(index); }
  AxisUnit& unit(std::size_t index) { return network.cycle().units()[index]; }
  const canopen::DeviceConfig& device(std::size_t index) {
    return network.config().deviceOf(axis(index).config());
  }

  /// Lets `duration` pass.
  void run(Duration duration) {
    runUntil([] { return false; }, duration);
  }
  /// Lets time pass until `condition` holds. @return false if it did not within `limit`.
  bool runUntil(const std::function<bool()>& condition, Duration limit = std::chrono::seconds(10)) {
    const Time end = now + limit;
    while (!condition()) {
      Time next = std::min(end, network.nextDeadline());
      if (!wire_.empty()) next = std::min(next, wire_.front().time);
      for (const FakeDrive& drive : drives) next = std::min(next, drive.nextDeadline());
      now = std::max(now, next);
      if (now >= end) return condition();
      step();
    }
    return true;
  }
  /// Starts the robot and waits until all drives are ready.
  void boot() {
    network.start(now);
    const bool ready = runUntil([&] {
      const auto& units = network.cycle().units();
      return std::all_of(units.begin(), units.end(), [](const AxisUnit& u) {
        const drive::AxisState& state = u.axis.state();
        return state.health == fieldbus::Health::ready && state.feedback_valid;
      });
    });
    if (!ready) throw std::runtime_error("the drives did not boot: " + allEvents());
  }
  /// Boots and enables all axes.
  void enable() {
    boot();
    const Answer answer = call(drive::ProcedureKind::enable);
    if (!answer.success) throw std::runtime_error(answer.message);
  }

  template <typename AnswerType = Answer>
  using Answers = std::shared_ptr<std::vector<AnswerType>>;

  /// Begins a command; its answer is found in the result once there is one.
  template <typename Request>
  Answers<typename Request::Answer> begin(Request request) {
    using AnswerType = typename Request::Answer;
    auto answers = std::make_shared<std::vector<AnswerType>>();
    network.execute(Command(std::move(request),
                            [answers](const AnswerType& answer) { answers->push_back(answer); }),
                    now);
    return answers;
  }
  Answers<> begin(drive::ProcedureKind kind, const std::string& axis = {},
                  const std::string& mode = {}) {
    ProcedureCommand command;
    command.axis = axis;
    command.request.kind = kind;
    command.request.mode = mode;
    return begin(command);
  }
  /// Carries a command out and waits for its answer.
  template <typename AnswerType>
  AnswerType wait(const Answers<AnswerType>& answers) {
    if (!runUntil([&] { return !answers->empty(); }, std::chrono::seconds(30))) {
      throw std::runtime_error("no answer came");
    }
    return answers->front();
  }
  Answer call(drive::ProcedureKind kind, const std::string& axis = {},
              const std::string& mode = {}) {
    return wait(begin(kind, axis, mode));
  }
  template <typename Request>
  typename Request::Answer call(Request request) {
    return wait<typename Request::Answer>(begin(std::move(request)));
  }
  Answer move(const std::vector<double>& positions, double seconds,
              const std::string& group = "arm") {
    return call(trajectory(group, {{positions, seconds}}));
  }
  struct Point {
    std::vector<double> positions;
    double seconds;
  };
  /// Points that are passed at rest, for the joints of the group in their order.
  TrajectoryCommand trajectory(const std::string& group, const std::vector<Point>& points) const {
    TrajectoryCommand command;
    command.group = group;
    for (const Group& candidate : network.cycle().groups()) {
      if (candidate.config().name == group) command.joints = candidate.config().joints;
    }
    for (const Point& point : points) {
      motion::TrajectoryPoint target;
      target.positions = point.positions;
      target.velocities.assign(point.positions.size(), 0.0);
      target.time_from_start = fromSeconds(point.seconds);
      command.points.push_back(target);
    }
    return command;
  }
  const Group& group(std::size_t index = 0) const { return network.cycle().groups()[index]; }

  /// Frames sent with this identifier.
  std::vector<Sent> sentWithId(std::uint32_t id) const {
    std::vector<Sent> found;
    std::copy_if(sent.begin(), sent.end(), std::back_inserter(found),
                 [id](const Sent& s) { return s.frame.id == id; });
    return found;
  }
  std::string allEvents() const {
    std::string text;
    for (const Event& event : events) text += event.text.str() + "\n";
    return text;
  }
  std::size_t eventsWith(const std::string& words) const {
    return static_cast<std::size_t>(std::count_if(
        events.begin(), events.end(),
        [&](const Event& event) { return event.text.str().find(words) != std::string::npos; }));
  }

 private:
  bool send(const can::Frame& frame) override {
    const Outside outside(in_cycle);
    sent.push_back({now, frame});
    for (FakeDrive& drive : drives) drive.receive(frame, now);
    collect();
    const auto answer = bystanders ? bystanders(frame) : std::nullopt;
    if (answer) wire_.push_back({now + kFrameTime, *answer});
    return true;
  }
  void onEvent(const Event& event) override {
    const Outside outside(in_cycle);
    events.push_back(event);
  }
  void onEmergency(const EmergencyEvent& event) override {
    const Outside outside(in_cycle);
    emergencies.push_back(event);
  }

  void collect() {
    for (FakeDrive& drive : drives) {
      for (; !drive.out.empty(); drive.out.pop_front()) {
        wire_.push_back({now + kFrameTime, drive.out.front()});
      }
    }
  }
  void step() {
    ofTheNetwork([this] { network.tick(now); });
    for (FakeDrive& drive : drives) drive.tick(now);
    collect();
    while (!wire_.empty() && wire_.front().time <= now) {
      const Sent answer = wire_.front();
      wire_.pop_front();
      ofTheNetwork([&] { network.receive(answer.frame, answer.time, now); });
    }
  }

  template <typename Work>
  void ofTheNetwork(const Work& work) {
    if (in_cycle != nullptr) *in_cycle = true;
    work();
    if (in_cycle != nullptr) *in_cycle = false;
  }
  /// What the world itself does is none of the network's.
  struct Outside {
    explicit Outside(bool* running) : flag(running), was(running != nullptr && *running) {
      if (was) *flag = false;
    }
    ~Outside() {
      if (was) *flag = true;
    }
    Outside(const Outside&) = delete;
    Outside& operator=(const Outside&) = delete;
    bool* flag;
    bool was;
  };

  std::deque<Sent> wire_;  // on their way to the network
};

}  // namespace cia402::bus::test
