// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The services of a robot.
#include <algorithm>
#include <map>

#include "campaign/player.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

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

}  // namespace

bool Player::actCall(const Words& words) {
  const std::string& verb = words[0];
  const auto procedure = procedures().find(verb);
  if (procedure != procedures().end()) {
    drive::ProcedureRequest request;
    request.kind = procedure->second.kind;
    if (verb == "set_mode") request.mode = words.at(2);
    if (verb == "set_position") request.position = toNumber(words.at(2));
    Duration bound = procedure->second.bound;
    for (std::size_t i : stage_.named(words.at(1))) {
      if (verb == "home") bound += stage_.axes()[i].homing_timeout;
    }
    call(words, bus::ProcedureCommand{axisWord(words.at(1)), request}, bound);
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

void Player::call(const Words& words, decltype(bus::Command::body) body, Duration bound) {
  if (!stage_.host().running()) return;
  Pending pending;
  pending.call = {words[0],
                  words[1],
                  words[0] == "set_mode" || words[0] == "nmt" ? words.at(2) : "",
                  stage_.named(words[1]),
                  stage_.now(),
                  conditions_.stalled};
  for (const AxisTruth& truth : truths_) pending.call.modes.push_back(truth.mode);
  pending.deadline = stage_.now() + bound;
  pending_.push_back(pending);
  if (words[0] == "home") {
    for (std::size_t i : pending.call.axes) {
      if (stage_.axes()[i].homes_by_moving) permits_.allow(i, Permits::Source::homing, kNever);
    }
  }
  for (auto& oracle : oracles_) oracle->onCall(pending.call, view());
  bus::Command command;
  command.body = std::move(body);
  command.reply = [this, call = pending.call, done = pending.answered](const bus::Answer& answer) {
    if (*done) report("answered_twice", call.who, call.verb + ": " + answer.message);
    *done = true;
    answered(call, answer);
  };
  post(std::move(command));
}

void Player::answered(const Call& call, const bus::Answer& answer) {
  say("< " + call.verb + " " + call.who + (answer.success ? ": " : " FAILED: ") + answer.message);
  const Time now = stage_.now();
  stage_.look(truths_);  // as they are now, not a millisecond ago
  permits_.watch(truths_, now);
  const View seen = view();
  for (auto& oracle : oracles_) {
    oracle->look(seen);
    oracle->onAnswer(call, answer, seen);
  }
  for (std::size_t i : call.axes) {
    const auto homes_still = [&](const Pending& other) {
      return other.call.verb == "home" && !*other.answered &&
             std::count(other.call.axes.begin(), other.call.axes.end(), i) != 0;
    };
    if (call.verb == "home" && std::none_of(pending_.begin(), pending_.end(), homes_still)) {
      const double speed = truths_[i].velocity;
      permits_.cut(i, Permits::Source::homing,
                   now + (answer.success ? 0ms : stage_.axes()[i].stopTime(speed)));
    }
    const bool stands = call.verb == "halt" || call.verb == "disable" ||
                        call.verb == "quick_stop" || call.verb == "set_mode" ||
                        call.verb == "set_position" || call.verb == "save" ||
                        call.verb == "restore";
    // The mode that it is in already is no reason to stop anything.
    const bool same =
        call.verb == "set_mode" && i < call.modes.size() && call.modes[i] == truths_[i].mode;
    if (stands && answer.success && !same) permits_.end(i, call.at, now);
  }
}

void Player::dropCalls() { pending_.clear(); }

void Player::watchDeadlines() {
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    if (*pending->answered) {
      pending = pending_.erase(pending);
      continue;
    }
    if (stage_.now() > pending->deadline + (conditions_.stalled - pending->call.stalled)) {
      report("late_answer", pending->call.who,
             pending->call.verb + " was called at " +
                 number(toSeconds(pending->call.at.time_since_epoch())) +
                 " s and is not answered yet");
      pending = pending_.erase(pending);
      continue;
    }
    ++pending;
  }
}

}  // namespace cia402::campaign
