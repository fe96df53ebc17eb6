// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// After the disturbances the robot comes back, and a small move works.
#include <algorithm>
#include <cmath>
#include <optional>

#include "campaign/player.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr Duration kRecoverTime = 20s;
constexpr const char* kDisableFirst = ": disable, then enable";  // the words of an axis

}  // namespace

void Player::prove() {
  calm();
  runTo(stage_.now() + 4s);
  // A search for home may take its time.
  while (!pending_.empty() && !failed()) runTo(stage_.now() + 10ms);
  if (failed()) return;
  bus::Answer answer;
  const Time began = stage_.now();
  // It names the calls that help: halted axes, and those that lost their zero.
  if (!proveCall("recover", "all", kRecoverTime, answer)) return;
  const std::string first = answer.success ? std::string() : answer.message;
  const bool asks = first.find(": enable") != std::string::npos ||
                    first.find(kDisableFirst) != std::string::npos ||
                    first.find(" is not homed: home") != std::string::npos ||
                    first.find(" is not homed: set_position") != std::string::npos;
  if (!first.empty() && !asks) {
    report("no_recovery", "", "recover fails when all is well again: " + first);
    return;
  }
  for (const AxisFacts& facts : stage_.axes()) {
    const std::string obstacle = stage_.host().robot().axes()[facts.index].obstacle();
    const bool disable = obstacle.find(kDisableFirst) != std::string::npos;
    if (!disable && obstacle.find(": enable") == std::string::npos) continue;
    if (disable && !proveCall("disable", facts.name, kRecoverTime, answer)) return;
    if (!proveCall("enable", facts.name, kRecoverTime, answer)) return;
  }
  for (const AxisFacts& facts : stage_.axes()) {
    const drive::Axis& axis = stage_.host().robot().axes()[facts.index];
    if (axis.state().homed) continue;
    const bool homes = facts.config->homing.has_value();
    // An absolute axis has lost its zero where the factory's values were restored.
    if (!homes && axis.obstacle().find(": set_position") == std::string::npos) continue;
    const std::string verb = homes ? "home" : "set_position";
    if (!proveCall(verb, facts.name, facts.homing_timeout + 10s, answer)) return;
    if (answer.success) continue;
    report("no_recovery", facts.name, verb + " fails when all is well again: " + answer.message);
    return;
  }
  if (!first.empty() && !proveCall("recover", "all", kRecoverTime, answer)) return;
  if (!answer.success) {
    report("no_recovery", "", "recover fails when all is well again: " + answer.message);
    return;
  }
  say("  recovered within " + number(toSeconds(stage_.now() - began)) + " s");
  for (std::size_t i = 0; i < stage_.axes().size() && !failed(); ++i) proveMove(i);
}

bool Player::proveCall(const std::string& verb, const std::string& who, Duration limit,
                       bus::Answer& answer) {
  const auto done = std::make_shared<std::optional<bus::Answer>>();
  bus::Command command;
  drive::ProcedureRequest request;
  request.kind = verb == "home"           ? drive::ProcedureKind::home
                 : verb == "set_position" ? drive::ProcedureKind::set_position
                 : verb == "enable"       ? drive::ProcedureKind::enable
                 : verb == "disable"      ? drive::ProcedureKind::disable
                                          : drive::ProcedureKind::recover;
  command.body = bus::ProcedureCommand{who == "all" ? std::string() : who, request};
  const auto axes = stage_.named(who);
  if (verb == "set_position") request.position = shown(axes.front());
  const Call call{verb, who, "", axes, stage_.now(), conditions_.stalled};
  for (auto& oracle : oracles_) oracle->onCall(call, view());
  command.reply = [this, done, call](const bus::Answer& given) {
    *done = given;
    answered(call, given);
  };
  for (std::size_t i : axes) {
    if (verb == "home" && stage_.axes()[i].homes_by_moving) {
      permits_.allow(i, Permits::Source::homing, kNever);
    }
  }
  say("> " + verb + " " + who);
  stage_.host().post(std::move(command));
  for (const Time end = stage_.now() + limit; stage_.now() < end && !*done;) {
    runTo(stage_.now() + 5ms);
    if (failed()) return false;
  }
  if (*done) {
    answer = **done;
    return true;
  }
  report(
      "no_recovery", who,
      verb + " is not answered within " + number(toSeconds(limit)) + " s when all is well again");
  return false;
}

void Player::proveMove(std::size_t axis, std::optional<double> tried) {
  const AxisFacts& facts = stage_.axes()[axis];
  const drive::DriveProfile& profile = *facts.config->profile;
  const auto mode =
      std::find_if(profile.modes.begin(), profile.modes.end(),
                   [&](const drive::ModeSpec& m) { return m.value == truths_[axis].mode; });
  if (mode == profile.modes.end()) {
    report(
        "no_recovery", facts.name,
        "its drive shows mode " + std::to_string(truths_[axis].mode) + " when all is well again");
    return;
  }
  const drive::AxisLimits& limits = facts.config->limits;
  const double from = truths_[axis].position, at = shown(axis);
  const double middle =
      limits.lower && limits.upper ? (*limits.lower + *limits.upper) / 2.0 : at + 1.0;
  const double sign = tried ? -*tried : middle >= at ? 1.0 : -1.0;
  // A zero that was declared may leave little between a switch and the limit on the other side.
  const std::optional<double>& end = sign > 0.0 ? limits.upper : limits.lower;
  const double room = end ? (*end - at) * sign : 1e300;
  const bool turns = mode->kind == drive::ControlKind::velocity;
  const double step = (turns ? 0.06 : 0.05) * facts.velocity;
  const double expected = (room > 0.0 ? std::min(step, room) : step) * sign;
  const bool torque = mode->kind == drive::ControlKind::torque;
  if (!torque && std::fabs(expected) < 0.2 * step) return;  // no way is left that proves anything
  double value = at + expected;
  if (turns) value = 0.2 * facts.velocity * sign;  // for 0.3 s
  if (torque) {
    value = 0.15 * limits.effort.value_or(1.0) * sign;
  }
  stream(
      axis, [value](Duration) { return value; }, 0.3, 100.0);
  runTo(stage_.now() + 300ms + facts.config->command_timeout + facts.stopTime(facts.velocity) +
        500ms);
  if (failed()) return;
  const double moved = truths_[axis].position - from;
  const bool far_enough = moved * sign > 0.3 * std::fabs(expected);
  const bool too_far =
      !torque && std::fabs(moved) > 3.0 * std::fabs(expected) +
                                        facts.velocity * facts.velocity / facts.acceleration;
  const bool outside = (limits.lower && at < *limits.lower) || (limits.upper && at > *limits.upper);
  if ((torque ? moved * sign > 0.0 : far_enough) && (!too_far || outside)) return;
  // A switch may stand in the way: it lets the axis go back.
  const bool held = facts.units_per_count != 0.0 && stage_.now() - held_[axis] < 3s;
  if (held && outside) return;  // its limits lie beyond the switch, as its zero was declared
  if (held && !tried) {
    bus::Answer answer;
    if (!proveCall("enable", facts.name, kRecoverTime, answer)) return;
    return proveMove(axis, sign);
  }
  report("no_recovery", facts.name,
         "was told to move by " + number(expected) + " in mode " + mode->name +
             " when all was well again, and moved by " + number(moved));
}

}  // namespace cia402::campaign
