// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "fieldbus/bytes.h"
#include "fieldbus/object.h"

namespace cia402::drive::test {

/// What an object holds when it travels in a cycle.
struct Value {
  fieldbus::ObjectId object;
  std::uint64_t raw = 0;
};
using Values = std::vector<Value>;

/// What a drive says when it is asked to give or to take the value of an object.
struct Answer {
  std::uint32_t abort = 0;  ///< why it refuses; 0: it does not
  fieldbus::Bytes data;     ///< what was read
};

/// A small CiA 402 drive, written from the standard's tables and independent of the code under
/// test. It knows no bus, only values: those of the objects that reach it and leave it in each
/// cycle, and those that it is asked for beside that. Device units: 0.0001 rad, 0.0001 rad/s, 0.001
/// of the rated torque.
class FakeDrive {
 public:
  using Key = std::pair<unsigned, unsigned>;  ///< index, sub-index

  enum class S { start, disabled, ready, on, enabled, quick, reaction, fault };

  // What the test may turn.
  S state = S::disabled;
  std::set<S> stuck;          ///< states that no command leaves
  std::vector<S> shows;       ///< one a cycle, whatever it does
  bool dead = false;          ///< is off: nothing reaches it, nothing comes from it
  bool mute = false;          ///< answers for no object, obeys no controlword
  double position = 12345.0;  ///< counts
  double velocity = 0.0;      ///< counts/s
  double coast = 0.0;         ///< counts/s that nothing stops
  int mode_delay = 0;         ///< cycles until 6061h follows 6060h, shows -1 meanwhile
  bool forgets_mode = false;  ///< takes a mode when it is commanded in operation enabled only
  int acknowledge_delay = 0;  ///< cycles
  bool acknowledges = true;
  bool warning = false, voltage = true, remote = true;
  bool knows_home = false;      ///< statusword bit 15
  bool at_limit = false;        ///< stands in profile position, and says so by statusword bit 11
  bool keeps_attained = false;  ///< statusword bit 12 survives leaving the homing mode
  bool never_homes = false, homing_fails = false, homing_moves = true;
  int homing_cycles = 50;
  std::int32_t homing_speed = -1000;         ///< counts/s
  bool fault_persists = false;               ///< comes back right after a reset
  bool quick_stop_ends = true;               ///< transition 12 by itself
  double quick_stop_deceleration = 1e6;      ///< counts/s^2
  bool silent = false;                       ///< gives nothing in its cycles
  std::map<Key, std::uint32_t> aborts;       ///< writes refused
  std::map<Key, std::uint32_t> read_aborts;  ///< reads refused
  std::set<Key> unanswered;                  ///< writes taken in silence
  std::set<Key> unanswered_reads;
  std::map<Key, std::pair<std::uint64_t, unsigned>> dictionary;  ///< value, bytes
  std::set<Key> deaf_to;  ///< writes of these are taken and change nothing
  std::map<Key, std::deque<std::uint64_t>> next_reads;  ///< what the next reads find there instead

  // What the test may look at.
  std::uint16_t controlword = 0;
  std::int8_t mode = 0, commanded_mode = 0;
  std::int32_t target_position = 0, target_velocity = 0, accepted_target = 0;
  std::int16_t target_torque = 0;
  std::vector<std::uint16_t> controlwords;                 ///< each change
  std::vector<std::pair<unsigned, std::uint64_t>> writes;  ///< by request: index, value
  std::map<Key, int> reads;                                ///< requests for each object
  std::map<fieldbus::ObjectId, std::uint64_t> received;    ///< what its cycles brought last
  std::vector<std::int32_t> accepted;  ///< set-points taken by the edge of bit 4
  int homings = 0, resets = 0;
  bool operational = false;
  std::uint16_t error = 0;

  /// 603Fh, whatever happens; not set: the error.
  std::optional<std::uint16_t> error_object;

  FakeDrive() {
    dictionary[{0x1000, 0}] = {0x00020192, 4};
    dictionary[{0x607C, 0}] = {0, 4};
    dictionary[{0x605A, 0}] = {2, 2};
    dictionary[{0x603F, 0}] = {0, 2};
    dictionary[{0x6061, 0}] = {0, 1};
    dictionary[{0x606C, 0}] = {0, 4};
  }

