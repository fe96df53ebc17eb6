// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/robot.h"

#include <algorithm>

#include "cia402_driver/canopen/received_identifiers.h"
#include "cia402_driver/drive/fault_text.h"

namespace cia402::bus {
namespace {

constexpr Duration kStopTime = std::chrono::milliseconds(1000);     // ramps at shutdown
constexpr Duration kDisableTime = std::chrono::milliseconds(1800);  // from the start of shutdown

}  // namespace

Robot::Robot(config::RobotConfig robot, canopen::MasterConfig master, can::Sink& sink,
             EventSink& events)
    : config_(std::move(robot)),
      events_(events),
      listener_(master, config_.bus.listen),
      foreseen_(canopen::receivedIdentifiers(master)),
      master_(std::move(master), sink, this),
      sink_(sink),
      lss_(sink),
      external_sync_(config_.bus.sync_period, config_.bus.sync_counter) {
  const Duration cycle = config_.bus.sync_period;
  for (const drive::AxisConfig& axis : config_.axes) {
    nodes_.push_back(master_.find(config_.deviceOf(axis).node_id));
    axes_.emplace_back(axis, *nodes_.back());
    motions_.emplace_back(axis, cycle);
  }
  for (const config::GroupConfig& group : config_.groups) {
    std::vector<std::size_t> members;
    for (const std::string& joint : group.joints) {
      const auto axis = std::find_if(config_.axes.begin(), config_.axes.end(),
                                     [&](const drive::AxisConfig& a) { return a.joint == joint; });
      members.push_back(static_cast<std::size_t>(axis - config_.axes.begin()));
    }
    groups_.emplace_back(group, std::move(members), axes_);
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    reporters_.emplace_back(i, nodes_[i]->who(), axes_[i].config().profile, events_);
  }
  news_.resize(axes_.size());
  missed_feedback_.resize(axes_.size());
  last_feedback_.resize(axes_.size());
  answered_.resize(axes_.size());
  lss_problems_.resize(axes_.size());
}

void Robot::busLost(const std::string& why, Time now) {
  now_ = now;
  if (!started_ || !bus_lost_.empty()) return;
  bus_lost_ = why;
  stopMotion("stopped: " + why);
  withdrawEnabling(why);
  for (drive::Axis& axis : axes_) axis.onBusLost(why);
}

void Robot::busBack(bool is_news, Time now) {
  if (bus_lost_.empty()) return;
  bus_lost_.clear();
  if (!is_news) return;
  tell(Event::Severity::info,
       config_.bus.interface +
           " is back: drives that were lost are configured again; the axes stay "
           "disabled until enable or recover",
       now);
}

void Robot::receive(const can::Frame& frame, Time stamp, Time now) {
  now_ = now;
  if (listener_.listening()) {
    listenTo(frame, now);
    if (frame.id == canopen::kSyncCobId) return;  // there is no cycle yet that it could lead
  }
  lss_.receive(frame, now);
  master_.receive(frame, stamp, now);
}

void Robot::onSdoAnswer(canopen::Node& node) { answered_[axisOf(node)] = any_answered_ = true; }

/// Whose drive answered by SDO need not wait for the next cycle, nor who called for the answer: the
/// next cycle may be late, and the answer no longer true. Not in receive(), for behind the drive's
/// answer there may be frames that tell what has become of it since.
void Robot::hurryProcedures(Time now) {
  if (!any_answered_) return;
  any_answered_ = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (answered_[i]) axes_[i].update(now);
    answered_[i] = false;
  }
  stepJobs(now);
}

Time Robot::nextDeadline() const {
  if (!started_ || shutDown()) return kNever;
  return std::min({next_sync_, next_cycle_, master_.nextDeadline(), lss_.nextDeadline()});
}

void Robot::onSyncDue(Time now) {
  if (!started_ || shutDown() || config_.bus.external_sync) return;
  now_ = now;
  sync(now);
}

void Robot::tick(Time now) {
  if (!started_ || shutDown()) return;
  now_ = now;
  if (listener_.listening()) return stepListening(now);
  hurryProcedures(now);
  if (now >= next_sync_) config_.bus.external_sync ? lackSync(now) : sync(now);
  if (now >= next_cycle_) cycle(now);
  if (now >= master_.nextDeadline()) master_.tick(now);
  if (now >= lss_.nextDeadline()) stepLss(now);
}

bool Robot::mayProduceSync() {
  if (!sync_held_) return true;
  const auto& nodes = master_.nodes();
  const auto is = [](fieldbus::Health health) {
    return [health](const canopen::Node& node) { return node.health() == health; };
  };
  const auto started = [](const canopen::Node& node) { return node.started(); };
  sync_held_ = std::none_of(nodes.begin(), nodes.end(), started) &&
               std::any_of(nodes.begin(), nodes.end(), is(fieldbus::Health::booting));
  return !sync_held_;
}

