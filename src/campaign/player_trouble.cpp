// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What goes wrong: the host, the bus, the drives, and strangers on the bus.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "campaign/player.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;
using Source = Permits::Source;

Duration seconds(const std::string& word) { return fromSeconds(toNumber(word)); }

/// A drive that plans its motion itself goes on planning while its rotor is blocked: what it takes
/// to stop that demand, and to come back from it to where the axis was told to stop meanwhile.
Duration catchingUp(const AxisFacts& axis, Duration blocked) {
  const double stop = axis.velocity / axis.acceleration;
  const double ahead = axis.velocity * (toSeconds(blocked) + 0.5 * stop);
  return fromSeconds(stop + 2.0 * std::sqrt(ahead / axis.acceleration));
}

}  // namespace

bool Player::actTrouble(const Words& words) {
  const std::string& verb = words[0];
  const Time now = stage_.now();
  if (verb == "loss" || verb == "duplicate" || verb == "corrupt" || verb == "delay") {
    double& rate = verb == "loss"        ? rates_.loss
                   : verb == "duplicate" ? rates_.duplicate
                   : verb == "corrupt"   ? rates_.corrupt
                                         : rates_.delay;
    rate = toNumber(words.at(1));
    const Duration length = seconds(words.at(2));
    if (verb == "delay") rates_.longest_delay = seconds(words.at(3));
    stage_.world().bus().faults().setRates(rates_);
    Conditions::extend(conditions_.lossy, now + length + 300ms);
    // Who follows a SYNC from elsewhere stands still where that is lost.
    const Duration waits = stage_.loaded().robot.bus.external_sync ? length : 0ms;
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      permits_.stretch(i, 500ms + waits, now + length + waits + 1s);
    }
    later(length, [this, &rate] {
      rate = 0.0;
      stage_.world().bus().faults().setRates(rates_);
    });
    return true;
  }
  if (verb == "sync") {  // sync PERIOD SECONDS: a second producer
    foreign_->setAttached(true);
    const Time end = now + seconds(words.at(2));
    Conditions::extend(conditions_.foreign, end + 500ms);
    const Duration period = seconds(words.at(1));
    const auto counter = std::make_shared<int>(0);
    const int overflow = stage_.loaded().robot.bus.sync_counter;
    const auto send = std::make_shared<std::function<void()>>();
    *send = [this, period, end, counter, overflow, weak = std::weak_ptr(send)] {
      if (stage_.now() >= end) return;
      can::Frame frame(0x80, {});
      if (overflow != 0) {
        *counter = *counter % overflow + 1;
        frame = can::Frame(0x80, {static_cast<std::uint8_t>(*counter)});
      }
      foreign_->send(frame, stage_.now());
      if (const auto again = weak.lock()) later(period, [again] { (*again)(); });
    };
    later(0ms, [send] { (*send)(); });
    return true;
  }
  if (verb == "foreign_nmt") {  // foreign_nmt A COMMAND
    static const std::pair<const char*, std::uint8_t> kCommands[] = {{"start", 1},
                                                                     {"stop", 2},
                                                                     {"pre_operational", 128},
                                                                     {"reset_node", 129},
                                                                     {"reset_communication", 130}};
    foreign_->setAttached(true);
    for (const auto& [name, code] : kCommands) {
      if (words.at(2) != name) continue;
      const AxisFacts* const facts = stage_.find(words.at(1));
      if (facts == nullptr && words.at(1) != "all") return true;
      const std::uint8_t node = facts != nullptr ? facts->node_id : std::uint8_t{0};
      foreign_->send(can::Frame(0x000, {code, node}), now);
      for (std::size_t i : stage_.named(words.at(1))) {
        Conditions::extend(conditions_.foreign, now + 500ms);
        if (code == 129) Conditions::extend(conditions_.axes[i].may_coast, now + 20ms);
        const bool started =
            code == 1 && !truths_.empty() && truths_[i].nmt == canopen::NmtState::operational;
        if (!started) loseCommands(i, 1s);
      }
      return true;
    }
    throw std::invalid_argument("no such NMT command");
  }
  // unheard A all|service SECONDS: it hears the host, the host hears nothing of it, or TPDOs only
  if (verb == "unheard") {
    const Duration length = seconds(words.at(3));
    for (std::size_t i : stage_.named(words.at(1))) {
      breakLink(i, length);
      sim::FaultRule rule;
      rule.count = std::numeric_limits<unsigned>::max();
      rule.receiver = stage_.host().interface().port().name();
      const std::uint32_t node = stage_.axes()[i].node_id;
      std::vector<std::uint32_t> ids{0x580 + node, 0x700 + node};  // SDO, heartbeat
      if (words.at(2) == "all") {
        ids = {node};
        rule.mask = 0x7F;
      }
      for (const std::uint32_t id : ids) {
        rule.id = id;
        stage_.world().bus().faults().add(rule);
        later(length, [this, rule] { stage_.world().bus().faults().remove(rule); });
      }
    }
    return true;
  }
  if (verb == "nmt_loss") {  // nmt_loss A COUNT: so many NMT commands do not reach it
    for (std::size_t i : stage_.named(words.at(1))) {
      sim::FaultRule rule;
      rule.count = static_cast<unsigned>(toNumber(words.at(2)));
      rule.receiver = stage_.world().port(i).name();
      stage_.world().bus().faults().add(rule);
    }
    return true;
  }
  if (verb == "cable" || verb == "bus_off") {  // cable A|host SECONDS, bus_off A|host SECONDS
    const bool host = words.at(1) == "host";
    const Duration length = seconds(words.at(2));
    for (std::size_t i : stage_.named(host ? "all" : words.at(1))) breakLink(i, length);
    std::vector<sim::Port*> ports;
    if (host) ports.push_back(&stage_.host().interface().port());
    for (std::size_t i : stage_.named(words.at(1))) ports.push_back(&stage_.world().port(i));
    const bool cable = verb == "cable";
    for (sim::Port* port : ports) {
      cable ? port->setAttached(false) : port->forceBusOff();
      later(length, [port, cable] { cable ? port->setAttached(true) : port->requestRecovery(); });
    }
    return true;
  }
  return actHost(words) || actDrive(words);
}

