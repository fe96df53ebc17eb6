// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/robot.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bus/axis_condition.h"
#include "bus/jobs/object_commands.h"
#include "bus/jobs/procedure_command.h"
#include "bus/mpsc_queue.h"
#include "bus/real_clock.h"
#include "bus/runner.h"
#include "common/text.h"
#include "config/ready_robot.h"
#include "driver/open_socket.h"
#include "sim/world/robot_drives.h"
#include "sim/world/simulated_interface.h"
#include "yaml/reader.h"

namespace cia402 {
namespace {

using Kind = drive::ProcedureKind;

/// In the order of Procedure.
constexpr Kind kKinds[] = {Kind::enable,       Kind::disable,         Kind::home,
                           Kind::clear_faults, Kind::recover,         Kind::quick_stop,
                           Kind::halt,         Kind::save_parameters, Kind::restore_parameters};

Answer answerOf(const bus::Answer& given) { return {given.success, given.message}; }

Result<YAML::Node> read(const std::string& file) {
  try {
    return yaml::parseFile(file);
  } catch (const YAML::Exception& error) {
    return Error{file + ": " + error.what()};
  }
}

/// The simulated drives, or the interface of the kernel. @return nullptr: `problems` says why
std::unique_ptr<can::Interface> open(const config::ReadyRobot& ready, const std::string& folder,
                                     Problems& problems) {
  if (ready.robot.bus.interface != "sim") {
    return openSocket(ready.robot.bus, ready.master);
  }
  const auto drives = sim::simulatedDrives(ready.robot, folder + "/simulated_drives", problems);
  if (!problems.empty()) return nullptr;
  return std::make_unique<sim::SimulatedInterface>(drives, ready.robot.bus.bitrate, bus::realNow());
}

/// What one of the axes that move a joint, mostly the only one, says of it.
void addAxis(const drive::AxisConfig& axis, const bus::AxisSnapshot& shown, JointStatus& joint) {
  const bus::Summary summary = bus::summaryOf(shown, axis.profile->warning_stops);
  joint.enabled = joint.enabled && shown.state.ready_for_motion;
  joint.homed = joint.homed && shown.state.homed;
  joint.faulted = joint.faulted || summary.condition >= bus::Condition::error;
  if (joint.condition != summary.text) append(joint.condition, summary.text);
}

}  // namespace

class Robot::Impl {
 public:
  Impl(config::ReadyRobot ready, std::unique_ptr<can::Interface> interface, Options given)
      : options(std::move(given)),
        config(ready.robot),
        runner(std::move(ready.robot), std::move(ready.master), std::move(interface),
               runnerOptions(options, config)) {}

  static bus::BusRunner::Options runnerOptions(const Options& options,
                                               const config::RobotConfig& config) {
    bus::BusRunner::Options chosen;
    chosen.priority = options.realtime_priority;
    if (config.bus.interface == "sim") chosen.time = bus::BusTime::Kind::simulated;
    return chosen;
  }

  /// Sends a request; its answer comes by the future.
  template <typename Request>
  std::future<Answer> ask(Request request) {
    const auto promise = std::make_shared<std::promise<Answer>>();
    runner.post(bus::Command(std::move(request), [promise](const typename Request::Answer& given) {
      promise->set_value(answerOf(given));
    }));
    return promise->get_future();
  }

  const config::GroupConfig* group(const std::string& name) const {
    const auto& groups = config.groups;
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& group) { return group.name == name; });
    return found != groups.end() ? &*found : nullptr;
  }
  std::optional<std::size_t> axis(const std::string& name) const {
    const auto& axes = config.axes;
    const auto found =
        std::find_if(axes.begin(), axes.end(), [&](const auto& axis) { return axis.name == name; });
    if (found == axes.end()) return {};
    return static_cast<std::size_t>(found - axes.begin());
  }
  void tell(const std::string& text) const {
    if (options.log) options.log(text);
  }

  Options options;
  config::RobotConfig config;
  /// Refusals of set-points, from the thread of the bus to poll().
  std::shared_ptr<bus::MpscQueue<std::string>> refusals =
      std::make_shared<bus::MpscQueue<std::string>>(64);
  mutable bus::BusRunner runner;
};