void Robot::sync(Time now) {
  if (mayProduceSync()) master_.sendSync(now);
  const Duration late = now - next_sync_;
  statistics_.syncSent(late);
  const Duration period = config_.bus.sync_period;
  if (late >= period / 4) noteLateness(late, now);
  const bool overtaken = next_cycle_ != kNever;
  if (overtaken) statistics_.cyclesSkipped(1);
  // Under load every SYNC might overtake the cycle before: then none would ever run.
  next_cycle_ = overtaken ? now : now + period / 2;
  next_sync_ += period;
  if (next_sync_ <= now) {  // never a burst of SYNCs: what was missed is left out, and counted
    const auto skipped = (now - next_sync_) / period + 1;
    next_sync_ += skipped * period;
    statistics_.cyclesSkipped(static_cast<std::uint64_t>(skipped));
  }
}

void Robot::cycle(Time now) {
  next_cycle_ = kNever;
  last_cycle_ = now;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].readFeedback(now);
    axes_[i].update(now);
    const drive::AxisState& state = axes_[i].state();
    if (state.health == fieldbus::Health::ready && state.stamp == last_feedback_[i]) {
      ++missed_feedback_[i];
    }
    last_feedback_[i] = state.stamp;
  }
  for (Group& group : groups_) {
    if (const auto outcome = group.step(axes_, motions_, now)) {
      tell(outcome->code == motion::TrajectoryErrorCode::successful ? Event::Severity::info
                                                                    : Event::Severity::error,
           outcome->message, now);
    }
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    motions_[i].step(axes_[i], now);
    axes_[i].writeCommands(now);
  }
  master_.sendRpdos(now);
  stepJobs(now);
  lookForLostDrives(now);
  stepShutdown(now);
  watchAxes(now);
  watchSync(now);
}

void Robot::stepJobs(Time now) {
  const auto keep_running = [&](auto& jobs, auto&& step) {
    jobs.erase(std::remove_if(jobs.begin(), jobs.end(), step), jobs.end());
  };
  if (!procedures_.empty()) {
    const std::string problem = enableProblem();
    if (!problem.empty()) withdrawEnabling(problem);
    keep_running(procedures_, [&](ProcedureJob& job) { return job.step(axes_, now); });
  }
  if (!objects_.empty()) keep_running(objects_, [&](ObjectJob& job) { return job.step(now); });
  if (!nmt_.empty()) keep_running(nmt_, [&](NmtJob& job) { return job.step(nodes_, now); });
  if (!histories_.empty()) keep_running(histories_, [](HistoryJob& job) { return job.step(); });
  if (!dcfs_.empty()) keep_running(dcfs_, [](DcfJob& job) { return job.step(); });
}

void Robot::stopMotion(const std::string& why) {
  for (Group& group : groups_) {
    group.stop({motion::TrajectoryErrorCode::path_tolerance_violated, why}, axes_);
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) motions_[i].stop(axes_[i]);
}

void Robot::withdrawEnabling(const std::string& why) {
  for (ProcedureJob& job : procedures_) job.withdrawEnabling(why, axes_);
}

void Robot::beginShutdown(Time now) {
  if (shutdown_ != Shutdown::no) return;
  // Before the nodes were booted there is nothing to stop.
  const bool booted = started_ && !lss_starting_ && !listener_.listening();
  shutdown_ = booted ? Shutdown::stopping : Shutdown::done;
  abandonStart("the driver is shutting down");
  shutdown_began_ = now;
  lss_.abandon("ended by the shutdown of the driver", now);
  // What waits for its turn must not begin any more.
  for (ProcedureJob& job : procedures_) job.abandon("ended by the shutdown of the driver");
  procedures_.clear();
  for (NmtJob& job : nmt_) job.abandon("ended by the shutdown of the driver");
  nmt_.clear();
  stopMotion("stopped: the driver is shutting down");
  // What runs by itself would go on while the set-points of other axes are ramped down.
  for (drive::Axis& axis : axes_) {
    const drive::ProcedureStatus& procedure = axis.procedure();
    const bool runs = procedure.running && !drive::stops(procedure.kind);
    if (runs || axis.setPoint().kind() == drive::SetPointKind::goal) disableAtShutdown(axis, now);
  }
}

void Robot::disableAtShutdown(drive::Axis& axis, Time now) {
  drive::ProcedureRequest request;
  request.kind = drive::ProcedureKind::disable;
  const drive::ProcedureStatus& procedure = axis.procedure();
  if (procedure.running && procedure.kind == request.kind) return;
  (void)axis.start(request, now);  // not ready: nothing to do
}

