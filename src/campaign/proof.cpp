// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/proof.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include "bus/jobs/procedure_command.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr Duration kRecoverTime = 20s;
constexpr const char* kDisableFirst = ": disable, then enable";  // the words of an axis
constexpr const char* kDisableFor = "disable it first";
constexpr const char* kOnSwitch = "limit switch";
constexpr const char* kStopped = "home was stopped by quick_stop";
constexpr const char* kFreeDrive = ", in the same drive, may be under power: disable it first";

bool contains(const std::string& text, const char* words) {
  return text.find(words) != std::string::npos;
}

/// Whether a recovery that failed names the calls that help: for halted axes, for those that lost
/// their zero, and for those that share their drive.
bool asksForMore(const std::string& text) {
  return contains(text, kFreeDrive) || contains(text, kOnSwitch) || contains(text, ": enable") ||
         contains(text, kDisableFirst) || contains(text, " is not homed: home") ||
         contains(text, " is not homed: set_position");
}

/// Whether the targets of a mode have one sign.
bool pushesOneWay(const AxisFacts& facts, const drive::ModeSpec& mode) {
  const drive::ObjectSpec* const target = facts.config->profile->find(mode.target);
  return target != nullptr && target->range && target->range->low >= 0.0;
}

drive::ProcedureKind kindOf(const std::string& verb) {
  if (verb == "clear_faults") return drive::ProcedureKind::clear_faults;
  if (verb == "home") return drive::ProcedureKind::home;
  if (verb == "set_position") return drive::ProcedureKind::set_position;
  if (verb == "enable") return drive::ProcedureKind::enable;
  if (verb == "disable") return drive::ProcedureKind::disable;
  return drive::ProcedureKind::recover;
}

}  // namespace

void Proof::noRecovery(const std::string& axis, const std::string& text) {
  session_.report("no_recovery", axis, text);
}

void Proof::run() {
  runFor(4s);
  // A search for home may take its time.
  while (calls_.waits() && !session_.failed()) runFor(10ms);
  if (session_.failed()) return;
  const Time began = session_.now();
  if (!recover()) return;
  session_.say("  recovered within " + number(toSeconds(session_.now() - began)) + " s");
  for (const AxisFacts& facts : session_.stage.axes()) {
    // While others moved, a drive may have begun to warn of the switch on which its axis stands.
    if (session_.failed() || !enable(facts)) return;
    if (facts.coupled.size() == 1) move(facts.index);
  }
  moveJoints();
}

void Proof::moveJoints() {
  const std::vector<JointFacts>& joints = session_.stage.joints();
  for (const config::GroupConfig& group : session_.stage.loaded().robot.groups) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const bool within = std::count(group.joints.begin(), group.joints.end(), joints[i].name) != 0;
      if (!within || joints[i].axes.size() == 1) continue;
      if (session_.failed() || !takesTrajectories(group)) break;
      moveJoint(group, i);
    }
  }
}

bool Proof::outside(const JointFacts& joint) const {
  const double at = session_.shown(joint);
  return (joint.limits.lower && at < *joint.limits.lower) ||
         (joint.limits.upper && at > *joint.limits.upper);
}

bool Proof::takesTrajectories(const config::GroupConfig& group) {
  for (const JointFacts& joint : session_.stage.joints()) {
    const auto& names = group.joints;
    if (std::count(names.begin(), names.end(), joint.name) != 0 && outside(joint)) return false;
  }
  const std::vector<std::size_t> axes = session_.stage.named(group.name);
  return std::all_of(axes.begin(), axes.end(), [this](std::size_t i) {
    const AxisFacts& facts = session_.stage.axes()[i];
    const drive::ModeSpec* const mode = modeOf(i);
    const bool follows =
        mode != nullptr && mode->cyclic && mode->kind == drive::ControlKind::position;
    return follows && !session_.truths[i].at_switch && !skewed(facts);
  });
}

/// Sides of a gantry that may stand so far apart that they are to be homed first.
bool Proof::skewed(const AxisFacts& facts) const {
  if (!facts.gantry) return false;
  const config::CouplingConfig* const coupling =
      session_.stage.loaded().robot.couplingOf(facts.name);
  const double skew = session_.shown(facts.coupled[1]) - session_.shown(facts.coupled[0]);
  return std::fabs(skew) > 0.9 * coupling->gantry->skew_window;
}

