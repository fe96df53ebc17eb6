// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "cia402_driver/can/bus.h"
#include "cia402_driver/common/time.h"

namespace cia402::drive::test {

/// A small CiA 402 drive at node 3, written from the standard's tables and independent of the code
/// under test. It sees only frames. RPDO1 203h: controlword, mode, target position; RPDO2 303h:
/// target velocity, target torque; TPDO1 183h: statusword, position, mode; TPDO2 283h: velocity,
/// torque, error code. Device units: 0.0001 rad, 0.0001 rad/s, 0.001 of the rated torque.
class FakeDrive : public can::Sink {
 public:
  enum class S { start, disabled, ready, on, enabled, quick, reaction, fault };

  // What the test may turn.
  S state = S::disabled;
  std::set<S> stuck;          ///< states that no command leaves
  std::vector<S> shows;       ///< one a cycle, whatever it does
  bool mute = false;          ///< answers no SDO, obeys no controlword
  double position = 12345.0;  ///< counts
  double velocity = 0.0;      ///< counts/s
  double coast = 0.0;         ///< counts/s that nothing stops
  int mode_delay = 0;         ///< cycles until 6061h follows 6060h, shows -1 meanwhile
  bool forgets_mode = false;  ///< takes a mode when it is commanded in operation enabled only
  bool mode_by_sdo = false;   ///< 6060h is in no RPDO: something else has its place
  int acknowledge_delay = 0;  ///< cycles
  bool acknowledges = true;
  bool warning = false, voltage = true, remote = true;
  bool at_limit = false;        ///< stands in profile position, and says so by statusword bit 11
  bool keeps_attained = false;  ///< statusword bit 12 survives leaving the homing mode
  bool never_homes = false, homing_fails = false, homing_moves = true;
  int homing_cycles = 50;
  std::int32_t homing_speed = -1000;     ///< counts/s
  bool fault_persists = false;           ///< comes back right after a reset
  bool quick_stop_ends = true;           ///< transition 12 by itself
  double quick_stop_deceleration = 1e6;  ///< counts/s^2
  bool silent = false;                   ///< sends no PDO
  std::map<std::pair<unsigned, unsigned>, std::uint32_t> aborts;       ///< SDO writes refused
  std::map<std::pair<unsigned, unsigned>, std::uint32_t> read_aborts;  ///< SDO reads refused
  std::set<std::pair<unsigned, unsigned>> unanswered;  ///< SDO writes taken in silence
  std::map<std::pair<unsigned, unsigned>, std::pair<std::uint64_t, unsigned>> dictionary;

  // What the test may look at.
  std::uint16_t controlword = 0;
  std::int8_t mode = 0, commanded_mode = 0;
  std::int32_t target_position = 0, target_velocity = 0, accepted_target = 0;
  std::int16_t target_torque = 0;
  std::vector<std::uint16_t> controlwords;                 ///< each change
  std::vector<std::pair<unsigned, std::uint64_t>> writes;  ///< SDO writes: index, value
  std::map<std::pair<unsigned, unsigned>, int> reads;      ///< SDO reads of each object
  std::vector<std::int32_t> accepted;  ///< set-points taken by the edge of bit 4
  int homings = 0, resets = 0;
  bool operational = false;
  std::uint16_t error = 0;

  /// 603Fh, whatever happens; not set: the error.
  std::optional<std::uint16_t> error_object;

  FakeDrive() {
    dictionary[{0x1000, 0}] = {0x00020192, 4};
    for (unsigned sub = 1; sub <= 4; ++sub) dictionary[{0x1018, sub}] = {sub, 4};
    dictionary[{0x607C, 0}] = {0, 4};
    dictionary[{0x605A, 0}] = {2, 2};
    dictionary[{0x603F, 0}] = {0, 2};
    dictionary[{0x6061, 0}] = {0, 1};
    dictionary[{0x606C, 0}] = {0, 4};
  }

