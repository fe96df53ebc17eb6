// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/axis_cycle.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bus/coupled_axes.h"
#include "bus/reply.h"

namespace cia402::bus {
namespace {

constexpr const char* kEnded = "ended by the shutdown of the driver";

std::vector<AxisUnit> unitsOf(const config::RobotConfig& robot,
                              const std::vector<AxisUnit::Place>& places, EventSink& events) {
  std::vector<AxisUnit> units;
  units.reserve(robot.axes.size());
  for (std::size_t i = 0; i < robot.axes.size(); ++i) {
    units.emplace_back(i, robot.axes[i], places[i], events);
  }
  return units;
}

bool knownToStand(const drive::Axis& axis) {
  const drive::AxisState& state = axis.state();
  if (state.health != fieldbus::Health::ready) return true;
  if (std::abs(state.velocity) < axis.config().standstill_velocity) return true;
  return state.feedback_valid && drive::powerStageOff(state.state, state.statusword);
}

}  // namespace

AxisCycle::AxisCycle(const config::RobotConfig& robot, const std::vector<AxisUnit::Place>& places,
                     BusSide& bus, EventSink& events)
    : bus_(bus), events_(events), units_(unitsOf(robot, places, events)), joints_(robot, units_) {
  for (AxisUnit& unit : units_) {
    for (AxisUnit& other : units_) {
      const bool together = places[unit.index].device == places[other.index].device;
      if (&unit != &other && together) unit.axis.addNeighbour(other.axis);
    }
  }
  for (const config::GroupConfig& group : robot.groups) {
    std::vector<Joint*> members;
    for (const std::string& name : group.joints) members.push_back(joints_.find(name));
    groups_.emplace_back(group, std::move(members), robot.bus.sync_period);
  }
}

void AxisCycle::move(Time now) {
  last_cycle_ = now;
  for (AxisUnit& unit : units_) unit.readFeedback(now);
  for (const auto& coupling : joints_.couplings()) coupling->update(now, events_);
  for (Group& group : groups_) {
    for (const TrajectoryOutcome& outcome : group.step(now)) {
      tell(events_,
           outcome.code == motion::TrajectoryErrorCode::successful ? Event::Severity::info
                                                                   : Event::Severity::error,
           outcome.message, now);
    }
  }
  for (const auto& coupling : joints_.couplings()) coupling->move(now);
  for (AxisUnit& unit : units_) unit.move(now);
}

void AxisCycle::stepJobs(Time now) {
  if (jobs_.empty()) return;
  const std::string problem = bus_.enableProblem();
  if (!problem.empty()) jobs_.withdrawEnabling(problem);
  jobs_.step(now);
}

void AxisCycle::stepShutdown(Time now) {
  if (!shutdown_.begun() || !shutdown_.step(*this, now)) return;
  bus_.releaseDevices(now);
  shutdown_.finish();
  jobs_.abandon(Job::Ends::with_motion, kEnded);
  for (AxisUnit& unit : units_) unit.reporter.flush(now);
}

void AxisCycle::hurryProcedures(Time now) {
  any_answered_ = false;
  for (AxisUnit& unit : units_) {
    if (!std::exchange(unit.answered, false)) continue;
    unit.axis.update(now);
  }
  stepJobs(now);
}

void AxisCycle::stopMotion(const std::string& why) {
  for (Group& group : groups_) {
    group.stop({motion::TrajectoryErrorCode::path_tolerance_violated, why});
  }
  for (AxisUnit& unit : units_) {
    if (unit.axis.leader() == nullptr)
      unit.axis.stopSetPoint();  // else its group brings it to rest
  }
}

void AxisCycle::quickStop(const std::string& why, Time now) {
  tell(events_, Event::Severity::error, why, now);
  stopMotion(why);
  for (AxisUnit& unit : units_) {
    drive::ProcedureRequest request;
    request.kind = drive::ProcedureKind::quick_stop;
    const bool may_move =
        unit.axis.state().state == drive::State::operation_enabled || unit.axis.procedure().running;
    if (may_move) (void)unit.axis.start(request, now);
  }
}

void AxisCycle::stopBesideCycle(const std::string& why) {
  stopMotion(why);
  for (AxisUnit& unit : units_) unit.axis.stopBesideCycle(why);
}

void AxisCycle::loseBus(const std::string& why) {
  stopMotion("stopped: " + why);
  jobs_.withdrawEnabling(why);
  for (AxisUnit& unit : units_) unit.axis.onBusLost(why);
}

void AxisCycle::endMotion(Time now) {
  jobs_.abandon(Job::Ends::at_once, kEnded);
  Shutdown::endMotion(*this, now);
}

void AxisCycle::adoptLimits() {
  for (const auto& joint : joints_.all()) joint->adoptLimits();
  for (Group& group : groups_) group.adoptLimits();
}

std::string AxisCycle::motionProblem() const {
  for (const Group& group : groups_) {
    if (group.executing() || group.stopping()) {
      return "refused: the group " + group.config().name + " is in motion";
    }
  }
  for (const AxisUnit& unit : units_) {
    if (knownToStand(unit.axis)) continue;
    return "refused: " + drive::whoIs(unit.axis.config()) + " may be in motion; stop it first";
  }
  return {};
}

AxisUnit* AxisCycle::find(const std::string& axis) {
  const auto unit = std::find_if(units_.begin(), units_.end(),
                                 [&](const AxisUnit& u) { return u.axis.config().name == axis; });
  return unit == units_.end() ? nullptr : &*unit;
}

Result<AxisUnit*> AxisCycle::findToAsk(const std::string& axis, const std::string& what) {
  AxisUnit* const unit = find(axis);
  if (unit == nullptr) return Error{noSuchAxis(axis)};
  const std::string why_not = unit->axis.device().askingRefusal(what);
  if (!why_not.empty()) return Error{why_not};
  return unit;
}

void AxisCycle::sayStep(const std::string& step) {
  for (AxisUnit& unit : units_) unit.news.say(&AxisWords::step, step);
}

}  // namespace cia402::bus
