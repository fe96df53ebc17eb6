// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/coupled_axes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/text.h"

namespace cia402::bus {
namespace {

constexpr double kBeyond = 1e-6;     // of a range: what trajectories may exceed it by
constexpr double kRoundedBy = 1e-9;  // of a position, by the matrix

double decelerationOf(const motion::Joint& joint) {
  drive::AxisConfig like;  // an axis without limits stops alike
  like.limits = joint.limits;
  if (joint.unit == motion::JointUnit::metre) {
    like.geometry.type = drive::AxisGeometry::Type::prismatic;
  }
  return drive::stopDeceleration(like);
}

motion::Joint skewOf(const config::CouplingConfig& config) {
  motion::Joint skew;
  skew.name = "skew of " + config.joints.front().name;
  if (!config.gantry) return skew;
  skew.limits.velocity = config.gantry->squaring_velocity;
  skew.limits.acceleration = config.gantry->squaring_acceleration;
  return skew;
}

class CoupledJoint final : public Joint {
 public:
  /// @param axes must outlive it
  CoupledJoint(CoupledAxes& axes, std::size_t index)
      : Joint(axes.config().joints[index],
              axes.config().joints[index].name + " (axes " + joined(axes.config().axes, ", ") + ")",
              decelerationOf(axes.config().joints[index])),
        axes_(&axes),
        index_(index) {}

  const CoupledAxes* coupling() const override { return axes_; }
  void show(JointState& state) const override { axes_->show(index_, state); }
  bool known() const override { return !std::isnan(axes_->positionOf(index_)); }
  bool partIsLed() const override { return !axes_->axesRest(); }
  bool partMoves() const override { return axes_->axesMove(); }
  double position() const override { return axes_->positionOf(index_); }
  Time stamp() const override { return axes_->stampOf(index_); }
  double resolution() const override { return axes_->resolutionOf(index_); }
  bool ready() const override { return axes_->ready(); }
  bool handsOver() const override { return axes_->handOver(); }
  const drive::SetPoint& sent() const override { return axes_->sentOf(index_); }
  bool goesOn(std::uint32_t breaks) const override { return ready() && sent().breaks() == breaks; }
  bool late() const override { return axes_->late(); }
  /// The joints of a coupling are asked together: one answers for all.
  std::string refusal(const std::string& group) const override {
    const std::string reason = index_ == 0 ? axes_->refusal(group) : std::string();
    return reason.empty() ? reason : who() + ": " + reason;
  }
  drive::ProcedureKind stoppedBy() const override { return axes_->stoppedBy(); }
  std::string trouble(std::uint32_t) const override { return who() + ": " + axes_->trouble(); }
  std::uint32_t noticeCount() const override { return axes_->noticeCount(); }
  [[nodiscard]] bool give(double position) override { return axes_->give(index_, position); }
  void stop(Duration over) override { axes_->stop(index_, over); }
  void follow(const std::string* group) override { axes_->follow(group); }
  /// Its limits are its own.
  void adoptLimits() override {}
  std::string commandRefusal(double) const override {
    return who() + ": several axes move it, which takes trajectories alone";
  }
  Result<void> command(double value, Time) override { return Error{commandRefusal(value)}; }
  const drive::ModeSpec* mode() const override { return nullptr; }
  Duration commandTimeout() const override { return Duration::zero(); }

 private:
  const drive::ProcedureStatus* procedure() const override { return axes_->procedure(); }
  const std::string* leader() const override { return axes_->leader(); }