void Proof::moveJoint(const config::GroupConfig& group, std::size_t joint) {
  const JointFacts& facts = session_.stage.joints()[joint];
  const double at = session_.shown(facts);
  const motion::JointLimits& limits = facts.limits;
  const bool bounded = limits.lower && limits.upper;
  const double step = 0.05 * facts.velocity;
  const double middle = bounded ? (*limits.lower + *limits.upper) / 2.0 : at + 1.0;
  if (bounded && *limits.upper - *limits.lower < 4.0 * step) return;
  const double way = middle >= at ? step : -step;
  const double from = facts.position(session_.truths);
  const auto refused = [&](const std::string& why) {
    noRecovery(group.name, "a trajectory is refused when all is well again: " + why);
  };
  constexpr double kSeconds = 1.0;
  trajectories_.nudge(group, {joint, way}, kSeconds, refused);
  runFor(fromSeconds(kSeconds) + 1s);
  if (session_.failed()) return;
  const double moved = facts.position(session_.truths) - from;
  const bool held = std::any_of(facts.axes.begin(), facts.axes.end(), [this](std::size_t axis) {
    // By a switch at which it has its home.
    return heldByFault(axis) || session_.now() - session_.limited_at[axis] < 3s;
  });
  if (held || std::fabs(moved - way) <= 0.5 * step) return;
  noRecovery(group.name, facts.name + " was told to move by " + number(way) +
                             " when all was well again, and moved by " + number(moved));
}

bool Proof::recover() {
  if (!call("recover", "all", kRecoverTime)) return false;
  const std::string first = answer_.success ? std::string() : answer_.message;
  if (!first.empty() && !asksForMore(first)) {
    noRecovery("", "recover fails when all is well again: " + first);
    return false;
  }
  if (contains(first, kFreeDrive) && !freeDrives()) return false;
  if (!enableAll() || !homeAll()) return false;
  if (contains(first, kOnSwitch) && !leaveSwitches()) return false;
  if (!first.empty() && !call("recover", "all", kRecoverTime)) return false;
  if (answer_.success) return true;
  // Its zero may have been declared so that its limits lie beyond the switch.
  for (const AxisFacts& facts : session_.stage.axes()) {
    const bool held = session_.truths[facts.index].at_switch;
    if (heldByFault(facts.index) || (held && contains(answer_.message, kOnSwitch))) return true;
  }
  noRecovery("", "recover fails when all is well again: " + answer_.message);
  return false;
}

/// Clears faults while all other axes of these drives are disabled: where it takes NMT to clear
/// one, the driver asks for that.
bool Proof::freeDrives() {
  for (const DriveFacts& drive : session_.stage.drives()) {
    std::vector<std::string> faulted, well;
    for (std::size_t i : drive.axes) {
      (session_.truths[i].faulted() ? faulted : well).push_back(session_.stage.axes()[i].name);
    }
    if (faulted.empty()) continue;
    for (const std::string& name : well) {
      if (!call("disable", name, kRecoverTime)) return false;
    }
    for (const std::string& name : faulted) {
      if (!call("clear_faults", name, kRecoverTime)) return false;
    }
  }
  return true;
}

bool Proof::enableAll() {
  const auto& axes = session_.stage.axes();
  return std::all_of(axes.begin(), axes.end(),
                     [this](const AxisFacts& facts) { return enable(facts); });
}

/// An axis that asks for that.
bool Proof::enable(const AxisFacts& facts) {
  const std::string obstacle = session_.stage.host().network().axis(facts.index).obstacle();
  const bool disable = contains(obstacle, kDisableFirst);
  if (!disable && !contains(obstacle, ": enable")) return true;
  if (disable && !call("disable", facts.name, kRecoverTime)) return false;
  return call("enable", facts.name, kRecoverTime);
}

/// Moves off their limit switches what its drive holds there.
bool Proof::leaveSwitches() {
  for (const AxisFacts& facts : session_.stage.axes()) {
    if (!session_.truths[facts.index].at_switch) continue;
    if (!call("enable", facts.name, kRecoverTime)) return false;
    move(facts.index);
    if (session_.failed()) return false;
  }
  return true;
}

bool Proof::homeAll() {
  for (const AxisFacts& facts : session_.stage.axes()) {
    const drive::Axis& axis = session_.stage.host().network().axis(facts.index);
    if (axis.state().homed || heldByFault(facts.index)) continue;
    const bool homes = facts.config->homing.has_value();
    // An absolute axis has lost its zero where the factory's values were restored.
    if (!homes && !contains(axis.obstacle(), ": set_position")) continue;
    const std::string verb = homes ? "home" : "set_position";
    if (!call(verb, facts.name, facts.homing_timeout + 10s)) return false;
    if (!answer_.success && contains(answer_.message, kDisableFor)) {
      if (!call("disable", facts.name, kRecoverTime)) return false;
      if (!call(verb, facts.name, facts.homing_timeout + 10s)) return false;
      if (answer_.success && !call("enable", facts.name, kRecoverTime)) return false;
    }
    // A gantry may stand further apart than its window, by the way of the stop at its end: the
    // first search ends there, and leaves that way to the second.
    if (!answer_.success && facts.gantry && contains(answer_.message, kStopped)) {
      if (!enableAll() || !call(verb, facts.name, facts.homing_timeout + 10s)) return false;
    }
    if (answer_.success) continue;
    noRecovery(facts.name, verb + " fails when all is well again: " + answer_.message);
    return false;
  }
  return true;
}