void Robot::stepShutdown(Time now) {
  if (shutdown_ == Shutdown::no) return;
  if (shutdown_ == Shutdown::stopping) {
    const bool at_rest = std::all_of(motions_.begin(), motions_.end(),
                                     [](const AxisMotion& m) { return m.atRest(); }) &&
                         std::none_of(groups_.begin(), groups_.end(),
                                      [](const Group& g) { return g.executing() || g.stopping(); });
    if (!at_rest && now < shutdown_began_ + kStopTime) return;
    shutdown_ = Shutdown::disabling;
    for (drive::Axis& axis : axes_) disableAtShutdown(axis, now);
    return;
  }
  if (shutdown_ == Shutdown::disabling) {
    const bool disabled = std::none_of(axes_.begin(), axes_.end(), [](const drive::Axis& axis) {
      return axis.state().health == fieldbus::Health::ready && axis.procedure().running;
    });
    if (!disabled && now < shutdown_began_ + kDisableTime) return;
    master_.commandAll(canopen::NmtCommand::enter_pre_operational, now);
    shutdown_ = Shutdown::done;
    for (ObjectJob& job : objects_) job.abandon("ended by the shutdown of the driver");
    objects_.clear();
    for (HistoryJob& job : histories_) job.abandon("ended by the shutdown of the driver");
    histories_.clear();
    for (AxisReporter& reporter : reporters_) reporter.flush(now);
    for (DcfJob& job : dcfs_) job.abandon("ended by the shutdown of the driver");
    dcfs_.clear();
  }
}

drive::Axis* Robot::axisNamed(const std::string& name, const Reply& reply) {
  for (drive::Axis& axis : axes_) {
    if (axis.config().name == name) return &axis;
  }
  refuse(reply, noSuchAxis(name));
  return nullptr;
}

drive::Axis* Robot::axisToAsk(const std::string& name, const std::string& what,
                              const Reply& reply) {
  drive::Axis* axis = axisNamed(name, reply);
  if (axis == nullptr) return nullptr;
  const std::string refusal = axis->device().askingRefusal(what);
  if (refusal.empty()) return axis;
  refuse(reply, refusal);
  return nullptr;
}

std::size_t Robot::axisOf(const canopen::Node& node) const {
  const auto found = std::find(nodes_.begin(), nodes_.end(), &node);
  return static_cast<std::size_t>(found - nodes_.begin());
}

void Robot::tell(Event::Severity severity, std::string_view text, Time now) {
  Event event;
  event.severity = severity;
  event.stamp = now;
  event.text.assign(text);
  events_.onEvent(event);
}

void Robot::onEmergency(canopen::Node& node, const fieldbus::Emergency& emergency) {
  const std::size_t index = axisOf(node);
  if (index == axes_.size()) return;
  const drive::DriveProfile& profile = *axes_[index].config().profile;
  const bool misses =
      drive::missingFrames(profile, emergency.code) != drive::ErrorText::Missing::nothing;
  const std::string excuse = misses ? ownLateness(emergency.stamp) : std::string();
  axes_[index].onEmergency(emergency, now_, excuse);
  reporters_[index].emergency(emergency, now_, excuse);
}

void Robot::onMalformedEmergency(canopen::Node& node, std::size_t size) {
  const std::size_t index = axisOf(node);
  if (index != axes_.size()) reporters_[index].malformedEmergency(size, now_);
}

void Robot::onBootUp(canopen::Node& node, Time now) {
  const std::size_t index = axisOf(node);
  if (index == axes_.size()) return;
  // Part of the boot, which is told when it has ended; the second may come of factory settings.
  if (++news_[index].boot_ups > 2) reporters_[index].bootUp(now);
}

void Robot::onHealthChange(canopen::Node& node, fieldbus::Health before, Time now) {
  const std::size_t index = axisOf(node);
  if (index == axes_.size()) return;
  axes_[index].onHealthChange(before, now);
  const fieldbus::Health health = node.health();
  AxisNews& news = news_[index];
  if (health == fieldbus::Health::booting) {
    news.boot_began = now;
  } else {
    news.boot_ups = 0;
  }
  const bool asked_for = health == fieldbus::Health::booting || shutdown_ != Shutdown::no;
  if (asked_for) return;
  if (health == fieldbus::Health::ready) return tellBooted(index, now);
  std::string text = node.problem();  // names the node itself
  if (text.empty()) text = node.who() + ": " + toString(health);
  if (node.excused()) text += "; it is optional, the others go on without it";
  tell(node.excused() ? Event::Severity::warning : Event::Severity::error, text, now);
}

}  // namespace cia402::bus