void Player::breakLink(std::size_t axis, Duration duration) {
  Conditions::extend(conditions_.axes[axis].unheard, stage_.now() + duration + 500ms);
  loseCommands(axis, duration);
}

/// An axis that nothing reaches goes on with what it has until it misses the master.
void Player::loseCommands(std::size_t axis, Duration duration) {
  const Time now = stage_.now();
  const AxisFacts& facts = stage_.axes()[axis];
  Conditions::extend(conditions_.axes[axis].cut_off, now + duration + 500ms);
  if (truths_.empty()) return;
  const Time end = now + facts.master_timeout + facts.stopTime(facts.velocity) + 100ms;
  if (permits_.allowed(axis, now)) permits_.allow(axis, Source::stream, end);
  if (duration > facts.master_timeout) permits_.cut(axis, end);
}

bool Player::actHost(const Words& words) {
  const std::string& verb = words[0];
  const Time now = stage_.now();
  tools::VirtualHost& host = stage_.host();
  if (verb == "stall") {  // stall SECONDS
    const Duration length = seconds(words.at(1));
    host.stall(length);
    conditions_.stalled += length;
    Conditions::extend(conditions_.host_late, now + length + 100ms);
    permits_.delay(length, now);
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      const AxisFacts& facts = stage_.axes()[i];
      if (length > facts.master_timeout) {
        permits_.cut(i, now + facts.master_timeout + facts.stopTime(facts.velocity) + 100ms);
      }
    }
  } else if (verb == "late") {  // late MOST SECONDS
    const double most = toNumber(words.at(1));
    const Time end = now + seconds(words.at(2));
    Conditions::extend(conditions_.host_late, end + 100ms);
    // What leads to a place waits at each late cycle and starts anew from rest.
    permits_.delay(Source::trajectory, end - now, now);
    permits_.delay(Source::target, end - now, now);
    for (std::size_t i = 0; i < truths_.size(); ++i) permits_.hinder(i, end);
    late_until_ = std::max(late_until_, end);
    host.setLateness([this, most, end] {
      const Time time = stage_.now();
      if (time >= end) return Duration();
      // Most wake-ups are in time, few are very late.
      const double share = random_.uniform();
      const Duration late = fromSeconds(most * share * share * share * share);
      permits_.delay(late, time);
      return late;
    });
  } else if (verb == "kill") {  // kill SECONDS: until a new process runs
    if (host.running()) kill(seconds(words.at(1)));
  } else if (verb == "shutdown") {
    if (!host.running() || now < ends_at_) return true;
    ends_at_ = now + 2500ms + seconds(words.at(1));
    Call call{"shutdown", "all", "", stage_.named("all"), now, conditions_.stalled};
    for (auto& oracle : oracles_) oracle->onCall(call, view());
    host.stop();
    for (std::size_t i = 0; i < truths_.size(); ++i) permits_.cut(i, now + 2300ms);
    later(2500ms, [this, due = now + 2500ms, stalled = conditions_.stalled] {
      // Earlier only where the history ends sooner.
      if (stage_.now() >= due && stage_.host().running() && conditions_.stalled == stalled) {
        report("late_shutdown", "", "the driver has not ended 2.5 s after it was asked to");
      }
    });
    later(2500ms + seconds(words.at(1)), [this] {
      stage_.host().kill();
      dropCalls();
      startHost();
    });
    Conditions::extend(conditions_.ended, now + 2500ms + seconds(words.at(1)));
  } else {
    return false;
  }
  return true;
}