bool Proof::call(const std::string& verb, const std::string& who, Duration limit) {
  const auto done = std::make_shared<std::optional<bus::Answer>>();
  drive::ProcedureRequest request;
  request.kind = kindOf(verb);
  const bus::ProcedureCommand command{who == "all" ? std::string() : who, request};
  const Call call{
      verb, who, "", session_.stage.namedAsOne(who), session_.now(), session_.conditions.stalled};
  session_.onCall(call);
  const auto reply = [this, done, call](const bus::Answer& given) {
    *done = given;
    calls_.answered(call, given);
  };
  calls_.permitHoming(call);
  session_.say("> " + verb + " " + who);
  session_.stage.host().post(bus::Command(command, reply));
  for (const Time end = session_.now() + limit; session_.now() < end && !*done;) {
    runFor(5ms);
    if (session_.failed()) return false;
  }
  if (*done) {
    answer_ = **done;
    return true;
  }
  noRecovery(who, verb + " is not answered within " + number(toSeconds(limit)) +
                      " s when all is well again");
  return false;
}

bool Proof::heldByFault(std::size_t axis) const {
  return session_.stage.axes()[axis].limit_coasts && session_.truths[axis].at_switch;
}

const drive::ModeSpec* Proof::modeOf(std::size_t axis) {
  const int shown = session_.truths[axis].mode;
  const drive::ModeSpec* const mode = session_.stage.modeOf(axis, shown);
  if (mode != nullptr) return mode;
  noRecovery(session_.stage.axes()[axis].name,
             "its drive shows mode " + std::to_string(shown) + " when all is well again");
  return nullptr;
}

Proof::Step Proof::stepOf(const AxisFacts& facts, const drive::ModeSpec& mode, double at,
                          double sign) const {
  const motion::JointLimits& limits = facts.config->limits;
  // A zero that was declared may leave little between a switch and the limit on the other side.
  const std::optional<double>& end = sign > 0.0 ? limits.upper : limits.lower;
  const double room = end ? (*end - at) * sign : 1e300;
  const bool turns = mode.kind == drive::ControlKind::velocity;
  const bool torque = mode.kind == drive::ControlKind::torque;
  const double step = (turns ? 0.06 : 0.05) * facts.velocity;
  Step made;
  made.expected = (room > 0.0 ? std::min(step, room) : step) * sign;
  made.provable = torque || std::fabs(made.expected) >= 0.2 * step;
  made.value = at + made.expected;
  if (turns) made.value = 0.2 * facts.velocity * sign;  // for 0.3 s
  if (torque) made.value = 0.15 * limits.effort.value_or(1.0) * sign;
  return made;
}

void Proof::move(std::size_t axis, unsigned tried, double last) {
  const AxisFacts& facts = session_.stage.axes()[axis];
  if (heldByFault(axis)) return;
  const drive::ModeSpec* const mode = modeOf(axis);
  if (mode == nullptr) return;
  const motion::JointLimits& limits = facts.config->limits;
  const double from = session_.truths[axis].position, at = session_.shown(axis);
  const double middle =
      limits.lower && limits.upper ? (*limits.lower + *limits.upper) / 2.0 : at + 1.0;
  double sign = tried != 0 ? -last : middle >= at ? 1.0 : -1.0;
  if (pushesOneWay(facts, *mode)) {
    if (session_.truths[axis].at_switch) return;  // it may only push against it
    sign = facts.config->geometry.direction;
    const std::optional<double>& end = sign > 0.0 ? limits.upper : limits.lower;
    if (end && (*end - at) * sign < 0.1 * facts.velocity) return;  // it may not go that way
  }
  const Step step = stepOf(facts, *mode, at, sign);
  if (!step.provable) return;
  streams_.begin(
      axis, [value = step.value](Duration) { return value; }, 0.3, 100.0);
  runFor(300ms + facts.config->command_timeout + facts.stopTime(facts.velocity) + 500ms);
  // It may have met the switch at which it has found its home.
  if (session_.failed() || heldByFault(axis)) return;
  const bool torque = mode->kind == drive::ControlKind::torque;
  const double expected = step.expected;
  const double moved = session_.truths[axis].position - from;
  const bool far_enough = moved * sign > 0.3 * std::fabs(expected);
  const bool too_far =
      !torque && std::fabs(moved) > 3.0 * std::fabs(expected) +
                                        facts.velocity * facts.velocity / facts.acceleration;
  const bool outside = (limits.lower && at < *limits.lower) || (limits.upper && at > *limits.upper);
  if ((torque ? moved * sign > 0.0 : far_enough) && (!too_far || outside)) return;
  // A switch may stand in the way: it lets the axis go back. One that begins to tell so as the axis
  // sets off from it halts that axis, too, so both ways are tried, and the first one again.
  const bool held = facts.units_per_count != 0.0 && session_.now() - session_.limited_at[axis] < 3s;
  if (held && outside) return;  // its limits lie beyond the switch, as its zero was declared
  if (held && tried < 2) {
    if (call("enable", facts.name, kRecoverTime)) move(axis, tried + 1, sign);
    return;
  }
  noRecovery(facts.name, "was told to move by " + number(expected) + " in mode " + mode->name +
                             " when all was well again, and moved by " + number(moved));
}

}  // namespace cia402::campaign
