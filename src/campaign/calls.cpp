// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/calls.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <type_traits>
#include <utility>

#include "bus/canopen/history_command.h"
#include "bus/canopen/nmt_command.h"
#include "bus/jobs/home_command.h"
#include "bus/jobs/object_commands.h"
#include "bus/jobs/procedure_command.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using Source = Permits::Source;

struct Procedure {
  ProcedureKind kind;
  Duration bound;  ///< until it must be answered
};

const std::map<std::string, Procedure>& procedures() {
  static const std::map<std::string, Procedure> kProcedures{
      {"enable", {ProcedureKind::enable, 16s}},
      {"disable", {ProcedureKind::disable, 18s}},
      {"home", {ProcedureKind::home, 20s}},  // and the time-outs of all homings
      {"clear_faults", {ProcedureKind::clear_faults, 9s}},
      {"recover", {ProcedureKind::recover, 60s}},
      {"quick_stop", {ProcedureKind::quick_stop, 8s}},
      {"halt", {ProcedureKind::halt, 4s}},
      {"set_mode", {ProcedureKind::set_mode, 24s}},
      {"set_position", {ProcedureKind::set_position, 3s}},
      {"save", {ProcedureKind::save_parameters, 25s}},
      {"restore", {ProcedureKind::restore_parameters, 60s}}};
  return kProcedures;
}

std::string axisWord(const std::string& who) { return who == "all" ? std::string() : who; }

/// Whether it is done to both sides of a gantry.
bool asOne(const std::string& verb) {
  return procedures().count(verb) != 0 && verb != "save" && verb != "restore";
}

/// Whether an axis stands, or is to stand, once such a call has succeeded.
bool stops(const std::string& verb) {
  return verb == "halt" || verb == "disable" || verb == "quick_stop";
}

bool bringsToRest(const std::string& verb) {
  return stops(verb) || verb == "set_mode" || verb == "set_position" || verb == "save" ||
         verb == "restore";
}

}  // namespace

Calls::Calls(Session& session, Line& line) : session_(session), line_(line) {}

template <typename Request>
void Calls::call(const Words& words, Request request, Duration bound) {
  const bool argued = words[0] == "set_mode" || words[0] == "nmt";
  Call call;
  call.verb = words[0];
  call.who = words[1];
  call.argument = argued ? words.at(2) : "";
  call.axes =
      asOne(words[0]) ? session_.stage.namedAsOne(words[1]) : session_.stage.named(words[1]);
  if (words[0] == "home") {  // of a group, or of all, those that have a homing
    auto& axes = call.axes;
    const auto none = [&](std::size_t i) { return !session_.stage.axes()[i].config->homing; };
    axes.erase(std::remove_if(axes.begin(), axes.end(), none), axes.end());
  }
  this->call(std::move(call), std::move(request), bound);
}

template <typename Request>
void Calls::call(Call call, Request request, Duration bound) {
  if (!session_.stage.host().running()) return;
  Pending pending;
  pending.call = std::move(call);
  pending.call.at = session_.now();
  pending.call.stalled = session_.conditions.stalled;
  for (const AxisTruth& truth : session_.truths) pending.call.modes.push_back(truth.mode);
  pending.deadline = session_.now() + bound;
  pending_.push_back(pending);
  permitHoming(pending.call);
  session_.onCall(pending.call);
  const auto take = [this, call = pending.call, done = pending.answered](const auto& answer) {
    if (*done) {
      session_.report("answered_twice", call.who, call.verb + ": " + answer.message);
    }
    *done = true;
    answered(call, answer);
    using Given = std::decay_t<decltype(answer)>;
    if constexpr (std::is_same_v<Given, bus::ProcedureReport>) judgeStopped(call, answer);
  };
  if constexpr (std::is_same_v<Request, bus::HomeCommand>) {
    line_.post(bus::Command(std::move(request), take));
  } else {
    line_.post(bus::Command(std::move(request), line_.replied(bus::Reply<>(take))));
  }
}

void Calls::home(const Words& words) {
  const bool ordered = words.size() > 2;
  std::vector<int> orders;
  for (const std::string& order : ordered ? listed(words[2]) : Words()) {
    orders.push_back(static_cast<int>(toNumber(order)));
  }
  const auto plan = bus::homingPlan(session_.stage.loaded().robot, listed(words.at(1)), orders);
  if (!plan) return session_.say("< homing: " + plan.error().message);
  Call call;
  call.verb = "home";
  call.who = words[1];
  Duration bound = 20s;
  for (const bus::HomingItem& item : *plan) {
    for (std::size_t axis : session_.stage.namedAsOne(session_.stage.axes()[item.axis].name)) {
      const bool known = std::count(call.axes.begin(), call.axes.end(), axis) != 0;
      if (!known) call.axes.push_back(axis);
    }
    bound += session_.stage.axes()[item.axis].homing_timeout;
  }
  bus::HomeCommand command;
  command.plan = *plan;
  command.id = ++last_home_;
  this->call(std::move(call), std::move(command), bound);
}

void Calls::cancelHome() {
  if (!session_.stage.host().running()) return;
  session_.stage.host().post(bus::Command(bus::CancelHomeCommand{last_home_}));
}

