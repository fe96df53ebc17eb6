// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "can/bus.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen::test {

/// A device with LSS as CiA 305 describes it, from bytes to bytes. It shares nothing with the
/// master under test.
struct LssSlave {
  std::array<std::uint32_t, 4> identity{};
  std::uint8_t node_id = 0xFF, pending = 0xFF, stored = 0xFF;
  bool configuration = false;
  std::uint8_t configure_error = 0, store_error = 0, timing_error = 0;
  int bit_timing = -1;
  int activations = 0;
  std::size_t selected = 0, position = 0;

  // What real slaves do otherwise.
  bool scanned_with_node_id = false;  ///< fastscan asks for no node-ID (lely-core, src/co/lss.c)
  bool never_found = false;           ///< goes on taking part after its last bit
  bool says_yes = false;              ///< answers every question of fastscan
  bool mute_moves = false;            ///< goes on to its next number without a word
  int deaf_part = -1;      ///< answers no question about this number of its identity, ...
  unsigned deaf_bit = 31;  ///< ... from this bit down

  /// @return the first byte of an answer, or 0; `data` gets the bytes that follow.
  std::uint8_t hear(const can::Frame& f, std::array<std::uint8_t, 7>& data) {
    const std::uint8_t cs = f.data[0];
    const std::uint32_t number =
        f.data[1] | f.data[2] << 8 | f.data[3] << 16 | static_cast<std::uint32_t>(f.data[4]) << 24;
    if (cs == 0x04) {
      if (f.data[1] == 0 && configuration && node_id == 0xFF) node_id = pending;
      configuration = f.data[1] == 1;
      selected = 0;
    } else if (cs >= 0x40 && cs <= 0x43 && !configuration) {
      const std::size_t part = cs - 0x40u;
      selected = part == selected && number == identity[part] ? selected + 1 : 0;
      if (selected == 4) {
        selected = 0;
        configuration = true;
        return 0x44;
      }
    } else if (cs == 0x51 && !configuration && (node_id == 0xFF || scanned_with_node_id)) {
      return fastscan(f, number) ? 0x4F : 0;
    } else if (cs == 0x4C && node_id == 0xFF) {
      return 0x50;
    } else if (configuration) {
      return configure(f, data);
    }
    return 0;
  }

 private:
  bool fastscan(const can::Frame& f, std::uint32_t number) {
    const unsigned bit = f.data[5], sub = f.data[6], next = f.data[7];
    if (says_yes) return true;
    if (bit == 0x80) {
      position = 0;
      return true;
    }
    if (static_cast<int>(sub) == deaf_part && bit <= deaf_bit) return false;
    if (sub != position || (number ^ identity[sub]) >> bit != 0) return false;
    position = next;
    if (bit == 0 && next < sub) configuration = !never_found;
    return !mute_moves || next == sub;
  }

  std::uint8_t configure(const can::Frame& f, std::array<std::uint8_t, 7>& data) {
    const std::uint8_t cs = f.data[0];
    if (cs >= 0x5A && cs <= 0x5D) {
      const std::uint32_t own = identity[cs - 0x5Au];
      for (unsigned i = 0; i < 4; ++i) data[i] = static_cast<std::uint8_t>(own >> (8 * i));
    } else if (cs == 0x5E) {
      data[0] = node_id;
    } else if (cs == 0x11) {
      data[0] = configure_error;
      if (configure_error == 0) pending = f.data[1];
    } else if (cs == 0x13) {
      data[0] = timing_error;
      if (timing_error == 0) bit_timing = f.data[2];
    } else if (cs == 0x17) {
      data[0] = store_error;
      if (store_error == 0) stored = pending;
    } else {
      activations += cs == 0x15;
      return 0;
    }
    return cs;
  }
};

/// Devices and master on one wire in virtual time; frames may get lost at each receiver, come twice
/// or late.
class LssWire : public can::Sink {
 public:
  double loss = 0.0, duplicates = 0.0;
  Duration answer_time = std::chrono::milliseconds(2);
  std::deque<LssSlave> slaves;
  std::vector<can::Frame> sent;
  std::mt19937 random{1};
  Time now{};

  LssSlave& add(std::array<std::uint32_t, 4> identity, std::uint8_t node_id = 0xFF) {
    slaves.emplace_back();
    slaves.back().identity = identity;
    slaves.back().node_id = slaves.back().pending = node_id;
    return slaves.back();
  }

  bool send(const can::Frame& frame) override {
    sent.push_back(frame);
    for (int times = chance(duplicates) ? 2 : 1; times > 0; --times) {
      for (LssSlave& slave : slaves) {
        if (frame.id != 0x7E5 || chance(loss)) continue;
        std::array<std::uint8_t, 7> d{};
        const std::uint8_t cs = slave.hear(frame, d);
        if (cs == 0) continue;
        const can::Frame answer(0x7E4, {cs, d[0], d[1], d[2], d[3], d[4], d[5], d[6]});
        if (!chance(loss)) wire_.push_back({now + answer_time, answer});
        if (chance(duplicates)) wire_.push_back({now + answer_time, answer});
      }
    }
    return true;
  }
  Time nextDeadline() const { return wire_.empty() ? kNever : wire_.front().first; }
  void deliver(const std::function<void(const can::Frame&)>& receive) {
    while (!wire_.empty() && wire_.front().first <= now) {
      const can::Frame frame = wire_.front().second;
      wire_.pop_front();
      receive(frame);
    }
  }

 private:
  bool chance(double probability) {
    return probability > 0.0 && static_cast<double>(random()) < probability * 4294967296.0;
  }
  std::deque<std::pair<Time, can::Frame>> wire_;
};

}  // namespace cia402::canopen::test