  CoupledAxes* axes_;
  std::size_t index_;
};

}  // namespace

CoupledAxes::CoupledAxes(const config::CouplingConfig& config, std::vector<AxisUnit*> units,
                         Duration cycle)
    : config_(config), units_(std::move(units)), squaring_(skewOf(config)), cycle_(cycle) {
  const auto size = static_cast<Eigen::Index>(units_.size());
  for (Eigen::VectorXd* values : {&positions_, &velocities_, &efforts_, &wanted_, &targets_}) {
    *values = Eigen::VectorXd::Constant(size, drive::kUnknown);
  }
  for (const motion::Joint& joint : config_.joints) {
    sent_.emplace_back(joint.limits, decelerationOf(joint), cycle);
  }
  breaks_.resize(units_.size());
  notices_.resize(units_.size());
  if (config_.gantry) watch_.emplace(config_, *units_[0], *units_[1]);
  for (AxisUnit* unit : units_) unit->coupling = this;
}

std::vector<std::unique_ptr<Joint>> CoupledAxes::makeJoints() {
  std::vector<std::unique_ptr<Joint>> joints;
  for (std::size_t i = 0; i < config_.joints.size(); ++i) {
    joints.push_back(std::make_unique<CoupledJoint>(*this, i));
  }
  return joints;
}

std::string CoupledAxes::streamRefusal(const drive::AxisConfig& axis) const {
  std::string joints;
  for (const motion::Joint& joint : config_.joints) append(joints, joint.name, ", ");
  return drive::jointName(axis) + ": set-point refused: the axes " + joined(config_.axes, ", ") +
         " move " + joints +
         " together, and the limits are those of the joints: send a trajectory to their group";
}

void CoupledAxes::update(Time now, EventSink& events) {
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const drive::AxisState& state = units_[i]->axis.state();
    const auto place = static_cast<Eigen::Index>(i);
    const bool known = state.feedback_valid;
    positions_(place) = known ? state.position : drive::kUnknown;
    velocities_(place) = known ? state.velocity : drive::kUnknown;
    efforts_(place) = known ? state.effort : drive::kUnknown;
  }
  if (watch_) {
    const std::string why = watch_->watch();
    if (!why.empty()) stopBoth(why, now, events);
  }
  if (driving_ && broken()) breakOff();
  if (!driving_) return rebase();
  if (!late()) return;
  for (drive::SetPoint& sent : sent_) sent.interrupt();
}

/// By the drives' own ramps, in this cycle.
void CoupledAxes::stopBoth(const std::string& why, Time now, EventSink& events) {
  bool any = false;
  for (AxisUnit* unit : units_) {
    const drive::ProcedureStatus& procedure = unit->axis.procedure();
    const bool stops = procedure.running && (procedure.kind == drive::ProcedureKind::disable ||
                                             procedure.kind == drive::ProcedureKind::quick_stop);
    const bool may_move =
        unit->axis.state().state == drive::State::operation_enabled || procedure.running;
    if (stops || !may_move) continue;
    drive::ProcedureRequest request;
    request.kind = drive::ProcedureKind::quick_stop;
    if (!unit->axis.start(request, now)) continue;
    unit->axis.update(now);
    any = true;
  }
  if (!any) return;
  stopped_ = why;
  tell(events, Event::Severity::error, config_.joints.front().name + " (gantry): " + why, now);
}

bool CoupledAxes::broken() const {
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (units_[i]->axis.setPoint().breaks() != breaks_[i]) return true;
  }
  return !ready();
}

/// Where one of them comes to rest by a ramp of its own the others take as long for theirs, so that
/// they stay on their way; else they stop as hard as they may.
void CoupledAxes::breakOff() {
  driving_ = false;
  Duration over = Duration::zero();
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const drive::Axis& axis = units_[i]->axis;
    const drive::SetPoint& sent = axis.setPoint();
    if (sent.breaks() == breaks_[i] || !sent.stopping()) continue;
    const double deceleration = drive::stopDeceleration(axis.config());
    over = std::max(over, fromSeconds(std::fabs(sent.velocity()) / deceleration));
  }
  for (std::size_t i = 0; i < units_.size(); ++i) {
    drive::Axis& axis = units_[i]->axis;
    if (axis.setPoint().breaks() == breaks_[i]) axis.stopSetPoint(over);
  }
  rebase();
}