  /// What the master sends in a cycle: it counts from the next one on.
  void receive(const Values& values) {
    if (dead || !operational) return;
    for (const Value& value : values) received[value.object] = value.raw;
  }
  /// A cycle: applies what was received last, moves, and gives its feedback.
  Values cycle(double dt) {
    if (dead || !operational) return {};
    apply();
    step(dt);
    ++cycles_;
    if (silent) return {};
    const auto where = static_cast<std::uint32_t>(static_cast<std::int32_t>(position));
    const auto speed = static_cast<std::uint32_t>(static_cast<std::int32_t>(velocity));
    const auto shown = static_cast<std::uint8_t>(mode);
    const std::uint16_t code = error_object.value_or(error);
    dictionary[{0x603F, 0}].first = code;
    dictionary[{0x6061, 0}].first = shown;
    dictionary[{0x606C, 0}].first = speed;
    return {{{0x6041, 0}, statusword()}, {{0x6064, 0}, where}, {{0x6061, 0}, shown},
            {{0x606C, 0}, speed},        {{0x6077, 0}, 0},     {{0x603F, 0}, code}};
  }
  /// Somebody asks for an object beside the cycle. @return nothing: it does not answer
  std::optional<Answer> read(fieldbus::ObjectId object) {
    if (dead || mute) return {};
    const Key key{object.index, object.subindex};
    ++reads[key];
    if (unanswered_reads.count(key) != 0) return {};
    if (read_aborts.count(key) != 0) return Answer{read_aborts[key], {}};
    const bool communication = object.index >= 0x1010 && object.index < 0x1C00;
    if (dictionary.count(key) == 0 && !communication) return Answer{0x06020000, {}};
    auto [value, size] =
        dictionary.count(key) != 0 ? dictionary[key] : std::make_pair(std::uint64_t{0}, 4u);
    if (std::deque<std::uint64_t>& next = next_reads[key]; !next.empty()) {
      value = next.front();
      next.pop_front();
    }
    fieldbus::Bytes data = fieldbus::toBytes(value, std::min(size, 8u));
    data.resize(size);
    return Answer{0, data};
  }
  std::optional<Answer> write(fieldbus::ObjectId object, const fieldbus::Bytes& data) {
    if (dead || mute) return {};
    const Key key{object.index, object.subindex};
    if (aborts.count(key) != 0) return Answer{aborts[key], {}};
    const std::uint64_t value = fieldbus::toUnsigned(data);
    if (deaf_to.count(key) != 0) return Answer{};
    dictionary[key] = {value, static_cast<unsigned>(data.size())};
    writes.emplace_back(object.index, value);
    if (object.index == 0x6060) {
      commanded_mode = static_cast<std::int8_t>(value);
      mode_written_ = true;
    }
    if (unanswered.count(key) != 0) return {};
    return Answer{};
  }
  /// Fault reaction; the fault itself follows.
  void fail(std::uint16_t code) {
    state = S::reaction;
    reaction_ = 3;
    error = code;
  }
  /// Power cycle: everything is forgotten.
  void reboot() {
    state = S::disabled;
    operational = false;
    mode = commanded_mode = 0;
    controlword = last_ = 0;
    velocity = coast = 0;
    error = 0;
    received.clear();
  }
  std::uint16_t statusword() const {
    static const std::map<S, unsigned> codes = {
        {S::start, 0x00},   {S::disabled, 0x40}, {S::ready, 0x21},    {S::on, 0x23},
        {S::enabled, 0x27}, {S::quick, 0x07},    {S::reaction, 0x0F}, {S::fault, 0x08}};
    unsigned word = codes.at(shows.empty() ? state : shows[cycles_ % shows.size()]);
    if (voltage) word |= 0x0010;
    if (warning) word |= 0x0080;
    if (remote) word |= 0x0200;
    if (at_limit) word |= 0x0800;
    if (knows_home) word |= 0x8000;
    if (mode == 6) {
      if (attained_) word |= 0x1000;
      if (homing_error_) word |= 0x2000;
      if (!homing_) word |= 0x0400;
    } else if (mode == 1) {
      if (acknowledged_) word |= 0x1000;
      if (static_cast<std::int32_t>(position) == accepted_target) word |= 0x0400;
    }
    return static_cast<std::uint16_t>(word);
  }

 private:
  /// What a cycle has brought of an object, or `otherwise`.
  template <typename T>
  T brought(fieldbus::ObjectId object, T otherwise) const {
    const auto found = received.find(object);
    return found == received.end() ? otherwise : static_cast<T>(found->second);
  }

  void apply() {
    if (received.empty()) return;
    const std::uint16_t before = std::exchange(controlword, brought({0x6040, 0}, controlword));
    commanded_mode = brought({0x6060, 0}, commanded_mode);
    target_position = brought({0x607A, 0}, target_position);
    target_velocity = brought({0x60FF, 0}, target_velocity);
    target_torque = brought({0x6071, 0}, target_torque);
    if (!heard_ || before != controlword) controlwords.push_back(controlword);
    heard_ = true;
  }

  void step(double dt) {
    const bool fault_edge = (controlword & 0x80) != 0 && (last_ & 0x80) == 0;
    const bool edge4 = (controlword & 0x10) != 0 && (last_ & 0x10) == 0;
    last_ = controlword;
    follow(fault_edge);
    switchMode();
    move(dt, edge4);
  }

