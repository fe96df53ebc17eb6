// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What people are told of the axes, as it happens.
#include <algorithm>
#include <cstdio>

#include "cia402_driver/bus/axis_condition.h"
#include "cia402_driver/bus/robot.h"

namespace cia402::bus {
namespace {

constexpr unsigned kHistoryAfterFault = 4;                      // entries
constexpr Duration kHistoryInterval = std::chrono::seconds(5);  // at least, between two readings
constexpr Duration kNewsInterval = std::chrono::milliseconds(100);
constexpr Duration kFirstFeedback =
    std::chrono::milliseconds(500);  // may take so long after a boot

Event::Severity severityOf(Condition condition) {
  return condition == Condition::error ? Event::Severity::error : Event::Severity::warning;
}

/// Why an axis is brought to rest though nobody stopped it.
std::string dryText(const drive::AxisConfig& config, const drive::ModeSpec& mode) {
  char timeout[24];
  std::snprintf(timeout, sizeof timeout, "%g s", toSeconds(config.command_timeout));
  const bool effort = mode.kind == drive::ControlKind::torque;
  const char* then = !effort                     ? "it is ramped to rest"
                     : config.brake_after_effort ? "it is braked (command_timeout_action: brake)"
                                                 : "it coasts (command_timeout_action: coast)";
  return std::string("its stream of ") + (effort ? "efforts" : "velocities") +
         " ended without a zero: nothing came for " + timeout + " (command_timeout), so " + then;
}

std::string joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += (text.empty() ? "" : "; ") + sentence;
  return text;
}

}  // namespace

void Robot::readHistoryAfterFault(std::size_t axis, Time now) {
  AxisNews& news = news_[axis];
  const bool recently = news.history_asked != Time() && now < news.history_asked + kHistoryInterval;
  if (recently || shutdown_ != Shutdown::no) return;
  news.history_asked = now;
  news.history_wanted = false;
  histories_.emplace_back(
      axes_[axis], kHistoryAfterFault, [this, axis](const canopen::ErrorHistory& history) {
        const std::string text = historyText(*axes_[axis].config().profile, history);
        news_[axis].words.say(&AxisWords::history, text);
        if (!history.readable) return;  // many drives keep none
        tell(Event::Severity::info,
             nodes_[axis]->who() + ": the drive's error history (1003h), newest first: " + text,
             now_);
      });
}

/// Unknown is a problem once the drive has had the time to send its first TPDOs.
std::string Robot::unknownProblem(std::size_t axis, Time now) {
  AxisNews& news = news_[axis];
  std::string text = axes_[axis].unknownText();
  if (text.empty()) {
    news.unknown_since = kNever;
    return text;
  }
  news.unknown_since = std::min(news.unknown_since, now);
  const drive::AxisConfig& config = config_.axes[axis];
  const Duration patience =
      kFirstFeedback + config_.deviceOf(config).stale_after * config.sync_period;
  return now - news.unknown_since < patience ? std::string() : text;
}

void Robot::watchStream(std::size_t axis, Time now) {
  AxisNews& news = news_[axis];
  news.dried_up = motions_[axis].driedUp();
  const drive::ModeSpec* mode = axes_[axis].state().mode;
  const bool say = news.dried_up && mode != nullptr;
  const std::string text = say ? dryText(config_.axes[axis], *mode) : std::string();
  news.words.say(&AxisWords::stream, text);
  const bool told = news.notices != axes_[axis].noticeCount();  // that it is braked, by the axis
  if (say && !told) tell(Event::Severity::warning, nodes_[axis]->who() + ": " + text, now);
}

/// One line in the log; what else there is to say of the boot stands in the words of the axis.
void Robot::tellBooted(std::size_t axis, Time now) {
  const canopen::Node& node = *nodes_[axis];
  AxisNews& news = news_[axis];
  char took[16];
  std::snprintf(took, sizeof(took), "%.2f s", toSeconds(now - news.boot_began));
  const std::string booted = std::string("booted in ") + took;
  const std::string warnings = joined(node.notes());
  const std::string remarks = joined(node.remarks());
  news.words.say(&AxisWords::boot, booted + (warnings.empty() ? "" : "; " + warnings) +
                                       (remarks.empty() ? "" : "; " + remarks));
  const bool well = warnings.empty();
  tell(well ? Event::Severity::info : Event::Severity::warning,
       node.who() + ": " + booted + ": " +
           (well ? "identified, configured and started" : "it works, but " + warnings),
       now);
}

