// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/axis_news.h"

#include <algorithm>

#include "bus/axis_condition.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

Event::Severity severityOf(drive::NoticeKind kind) {
  switch (kind) {
    case drive::NoticeKind::error:
      return Event::Severity::error;
    case drive::NoticeKind::warning:
      return Event::Severity::warning;
    case drive::NoticeKind::information:
      return Event::Severity::info;
  }
  return Event::Severity::error;
}

Event::Severity severityOf(Condition condition) {
  return condition >= Condition::error ? Event::Severity::error : Event::Severity::warning;
}

/// Why an axis is brought to rest though nobody stopped it.
std::string dryText(const drive::AxisConfig& config, const drive::ModeSpec& mode) {
  const bool effort = mode.kind == drive::ControlKind::torque;
  const char* then = !effort                     ? "it is ramped to rest"
                     : config.brake_after_effort ? "it is braked (command_timeout_action: brake)"
                                                 : "it coasts (command_timeout_action: coast)";
  return std::string("its stream of ") + (effort ? "efforts" : "velocities") +
         " ended without a zero: nothing came for " + secondsText(config.command_timeout) +
         " (command_timeout), so " + then;
}

}  // namespace

void AxisNews::tellStream(const drive::Axis& axis, Time now) {
  dried_up_ = axis.stream().dried_up;
  const drive::ModeSpec* mode = axis.state().mode;
  const bool says = dried_up_ && mode != nullptr;
  const std::string text = says ? dryText(axis.config(), *mode) : std::string();
  say(&AxisWords::stream, text);
  const bool told = notices_ != axis.noticeCount();  // that it is braked, by the axis
  if (says && !told) tell(*events_, Event::Severity::warning, who_ + ": " + text, now);
}

void AxisNews::checkAgain(drive::Axis& axis, AxisReporter& reporter, const BusSide& bus, Time now) {
  checked_ = now;
  if (isUnwell(axis)) tellNews(axis, reporter, bus, now);
}

/// What it says of itself may change without its state.
bool AxisNews::isUnwell(const drive::Axis& axis) const {
  const drive::AxisState& state = axis.state();
  const bool well = state.health == fieldbus::Health::ready && !drive::isFault(state.state) &&
                    state.state != drive::State::unknown && state.feedback_valid && !state.warning;
  return !well || axis.procedure().running || !words_.problem.empty();
}

/// What is no news by itself is taken over: it need not be looked at again.
bool AxisNews::differs(const drive::AxisCondition& shown) {
  const bool news = told_.state != shown.state || told_.health != shown.health ||
                    told_.error_code != shown.error_code || told_.warning != shown.warning;
  if (!news) told_ = shown;
  return news;
}

void AxisNews::note(const drive::Axis& axis, Time now) {
  const drive::AxisState& state = axis.state();
  if (drive::isFault(state.state) && !drive::isFault(told_.state)) fault_unexplained_ = true;
  told_ = state;
  procedure_ = axis.procedure().id;
  running_ = axis.procedure().running;
  checked_ = now;
}

void AxisNews::tellNews(drive::Axis& axis, AxisReporter& reporter, const BusSide& bus, Time now) {
  note(axis, now);
  const drive::ProcedureStatus& procedure = axis.procedure();
  const fieldbus::Device& device = axis.device();
  const bool booting = axis.state().health != fieldbus::Health::ready;
  const std::string preparation = bus.preparationOf(index_);
  say(&AxisWords::step, !preparation.empty() ? preparation
                        : booting            ? device.bootStep()
                                             : procedure.step);
  say(&AxisWords::waiting_for, procedure.running ? procedure.waiting_for : std::string());
  if (device.paused()) return;  // no feedback comes, and nothing is wrong with that
  tellProblem(axis, reporter, now);
}

void AxisNews::tellProblem(drive::Axis& axis, AxisReporter& reporter, Time now) {
  const drive::AxisState& state = axis.state();
  const std::string& of_device = axis.device().problem();
  std::string problem = !of_device.empty() ? of_device : axis.faultText();
  if (problem.empty()) problem = unknownProblem(axis, now);
  if (state.health == fieldbus::Health::ready) cause_.clear();
  if (!cause_.empty()) problem = cause_;
  const bool told_by_health = !of_device.empty();
  const bool noticed = tellNotices(axis, !told_by_health, problem, now);
  const std::uint32_t version = words_.version;
  if (axis.faultTextAwaited() && told_.health == fieldbus::Health::ready) return;
  say(&AxisWords::problem, problem);
  if (words_.version == version) return;
  if (!problem.empty()) words_.remember(problem, now);
  if (problem.empty() || told_by_health || noticed) return;
  const bool stops = axis.config().profile->warning_stops;
  reporter.problem(severityOf(conditionOf(state, stops, true)), state.error_code, problem, now);
}

/// Several may have come since the last look at the axis.
/// @return one of them tells of the problem
bool AxisNews::tellNotices(const drive::Axis& axis, bool aloud, const std::string& problem,
                           Time now) {
  bool tells = false;
  const std::uint32_t kept = std::min(axis.noticeCount() - notices_, drive::Notices::kKept);
  for (std::uint32_t back = kept; back-- > 0;) {
    const drive::Notice& notice = axis.notice(axis.noticeCount() - back);
    tells = tells || notice.text.find(problem) != std::string::npos;
    if (!aloud) continue;
    const Event::Severity severity = severityOf(notice.kind);
    tell(*events_, severity, notice.text, now);
    if (severity == Event::Severity::error) words_.remember(notice.text, now);
  }
  notices_ = axis.noticeCount();
  return tells;
}

/// Unknown is a problem once the drive has had the time to send its first TPDOs.
std::string AxisNews::unknownProblem(const drive::Axis& axis, Time now) {
  std::string text = axis.unknownText();
  if (text.empty()) {
    unknown_since_ = kNever;
    return text;
  }
  unknown_since_ = std::min(unknown_since_, now);
  return now - unknown_since_ < patience_ ? std::string() : text;
}

}  // namespace cia402::bus