/// Nobody moves the joints: their set-points are where those of the axes are.
void CoupledAxes::rebase() {
  bool changed = false;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const drive::SetPoint& sent = units_[i]->axis.setPoint();
    const double value = takesPositions() ? sent.value() : drive::kUnknown;
    const auto place = static_cast<Eigen::Index>(i);
    const bool same =
        value == targets_(place) || (std::isnan(value) && std::isnan(targets_(place)));
    changed = changed || !same || breaks_[i] != sent.breaks();
    targets_(place) = value;
    breaks_[i] = sent.breaks();
  }
  if (!changed) return;
  for (std::size_t joint = 0; joint < sent_.size(); ++joint) {
    sent_[joint].rest(drive::SetPointKind::stream, config_.matrix->toJoint(joint, targets_));
  }
  skew_ = {};
  if (watch_) skew_.position = config_.matrix->toJoint(1, targets_);
}

bool CoupledAxes::give(std::size_t joint, double position) {
  if (!ready() || !std::isfinite(position)) return false;
  const motion::JointLimits& limits = config_.joints[joint].limits;
  const double from = sent_[joint].value();
  const double range = limits.lower && limits.upper ? *limits.upper - *limits.lower : 1.0;
  const double within = motion::withinReach(limits, position, from);
  if (std::fabs(within - position) > kBeyond * range) return false;
  if (!driving_) begin();
  sent_[joint].give(within);
  return true;
}

void CoupledAxes::begin() {
  driving_ = true;
  stopped_.clear();
  for (std::size_t i = 0; i < units_.size(); ++i) notices_[i] = units_[i]->axis.noticeCount();
  squares_ = false;
  squaring_.reset(skew_, clock_);
}

void CoupledAxes::move(Time now) {
  if (!driving_) return;
  bool leased = false, moves = false;
  for (std::size_t joint = 0; joint < sent_.size(); ++joint) {
    drive::SetPoint& sent = sent_[joint];
    sent.advance(now);
    wanted_(static_cast<Eigen::Index>(joint)) = sent.value();
    leased = leased || sent.leased();
    moves = moves || !sent.atRest();
  }
  if (watch_) wanted_(1) = square(leased);
  config_.matrix->toAxes(wanted_, targets_);
  bool taken = true;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const double target = withinAxis(i, targets_(static_cast<Eigen::Index>(i)));
    taken = units_[i]->axis.setTarget(target) && taken;
  }
  if (!taken) {
    stopped_ =
        "one of its axes refused a set-point: it does not fit the drive or is beyond the "
        "axis' limits";
    return breakOff();
  }
  driving_ = leased || moves || skew_.velocity != 0.0;
}

/// Level sides get one set-point: what they differ by is taken back gently, as long as somebody
/// moves the joint.
double CoupledAxes::square(bool leased) {
  const bool wanted = leased && watch_->level();
  if (wanted && !squares_) (void)squaring_.command(0.0);  // finite, so it is taken
  if (!wanted && squares_) squaring_.reset(skew_, clock_);
  squares_ = wanted;
  clock_ += cycle_;
  skew_ = squaring_.step(clock_);
  return skew_.position;
}

/// The limits of the joints keep the axes within theirs, but for rounding.
double CoupledAxes::withinAxis(std::size_t axis, double value) const {
  const drive::Axis& of = units_[axis]->axis;
  const double within = motion::withinReach(of.config().limits, value, of.target());
  return std::fabs(within - value) <= kRoundedBy * (1.0 + std::fabs(value)) ? within : value;
}

bool CoupledAxes::takesPositions() const {
  return std::all_of(units_.begin(), units_.end(), [](const AxisUnit* unit) {
    const drive::ModeSpec* mode = unit->axis.state().mode;
    return mode != nullptr && mode->kind == drive::ControlKind::position;
  });
}

void CoupledAxes::show(std::size_t joint, JointState& state) const {
  state.position = positionOf(joint);
  state.known = !std::isnan(state.position);
  state.stamp = stampOf(joint);
  state.velocity = config_.matrix->toJoint(joint, velocities_);
  state.effort = config_.matrix->effortToJoint(joint, efforts_);
  const bool takes_positions = takesPositions();
  state.desired = takes_positions ? sent_[joint].value() : drive::kUnknown;
  state.desired_velocity = takes_positions ? sent_[joint].velocity() : drive::kUnknown;
}