void Robot::watchAxes(Time now) {
  for (AxisReporter& reporter : reporters_) reporter.tick(now);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    AxisNews& news = news_[i];
    const bool pdos_fail = nodes_[i]->image().troubles() != news.pdo_troubles;
    const bool failed_pdos_shown = !news.words.stale.empty();  // looked at again
    if (pdos_fail || failed_pdos_shown) watchPdos(i, now);
    if (news.history_wanted) readHistoryAfterFault(i, now);
    if (news.dried_up != motions_[i].driedUp()) watchStream(i, now);
    if (news.differ(axes_[i])) {
      tellNews(i, now);
    } else if (now >= news.checked + kNewsInterval) {
      news.checked = now;
      if (isUnwell(i)) tellNews(i, now);
    }
  }
}

/// What it says of itself may change without its state.
bool Robot::isUnwell(std::size_t axis) const {
  const drive::AxisState& state = axes_[axis].state();
  const bool well = state.health == fieldbus::Health::ready && !drive::isFault(state.state) &&
                    state.state != drive::State::unknown && state.feedback_valid && !state.warning;
  return !well || axes_[axis].procedure().running || !news_[axis].words.problem.empty();
}

void Robot::tellNews(std::size_t axis, Time now) {
  AxisNews& news = news_[axis];
  const drive::AxisState& state = axes_[axis].state();
  const drive::ProcedureStatus& procedure = axes_[axis].procedure();
  if (drive::isFault(state.state) && !drive::isFault(news.state)) news.history_wanted = true;
  news.state = state.state;
  news.health = state.health;
  news.error_code = state.error_code;
  news.feedback_valid = state.feedback_valid;
  news.warning = state.warning;
  news.procedure = procedure.id;
  news.running = procedure.running;
  news.checked = now;
  fieldbus::Device& node = axes_[axis].device();
  const bool booting = state.health != fieldbus::Health::ready;
  const bool in_lss = lss_.busy() && lss_.who() == config_.axes[axis].name;
  news.words.say(&AxisWords::step, in_lss    ? lss_.step()
                                   : booting ? node.bootStep()
                                             : procedure.step);
  news.words.say(&AxisWords::waiting_for,
                 procedure.running ? procedure.waiting_for : std::string());
  if (node.paused()) return;  // no feedback comes, and nothing is wrong with that
  tellProblem(axis, now);
}

void Robot::tellProblem(std::size_t axis, Time now) {
  AxisNews& news = news_[axis];
  const drive::AxisState& state = axes_[axis].state();
  fieldbus::Device& node = axes_[axis].device();
  std::string problem = !node.problem().empty() ? node.problem() : axes_[axis].faultText();
  if (problem.empty()) problem = unknownProblem(axis, now);
  if (state.health == fieldbus::Health::ready) lss_problems_[axis].clear();
  if (!lss_problems_[axis].empty()) problem = lss_problems_[axis];  // the reason for what follows
  const bool noticed = news.notices != axes_[axis].noticeCount();
  const bool told_by_health = !node.problem().empty();
  news.notices = axes_[axis].noticeCount();
  if (noticed && !told_by_health) {
    tell(axes_[axis].noticeWarns() ? Event::Severity::warning : Event::Severity::error,
         axes_[axis].notice(), now);
  }
  const std::uint32_t version = news.words.version;
  news.words.say(&AxisWords::problem, problem);
  if (news.words.version == version) return;
  const bool told =
      told_by_health || (noticed && axes_[axis].notice().find(problem) != std::string::npos);
  if (problem.empty() || told) return;
  const bool stops = axes_[axis].config().profile->warning_stops;
  reporters_[axis].problem(severityOf(conditionOf(state, stops, true)), state.error_code, problem,
                           now);
}

}  // namespace cia402::bus