  /// The finite state automaton of CiA 402-2, by the bits of the command table.
  void follow(bool fault_edge) {
    if (state == S::reaction && --reaction_ <= 0) {
      state = S::fault;
      velocity = 0;
    } else if (state == S::fault && fault_edge && !mute) {
      ++resets;
      if (stuck.count(S::fault) != 0) return;
      state = S::disabled;
      if (fault_persists) {
        state = S::reaction;
        reaction_ = 10;
      } else {
        error = 0;
      }
    }
    if ((controlword & 0x80) != 0 || stuck.count(state) != 0 || mute) return;
    const unsigned c = controlword & 0x0F;
    const bool no_voltage = (c & 0x02) == 0;
    const bool quick_stop = !no_voltage && (c & 0x04) == 0;
    const bool shutdown = (c & 0x07) == 0x06;
    const bool switch_on = c == 0x07;
    const bool enable = c == 0x0F;
    switch (state) {
      case S::disabled:
        if (shutdown) state = S::ready;
        break;
      case S::ready:
        if (no_voltage || quick_stop) state = S::disabled;
        if (switch_on || enable) state = S::on;
        break;
      case S::on:
        if (no_voltage || quick_stop) state = S::disabled;
        if (shutdown) state = S::ready;
        if (enable) state = S::enabled;
        break;
      case S::enabled:
        if (no_voltage) state = S::disabled;
        if (shutdown) state = S::ready;
        if (switch_on) state = S::on;
        if (quick_stop) state = S::quick;
        if (state == S::enabled) break;
        homing_ = false;
        break;
      case S::quick:
        if (no_voltage) state = S::disabled;
        if (enable) state = S::enabled;
        if (quick_stop_ends && velocity == 0 && coast == 0) state = S::disabled;
        break;
      default:
        break;
    }
  }

  /// What each cycle repeats is no command; a write by request is one each time.
  bool modeIsCommanded() {
    const bool changed = std::exchange(seen_mode_, commanded_mode) != commanded_mode;
    return std::exchange(mode_written_, false) || changed;
  }

  void switchMode() {
    const bool commanded = modeIsCommanded();
    if (commanded_mode == mode) return;
    if (forgets_mode && (!commanded || state != S::enabled)) return;
    if (mode_delay > 0 && ++mode_wait_ <= mode_delay) {
      mode = -1;
      return;
    }
    mode_wait_ = 0;
    mode = commanded_mode;
    acknowledged_ = homing_ = homing_error_ = false;
    if (!keeps_attained) attained_ = false;
    if (mode == 1) accepted_target = static_cast<std::int32_t>(position);
  }

  void move(double dt, bool edge4) {
    const bool halted = (controlword & 0x100) != 0;
    velocity = coast;
    if (state == S::quick) velocity = quickStop(dt);
    if (state == S::enabled) {
      if (mode == 8) velocity = (target_position - position) / dt;
      if (mode == 9 || mode == 3) velocity = target_velocity;
      if (mode == 1) profilePosition(dt, edge4);
      if (mode == 6) home(dt, edge4);
      if ((halted && mode != 8 && mode != 9) || (at_limit && mode == 1)) velocity = 0;
      velocity += coast;
    }
    quick_velocity_ = velocity;
    position += velocity * dt;
  }

  double quickStop(double dt) const {
    if (coast != 0.0) return coast;
    const double drop = quick_stop_deceleration * dt;
    if (quick_velocity_ > drop) return quick_velocity_ - drop;
    if (quick_velocity_ < -drop) return quick_velocity_ + drop;
    return 0.0;
  }

  void profilePosition(double dt, bool edge4) {
    if (edge4 && acknowledges) {
      wait_ = acknowledge_delay;
      accepted_target = target_position;
      accepted.push_back(target_position);
      taking_ = true;
    }
    if (taking_ && wait_-- <= 0) {
      acknowledged_ = true;
      taking_ = false;
    }
    if ((controlword & 0x10) == 0 && !taking_) acknowledged_ = false;
    const double distance = accepted_target - position;
    const double most = 20000.0 * dt;
    velocity = (distance > most ? most : distance < -most ? -most : distance) / dt;
  }

  void home(double dt, bool edge4) {
    static_cast<void>(dt);
    if (edge4) {
      ++homings;
      homing_ = true;
      attained_ = homing_error_ = false;
      wait_ = homing_cycles;
    }
    if ((controlword & 0x10) == 0) homing_ = false;
    if (!homing_) return;
    velocity = homing_moves ? homing_speed : 0;
    if (never_homes || wait_-- > 0) return;
    homing_ = false;
    velocity = 0;
    if (homing_fails) {
      homing_error_ = true;
    } else {
      attained_ = true;
      position = static_cast<std::int32_t>(dictionary[{0x607C, 0}].first);
    }
  }

  std::uint16_t last_ = 0;
  int reaction_ = 0, mode_wait_ = 0, wait_ = 0;
  std::size_t cycles_ = 0;
  double quick_velocity_ = 0.0;
  std::int8_t seen_mode_ = 0;
  bool mode_written_ = false;
  bool heard_ = false, acknowledged_ = false, taking_ = false, attained_ = false, homing_ = false,
       homing_error_ = false;
};

}  // namespace cia402::drive::test