void Calls::judgeStopped(const Call& call, const bus::ProcedureReport& report) {
  if (!report.stopped) return;
  for (const bus::ProcedureReport::Axis& axis : report.axes) {
    const std::size_t i = axis.number;
    const Permits& permits = session_.permits;
    const bool led = std::max({permits.until(i, Source::stream), permits.until(i, Source::target),
                               permits.until(i, Source::trajectory)}) > session_.now();
    const bool begun = axis.message.find("not started") == std::string::npos;
    // One that was homed before the others takes commands again, and may be braked after one.
    const bool homed = axis.message.find(": homed by") != std::string::npos;
    const bool commanded = homed && permits.given(i) > call.at;
    const bool stands = std::fabs(session_.truths[i].velocity) <= session_.stage.axes()[i].creep();
    const bool told = axis.message.find("it moves") != std::string::npos;
    // Nothing tells whether the motor stands of a drive that is cut off, or without power.
    const bool heard = session_.now() >= session_.conditions.axes[i].unheard;
    if (led || commanded || !begun || stands || told || !heard) continue;
    session_.report("untrue_answer", session_.stage.axes()[i].name,
                    call.verb + " was ended and is answered (" + axis.message +
                        ") while the motor turns at " + number(session_.truths[i].velocity) +
                        " per s");
  }
}

bool Calls::actProcedure(const Words& words) {
  const std::string& verb = words[0];
  const auto procedure = procedures().find(verb);
  if (procedure == procedures().end()) return false;
  drive::ProcedureRequest request;
  request.kind = procedure->second.kind;
  if (verb == "set_mode") request.mode = words.at(2);
  if (verb == "set_position") request.position = toNumber(words.at(2));
  Duration bound = procedure->second.bound;
  for (std::size_t i : session_.stage.namedAsOne(words.at(1))) {
    if (verb == "home") bound += session_.stage.axes()[i].homing_timeout;
  }
  bus::ProcedureCommand command{axisWord(words[1]), request};
  if (session_.stage.group(words[1]) != nullptr) std::swap(command.axis, command.group);
  call(words, std::move(command), bound);
  return true;
}

bool Calls::act(const Words& words) {
  const std::string& verb = words[0];
  if (actProcedure(words)) return true;
  if (verb == "homing") {
    home(words);
  } else if (verb == "cancel_home") {
    cancelHome();
  } else if (verb == "nmt") {
    call(words, bus::NmtServiceCommand{axisWord(words.at(1)), words.at(2)}, 60s);
  } else if (verb == "read") {
    call(words, bus::ReadObjectCommand{words.at(1), words.at(2)}, 15s);
  } else if (verb == "write") {
    call(words, bus::WriteObjectCommand{words.at(1), words.at(2), words.at(3)}, 15s);
  } else if (verb == "history") {
    call(words, bus::ErrorHistoryCommand{words.at(1)}, 30s);
  } else {
    return false;
  }
  return true;
}

void Calls::permitHoming(const Call& call) {
  if (call.verb != "home") return;
  for (std::size_t i : call.axes) {
    if (!session_.stage.axes()[i].homes_by_moving) continue;
    session_.permits.allow(i, Permits::Source::homing, kNever);
  }
}

void Calls::answered(const Call& call, const bus::Answer& answer) {
  session_.say("< " + call.verb + " " + call.who + (answer.success ? ": " : " FAILED: ") +
               answer.message);
  session_.look();  // as they are now, not a millisecond ago
  session_.onAnswer(call, answer);
  endPermits(call, answer);
}

bool Calls::homesStill(std::size_t axis) const {
  return std::any_of(pending_.begin(), pending_.end(), [axis](const Pending& other) {
    return other.call.verb == "home" && !*other.answered &&
           std::count(other.call.axes.begin(), other.call.axes.end(), axis) != 0;
  });
}

/// A homing that waited for its turn at the call goes on when that has come: only stops withdraw
/// it.
bool Calls::waitsToHome(const Call& call, std::size_t axis) const {
  constexpr int kHomingMode = 6;  // 6061h
  const bool began = axis >= call.modes.size() || call.modes[axis] == kHomingMode;
  return !stops(call.verb) && !began && homesStill(axis);
}

void Calls::endPermits(const Call& call, const bus::Answer& answer) {
  const Time now = session_.now();
  for (std::size_t i : call.axes) {
    const AxisTruth& truth = session_.truths[i];
    if (call.verb == "home" && !homesStill(i)) {
      const Duration stop = session_.stage.axes()[i].stopTime(truth.velocity);
      session_.permits.cut(i, Permits::Source::homing, now + (answer.success ? 0ms : stop));
    }
    // The mode that it is in already is no reason to stop anything.
    const bool same =
        call.verb == "set_mode" && i < call.modes.size() && call.modes[i] == truth.mode;
    if (bringsToRest(call.verb) && answer.success && !same) {
      session_.permits.end(i, waitsToHome(call, i) ? Time() : call.at, now);
    }
  }
}

void Calls::watchDeadlines() {
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    const Call& call = pending->call;
    const Duration stalled = session_.conditions.stalled - call.stalled;
    const bool late = !*pending->answered && session_.now() > pending->deadline + stalled;
    if (late) {
      session_.report("late_answer", call.who,
                      call.verb + " was called at " +
                          number(toSeconds(call.at.time_since_epoch())) +
                          " s and is not answered yet");
    }
    pending = late || *pending->answered ? pending_.erase(pending) : std::next(pending);
  }
}

}  // namespace cia402::campaign