void Player::kill(Duration gone) {
  const Time now = stage_.now();
  stage_.host().kill();
  dropCalls();
  conditions_.stalled += gone;
  Conditions::extend(conditions_.host_late, now + gone + 100ms);
  for (std::size_t i = 0; i < truths_.size(); ++i) breakLink(i, 1h);
  for (auto& axis : conditions_.axes) axis.cut_off = std::min(axis.cut_off, now + gone + 500ms);
  later(gone, [this] { startHost(); });
}

void Player::startHost() {
  if (stage_.host().running()) return;
  say("  a new driver starts");
  const Time now = stage_.now();
  // It has to find a drive that moves, and stops it before all else.
  for (std::size_t i = 0; i < truths_.size(); ++i) {
    const AxisFacts& facts = stage_.axes()[i];
    if (!permits_.allowed(i, now)) continue;
    permits_.allow(i, Source::stream, now + 1s + facts.stopTime(facts.velocity));
  }
  stage_.host().start();
}

bool Player::actDrive(const Words& words) {
  static const char* const kVerbs[] = {"fault", "clear", "power", "silent",
                                       "mute",  "block", "switch"};
  const std::string& verb = words[0];
  if (std::find(std::begin(kVerbs), std::end(kVerbs), verb) == std::end(kVerbs)) return false;
  const Time now = stage_.now();
  for (std::size_t i : stage_.named(words.at(1))) {
    sim::Drive& drive = stage_.world().drive(i);
    Conditions::Axis& condition = conditions_.axes[i];
    const auto inject = [&drive, now](const std::string& what) {
      const Result<void> done = drive.inject(what, now);
      if (!done) throw std::invalid_argument(done.error().message);
    };
    const auto clear_later = [this, &drive](Duration delay) {
      later(delay, [this, &drive] { (void)drive.inject("clear", stage_.now()); });
    };
    if (verb == "fault") {  // fault A NAME
      static const char* const kCoast[] = {"overcurrent",  "short_circuit", "overvoltage",
                                           "undervoltage", "hardware",      "encoder",
                                           "power_cycle"};
      static const char* const kLast[] = {"short_circuit", "hardware"};
      const auto is = [&](auto& list) {
        return std::find(std::begin(list), std::end(list), words.at(2)) != std::end(list);
      };
      if (is(kCoast)) Conditions::extend(condition.may_coast, now + 20ms);
      if (is(kLast)) dead_[i] = true;
      inject(words.at(2));
      if (words.at(2) == "power_cycle") breakLink(i, 600ms);
    } else if (verb == "clear") {
      inject("clear");
    } else if (verb == "power") {  // power A SECONDS: none for so long
      Conditions::extend(condition.may_coast, now + 20ms);
      const Duration length = seconds(words.at(2));
      breakLink(i, length);
      drive.powerOff(now);
      ++cuts_[i];
      later(length, [this, &drive, i] {
        if (--cuts_[i] == 0) drive.powerOn(stage_.now());
      });
    } else if (verb == "silent") {  // silent A SECONDS: neither hears nor sends
      const Duration length = seconds(words.at(2));
      breakLink(i, length);
      inject("silent");
      clear_later(length);
    } else if (verb == "mute") {  // mute A SECONDS: answers no SDO
      inject("sdo_silent");
      clear_later(seconds(words.at(2)));
    } else if (verb == "block") {  // block A SECONDS: the rotor
      const Duration length = seconds(words.at(2));
      inject("blocked_rotor");
      Conditions::extend(condition.blocked,
                         now + length + 400ms + catchingUp(stage_.axes()[i], length));
      permits_.hinder(i, now + length);
      clear_later(length);
    } else {  // switch A lower|upper SECONDS: a limit switch right where it stands
      sim::AxisMechanics& mechanics = drive.mechanics();
      double& place = words.at(2) == "lower" ? mechanics.negative_limit_switch
                                             : mechanics.positive_limit_switch;
      const double before = place;
      place = drive.truth(now).position_turns;
      later(seconds(words.at(3)), [&place, before] { place = before; });
    }
  }
  return true;
}

/// The world is well again.
void Player::calm() {
  const Time now = stage_.now();
  streams_.clear();
  for (std::size_t i = 0; i < 50 && !later_.empty(); ++i) {  // what still lasts ends now
    std::vector<Later> ending;
    ending.swap(later_);
    for (Later& item : ending) item.what();
  }
  for (const config::GroupConfig& group : stage_.loaded().robot.groups) {
    trajectory(group, {}, {}, false);
  }
  rates_ = {};
  stage_.world().bus().faults().clear();
  stage_.host().setLateness({});
  foreign_->setAttached(false);
  for (std::size_t i = 0; i < stage_.axes().size(); ++i) {
    sim::Drive& drive = stage_.world().drive(i);
    (void)drive.inject("clear", now);
    stage_.world().port(i).setAttached(true);
    stage_.world().port(i).requestRecovery();
    if (dead_[i]) {
      Conditions::extend(conditions_.axes[i].may_coast, now + 20ms);
      (void)drive.inject("power_cycle", now);
    }
    dead_[i] = false;
  }
  stage_.host().interface().port().setAttached(true);
}

}  // namespace cia402::campaign