  bool send(const can::Frame& frame) override {
    inbox_.push_back(frame);
    return true;
  }
  /// Handles what the master has sent. @return the frames that it sends back.
  std::vector<can::Frame> answer() {
    while (!inbox_.empty()) {
      const can::Frame frame = inbox_.front();
      inbox_.pop_front();
      if (frame.id == 0x000) onNmt(frame);
      if (frame.id == 0x603) onSdo(frame);
      if (frame.id == 0x203 && operational) pending_[0] = frame;
      if (frame.id == 0x303 && operational) pending_[1] = frame;
    }
    return std::exchange(outbox_, {});
  }
  /// SYNC: applies the last RPDOs, moves, and gives the TPDOs.
  std::vector<can::Frame> sync(double dt) {
    if (!operational) return {};
    if (pending_[0].size == 7) applyFirst(pending_[0]);
    if (pending_[1].size == 6) applySecond(pending_[1]);
    step(dt);
    ++cycles_;
    if (silent) return {};
    const std::uint16_t word = statusword();
    const auto where = static_cast<std::uint32_t>(static_cast<std::int32_t>(position));
    const auto speed = static_cast<std::uint32_t>(static_cast<std::int32_t>(velocity));
    const std::uint16_t code = error_object.value_or(error);
    dictionary[{0x603F, 0}].first = code;
    dictionary[{0x6061, 0}].first = static_cast<std::uint8_t>(mode);
    dictionary[{0x606C, 0}].first = speed;
    return {can::Frame(0x183, {byte(word, 0), byte(word, 1), byte(where, 0), byte(where, 1),
                               byte(where, 2), byte(where, 3), static_cast<std::uint8_t>(mode)}),
            can::Frame(0x283, {byte(speed, 0), byte(speed, 1), byte(speed, 2), byte(speed, 3), 0, 0,
                               byte(code, 0), byte(code, 1)})};
  }
  can::Frame heartbeat() const {
    return can::Frame(0x703, {static_cast<std::uint8_t>(operational ? 0x05 : 0x7F)});
  }
  /// Fault reaction, EMCY; the fault itself follows.
  can::Frame fail(std::uint16_t code) {
    state = S::reaction;
    reaction_ = 3;
    error = code;
    return emergency(code);
  }
  static can::Frame emergency(std::uint16_t code) {
    return can::Frame(0x083, {byte(code, 0), byte(code, 1), 0x21, 0, 0, 0, 0, 0});
  }
  /// Power cycle: everything is forgotten. @return the boot-up message.
  can::Frame reboot() {
    state = S::disabled;
    operational = false;
    mode = commanded_mode = 0;
    controlword = last_ = 0;
    velocity = coast = 0;
    error = 0;
    pending_[0] = pending_[1] = can::Frame();
    return can::Frame(0x703, {0x00});
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
  template <typename T>
  static std::uint8_t byte(T value, unsigned n) {
    return static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * n));
  }
  static std::uint32_t dword(const can::Frame& frame, unsigned at) {
    return static_cast<std::uint32_t>(frame.data[at] | frame.data[at + 1] << 8 |
                                      frame.data[at + 2] << 16) |
           static_cast<std::uint32_t>(frame.data[at + 3]) << 24;
  }

  void onNmt(const can::Frame& frame) {
    if (frame.data[1] != 0 && frame.data[1] != 3) return;
    if (frame.data[0] == 0x01) operational = true;
    if (frame.data[0] == 0x80 || frame.data[0] == 0x02) operational = false;
    if (frame.data[0] == 0x81 || frame.data[0] == 0x82) outbox_.push_back(reboot());
    if (frame.data[0] == 0x01) outbox_.push_back(heartbeat());
  }

  void onSdo(const can::Frame& frame) {
    if (mute) return;
    const unsigned index = static_cast<unsigned>(frame.data[1] | frame.data[2] << 8);
    const unsigned sub = frame.data[3];
    const auto key = std::make_pair(index, sub);
    const auto reply = [&](std::uint8_t command, std::uint32_t data) {
      outbox_.push_back(
          can::Frame(0x583, {command, frame.data[1], frame.data[2], frame.data[3], byte(data, 0),
                             byte(data, 1), byte(data, 2), byte(data, 3)}));
    };
    if (frame.data[0] == 0x40) {
      ++reads[key];
      if (read_aborts.count(key) != 0) return reply(0x80, read_aborts[key]);
      if (dictionary.count(key) == 0 && index >= 0x1010 && index < 0x1C00) {
        const bool wide = (index >= 0x1600 && index < 0x1800) || index >= 0x1A00;
        dictionary[key] = {0, sub == 0 ? 1u : wide || sub == 1 ? 4u : sub == 2 ? 1u : 2u};
      }
      if (dictionary.count(key) == 0) return reply(0x80, 0x06020000);
      const auto& [value, size] = dictionary[key];
      return reply(static_cast<std::uint8_t>(0x43 | (4 - size) << 2),
                   static_cast<std::uint32_t>(value));
    }
    if ((frame.data[0] & 0xE3) == 0x23) {
      if (aborts.count(key) != 0) return reply(0x80, aborts[key]);
      const unsigned size = 4 - ((frame.data[0] >> 2) & 3u);
      const std::uint64_t mask = (std::uint64_t{1} << (8 * size)) - 1;
      dictionary[key] = {dword(frame, 4) & mask, size};
      writes.emplace_back(index, dword(frame, 4) & mask);
      if (index == 0x6060) {
        commanded_mode = static_cast<std::int8_t>(frame.data[4]);
        mode_written_ = true;
      }
      if (unanswered.count(key) != 0) return;
      return reply(0x60, 0);
    }
  }

  void applyFirst(const can::Frame& frame) {
    const std::uint16_t before =
        std::exchange(controlword, static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8));
    if (!mode_by_sdo) commanded_mode = static_cast<std::int8_t>(frame.data[2]);
    target_position = static_cast<std::int32_t>(dword(frame, 3));
    if (!heard_ || before != controlword) controlwords.push_back(controlword);
    heard_ = true;
  }
  void applySecond(const can::Frame& frame) {
    target_velocity = static_cast<std::int32_t>(dword(frame, 0));
    target_torque = static_cast<std::int16_t>(frame.data[4] | frame.data[5] << 8);
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

  /// What an RPDO repeats is no command; an SDO is one each time.
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
    const double drop = quick_stop_deceleration * dt;
    if (quick_velocity_ > drop) return quick_velocity_ - drop;
    if (quick_velocity_ < -drop) return quick_velocity_ + drop;
    return coast;
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

  std::deque<can::Frame> inbox_;
  std::vector<can::Frame> outbox_;
  can::Frame pending_[2];
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