/// That of the oldest value that it is made of.
Time CoupledAxes::stampOf(std::size_t joint) const {
  Time oldest = kNever;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(joint), column = static_cast<Eigen::Index>(i);
    if (config_.matrix->matrix()(row, column) == 0.0) continue;
    oldest = std::min(oldest, units_[i]->axis.state().stamp);
  }
  return oldest;
}

double CoupledAxes::resolutionOf(std::size_t joint) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(joint), column = static_cast<Eigen::Index>(i);
    sum += std::fabs(config_.matrix->matrix()(row, column)) * units_[i]->axis.positionResolution();
  }
  return sum;
}

bool CoupledAxes::ready() const {
  return std::all_of(units_.begin(), units_.end(),
                     [](const AxisUnit* unit) { return unit->axis.state().ready_for_motion; });
}

bool CoupledAxes::late() const {
  return std::any_of(units_.begin(), units_.end(),
                     [](const AxisUnit* unit) { return unit->axis.late(); });
}

bool CoupledAxes::axesRest() const {
  return std::all_of(units_.begin(), units_.end(),
                     [](const AxisUnit* unit) { return unit->axis.setPoint().atRest(); });
}

bool CoupledAxes::handOver() const {
  return std::any_of(units_.begin(), units_.end(),
                     [](const AxisUnit* unit) { return unit->axis.handsOver(); });
}

bool CoupledAxes::axesMove() const {
  return std::any_of(units_.begin(), units_.end(), [](const AxisUnit* unit) {
    const drive::AxisState& state = unit->axis.state();
    return state.feedback_valid &&
           std::fabs(state.velocity) >= unit->axis.config().standstill_velocity;
  });
}

std::string CoupledAxes::refusal(const std::string& group) const {
  std::string all;
  for (const AxisUnit* unit : units_) {
    const std::string reason = trajectoryRefusal(unit->axis);
    if (!reason.empty()) append(all, reason);
  }
  if (!all.empty()) return all;
  if (watch_) all = watch_->refusal();
  if (!all.empty()) return all;
  if (leader() != nullptr && *leader() != group) {
    return "follows a trajectory of group " + *leader();
  }
  if (!driving_ && !axesRest()) return "its axes are being brought to rest: wait until they stand";
  return {};
}

/// What stops both sides of a gantry because of one of them was not called by anybody.
drive::ProcedureKind CoupledAxes::stoppedBy() const {
  drive::ProcedureKind by = drive::ProcedureKind::none;
  for (const AxisUnit* unit : units_) {
    if (!stopped_.empty() || inFault(unit->axis)) return drive::ProcedureKind::none;
    if (by == drive::ProcedureKind::none) by = stopCalledOn(unit->axis);
  }
  return by;
}

std::string CoupledAxes::trouble() const {
  if (!stopped_.empty()) return stopped_;
  for (const AxisUnit* unit : units_) {
    std::string reason = unit->axis.motionRefusal();
    if (!reason.empty()) return reason;
  }
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (units_[i]->axis.noticeCount() != notices_[i]) return units_[i]->axis.notice();
  }
  return "one of its axes fell out of operation or got another zero on the way";
}

std::uint32_t CoupledAxes::noticeCount() const {
  std::uint32_t sum = 0;
  for (const AxisUnit* unit : units_) sum += unit->axis.noticeCount();
  return sum;
}

void CoupledAxes::follow(const std::string* group) {
  for (AxisUnit* unit : units_) unit->axis.follow(group);
}

const std::string* CoupledAxes::leader() const { return units_.front()->axis.leader(); }

const drive::ProcedureStatus* CoupledAxes::procedure() const {
  for (const AxisUnit* unit : units_) {
    if (const drive::ProcedureStatus* const status = runningOn(unit->axis)) return status;
  }
  return nullptr;
}

}  // namespace cia402::bus