Robot::Robot(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Robot::Robot(Robot&&) noexcept = default;
Robot::~Robot() = default;

Result<Robot> Robot::load(const std::string& file, Options options) {
  Result<YAML::Node> tree = read(file);
  if (!tree) return tree.error();
  if (!options.interface.empty()) tree.value()["bus"]["interface"] = options.interface;
  std::vector<std::string> folders = {options.config_folder + "/drives"};
  if (!options.profile_folder.empty()) folders.insert(folders.begin(), options.profile_folder);
  Problems problems;
  auto ready = config::readyRobot(*tree, config::profilesIn(std::move(folders)), problems);
  if (!ready) return Error{file + ":\n" + problems.text()};
  auto interface = open(*ready, options.config_folder, problems);
  if (interface == nullptr) return Error{file + ", its simulation:\n" + problems.text()};
  for (const std::string& warning : ready->robot.warnings) {
    if (options.log) options.log(warning);
  }
  return Robot(std::make_unique<Impl>(std::move(*ready), std::move(interface), std::move(options)));
}

void Robot::start() { impl_->runner.start(); }

bool Robot::ready() const {
  const bus::NetworkSnapshot shown = impl_->runner.snapshot();
  return std::all_of(shown.axes.begin(), shown.axes.end(), [](const bus::AxisSnapshot& axis) {
    return axis.state.health == fieldbus::Health::ready && axis.state.feedback_valid;
  });
}

std::vector<std::string> Robot::joints() const {
  std::vector<std::string> names;
  for (const motion::Joint& joint : impl_->config.joints()) names.push_back(joint.name);
  return names;
}

std::vector<std::string> Robot::groups() const {
  std::vector<std::string> names;
  for (const config::GroupConfig& group : impl_->config.groups) names.push_back(group.name);
  return names;
}

std::vector<std::string> Robot::jointsOf(const std::string& group) const {
  const config::GroupConfig* found = impl_->group(group);
  return found != nullptr ? found->joints : std::vector<std::string>();
}

std::future<Answer> Robot::run(Procedure procedure, const std::string& axis) {
  drive::ProcedureRequest request;
  request.kind = kKinds[static_cast<std::size_t>(procedure)];
  return impl_->ask(bus::ProcedureCommand{axis, request});
}

std::future<Answer> Robot::setMode(const std::string& axis, const std::string& mode) {
  drive::ProcedureRequest request;
  request.kind = Kind::set_mode;
  request.mode = mode;
  return impl_->ask(bus::ProcedureCommand{axis, request});
}

std::future<Answer> Robot::setPosition(const std::string& axis, double position) {
  drive::ProcedureRequest request;
  request.kind = Kind::set_position;
  request.position = position;
  return impl_->ask(bus::ProcedureCommand{axis, request});
}

std::future<Answer> Robot::readObject(const std::string& axis, const std::string& object) {
  return impl_->ask(bus::ReadObjectCommand{axis, object});
}

std::future<Answer> Robot::writeObject(const std::string& axis, const std::string& object,
                                       const std::string& value) {
  return impl_->ask(bus::WriteObjectCommand{axis, object, value});
}

void Robot::command(const std::string& axis, double value) {
  const std::optional<std::size_t> index = impl_->axis(axis);
  if (!index) return impl_->tell(bus::noSuchAxis(axis));
  const auto refused = [refusals = impl_->refusals](const bus::Answer& answer) {
    (void)refusals->push(std::string(answer.message));  // a flood of them tells nothing more
  };
  impl_->runner.post(bus::Command(bus::SetpointCommand{*index, value}, refused));
}

std::future<bus::TrajectoryOutcome> Robot::follow(
    const std::string& group, const std::vector<std::string>& joints,
    const std::vector<motion::TrajectoryPoint>& points) {
  const auto promise = std::make_shared<std::promise<bus::TrajectoryOutcome>>();
  bus::TrajectoryCommand command;
  command.group = group;
  command.joints = joints;
  command.points = points;
  command.ended = [promise](const bus::TrajectoryOutcome& outcome) { promise->set_value(outcome); };
  const auto answered = [promise](const bus::TrajectoryAnswer& answer) {
    if (answer.success) return;  // its end is told
    bus::TrajectoryOutcome outcome;
    outcome.code = answer.code;
    outcome.message = answer.message;
    outcome.end = bus::TrajectoryEnd::refused;
    promise->set_value(outcome);
  };
  impl_->runner.post(bus::Command(std::move(command), answered));
  return promise->get_future();
}

std::vector<JointStatus> Robot::state() const {
  impl_->runner.look();
  const bus::NetworkSnapshot shown = impl_->runner.snapshot();
  std::vector<JointStatus> joints;
  for (const motion::Joint& known : impl_->config.joints()) {
    const bus::JointState& state = shown.joints[joints.size()];
    JointStatus joint;
    joint.name = known.name;
    joint.position = state.position;
    joint.velocity = state.velocity;
    joint.effort = state.effort;
    joint.enabled = joint.homed = true;
    for (std::size_t i = 0; i < impl_->config.axes.size(); ++i) {
      if (impl_->config.turns(impl_->config.axes[i], known.name)) {
        addAxis(impl_->config.axes[i], shown.axes[i], joint);
      }
    }
    joints.push_back(std::move(joint));
  }
  return joints;
}

void Robot::poll() {
  bus::Event event;
  while (impl_->runner.nextEvent(event)) impl_->tell(std::string(event.text.view()));
  std::string refusal;
  while (impl_->refusals->pop(refusal)) impl_->tell(refusal);
}

}  // namespace cia402
