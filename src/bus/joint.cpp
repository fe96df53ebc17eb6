// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/joint.h"

#include <algorithm>

#include "bus/coupled_axes.h"

namespace cia402::bus {
namespace {

std::string switchAdvice(const drive::AxisConfig& axis) {
  const drive::ModeSpec* mode = drive::trajectoryMode(axis);
  return mode == nullptr ? "no mode that it can be in does"
                         : "~" + axis.name + "/set_mode " + mode->name + " first";
}

/// Turned by one axis.
class AxisJoint final : public Joint {
 public:
  /// @param unit must outlive it
  explicit AxisJoint(AxisUnit& unit)
      : Joint(drive::jointOf(unit.axis.config()), drive::jointName(unit.axis.config()),
              drive::stopDeceleration(unit.axis.config())),
        unit_(&unit) {}

  void show(JointState& state) const override;
  bool known() const override { return axis().state().feedback_valid; }
  double position() const override { return axis().state().position; }
  Time stamp() const override { return axis().state().stamp; }
  double resolution() const override { return axis().positionResolution(); }
  bool ready() const override { return axis().state().ready_for_motion; }
  const drive::SetPoint& sent() const override { return axis().setPoint(); }
  bool goesOn(std::uint32_t breaks) const override { return ready() && sent().breaks() == breaks; }
  bool endsGoal() const override { return axis().endsGoal(); }
  bool handsOver() const override { return axis().handsOver(); }
  bool late() const override { return axis().late(); }
  std::string refusal(const std::string& group) const override;
  drive::ProcedureKind stoppedBy() const override { return stopCalledOn(axis()); }
  std::string trouble(std::uint32_t told_before) const override;
  std::uint32_t noticeCount() const override { return axis().noticeCount(); }
  [[nodiscard]] bool give(double position) override { return unit_->axis.setTarget(position); }
  void stop(Duration over) override { unit_->axis.stopSetPoint(over); }
  void follow(const std::string* group) override { unit_->axis.follow(group); }
  void adoptLimits() override {
    limitTo(drive::jointOf(axis().config()), drive::stopDeceleration(axis().config()));
  }
  std::string commandRefusal(double value) const override { return axis().commandRefusal(value); }
  Result<void> command(double value, Time at) override { return unit_->axis.command(value, at); }
  const drive::ModeSpec* mode() const override { return axis().state().mode; }
  Duration commandTimeout() const override { return axis().config().command_timeout; }

 private:
  const drive::ProcedureStatus* procedure() const override { return runningOn(axis()); }
  const std::string* leader() const override { return axis().leader(); }
  const drive::Axis& axis() const { return unit_->axis; }

  AxisUnit* unit_;
};

void AxisJoint::show(JointState& state) const {
  const drive::AxisState& from = axis().state();
  state.known = from.feedback_valid;
  state.stamp = from.stamp;
  state.position = from.position;
  state.velocity = from.velocity;
  state.effort = from.effort;
  const bool takes_positions =
      from.mode != nullptr && from.mode->kind == drive::ControlKind::position;
  state.desired = takes_positions ? axis().target() : drive::kUnknown;
  state.desired_velocity = takes_positions ? sent().velocity() : drive::kUnknown;
}

std::string AxisJoint::refusal(const std::string& group) const {
  std::string reason = trajectoryRefusal(axis());
  if (!reason.empty()) return reason;
  if (followsAnother(group)) return who() + " follows a trajectory of group " + *leader();
  // In the cycle in which a trajectory has ended, the stream still knows the way to its goal only.
  const bool rests = axis().stream().at_rest || sent().atRest();
  if (leader() == nullptr && !rests) {
    return who() + " is still moved by streamed set-points: end the stream and let it come to rest";
  }
  return {};
}

std::string AxisJoint::trouble(std::uint32_t told_before) const {
  std::string reason = axis().motionRefusal();
  if (!reason.empty()) return reason;
  if (axis().noticeCount() != told_before) return axis().notice();
  return who() + " fell out of operation or got another zero on the way";
}

}  // namespace

bool inFault(const drive::Axis& axis) {
  const drive::State state = axis.state().state;
  return state == drive::State::fault || state == drive::State::fault_reaction_active;
}

/// An axis that was ready has had another procedure after each that stops: the last one tells.
drive::ProcedureKind stopCalledOn(const drive::Axis& axis) {
  const drive::ProcedureKind last = axis.procedure().kind;
  return drive::stops(last) && !inFault(axis) ? last : drive::ProcedureKind::none;
}

const drive::ProcedureStatus* runningOn(const drive::Axis& axis) {
  return axis.procedure().running ? &axis.procedure() : nullptr;
}

std::string Joint::occupation() const {
  const drive::ProcedureStatus* const status = procedure();
  if (status == nullptr) {
    return "it follows a trajectory of group " + *leader() +
           ", which one without points stops there";
  }
  return std::string(drive::toString(status->kind)) + " runs" +
         (drive::stops(status->kind) ? "" : ", which halt stops");
}

std::string trajectoryRefusal(const drive::Axis& axis) {
  std::string reason = axis.motionRefusal();
  if (!reason.empty()) return reason;
  const drive::ModeSpec* mode = axis.state().mode;
  if (mode != nullptr && mode->cyclic && mode->kind == drive::ControlKind::position) return {};
  return drive::jointName(axis.config()) + " is in mode " + (mode ? mode->name : "unknown") +
         ", which does not follow trajectories: " + switchAdvice(axis.config());
}

Joints::Joints(const config::RobotConfig& robot, std::vector<AxisUnit>& units) {
  for (AxisUnit& unit : units) {
    if (robot.couplingOf(unit.axis.config().name) != nullptr) continue;
    joints_.push_back(std::make_unique<AxisJoint>(unit));
  }
  for (const config::CouplingConfig& coupling : robot.couplings) {
    std::vector<AxisUnit*> coupled;
    for (const std::string& name : coupling.axes) {
      const auto unit = std::find_if(units.begin(), units.end(), [&](const AxisUnit& any) {
        return any.axis.config().name == name;
      });
      coupled.push_back(&*unit);
    }
    couplings_.push_back(
        std::make_unique<CoupledAxes>(coupling, std::move(coupled), robot.bus.sync_period));
    for (auto& joint : couplings_.back()->makeJoints()) joints_.push_back(std::move(joint));
  }
}

Joints::~Joints() = default;

Joint* Joints::find(const std::string& name) {
  const auto found = std::find_if(joints_.begin(), joints_.end(),
                                  [&](const auto& joint) { return joint->name() == name; });
  return found != joints_.end() ? found->get() : nullptr;
}

}  // namespace cia402::bus
