// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "can/frame.h"
#include "cia402_driver/common/time.h"
#include "fieldbus/object.h"

namespace cia402::bus::test {

using Bytes = std::vector<std::uint8_t>;

/// A CiA 402 drive with frames in and out, just able enough to be moved by a robot: NMT, heartbeat,
/// expedited SDO, a state machine that obeys at once, motion without inertia. 100000 counts are a
/// radian. It shares no code with the master.
///
/// RPDO1: controlword, mode, target position; RPDO2: target velocity, target torque; TPDO1 at SYNC:
/// statusword, mode display, actual position.
class FakeDrive {
 public:
  explicit FakeDrive(std::uint8_t node_id) : node(node_id) {
    objects[{0x6065, 0}] = {0, 0, 0, 0};
    objects[{0x6098, 0}] = {0};
  }

  const std::uint8_t node;
  std::deque<can::Frame> out;  ///< what it wants to send

  // What a test may change or look at
  bool silent = false;                              ///< hears nothing, says nothing
  bool sdo_silent = false;                          ///< answers no SDO request
  std::uint32_t requests = 0x600, answers = 0x580;  ///< COB-IDs of SDO without the node-ID
  bool deaf_to_controlword = false;
  bool keeps_mode = false;       ///< takes no other
  bool blocked = false;          ///< does not move
  bool homing_fails = false;     ///< ends homing with an error
  bool homing_is_slow = false;   ///< never ends homing
  unsigned statusword_bits = 0;  ///< shown besides those of its state
  std::size_t tpdo_bytes = 7;    ///< as long is its TPDO; 0: it sends none
  std::int32_t disturbance = 0;  ///< counts that the actual position is off
  std::map<fieldbus::ObjectId, Bytes> objects;
  std::map<fieldbus::ObjectId, std::uint32_t> aborts;  ///< codes with which access is refused
  std::vector<fieldbus::ObjectId> written;

  std::uint16_t statusword = kSwitchOnDisabled, controlword = 0;
  std::int8_t mode = 0;
  std::int32_t position = 0, target_position = 0, target_velocity = 0;
  std::int16_t target_torque = 0;
  bool operational = false;
  std::vector<std::int32_t> targets;     ///< target positions of all RPDOs while enabled
  std::vector<std::int32_t> velocities;  ///< target velocities of all RPDOs while enabled
  std::optional<Time> homing_began;

  bool enabled() const { return (statusword & 0x6F) == 0x27; }
  double radians() const { return position / 100000.0; }

  /// Sends an EMCY and falls into fault.
  void fault(std::uint16_t code) {
    statusword = kFault;
    send(0x080, {static_cast<std::uint8_t>(code & 0xFF), static_cast<std::uint8_t>(code >> 8), 0x01,
                 0, 0, 0, 0, 0});
  }

  void receive(const can::Frame& frame, Time now) {
    if (silent) return;
    if (frame.id == 0x000) return onNmt(frame);
    if (frame.id == 0x080) return onSync(now);
    if (frame.id == requests + node && !sdo_silent) return onSdo(frame);
    if (!operational) return;
    if (frame.id == 0x200u + node) onRpdo1(frame, now);
    if (frame.id == 0x300u + node) onRpdo2(frame);
  }

  void tick(Time now) {
    if (silent || now < next_heartbeat_) return;
    next_heartbeat_ = now + std::chrono::milliseconds(heartbeat_ms_);
    send(0x700, {static_cast<std::uint8_t>(operational ? 0x05 : 0x7F)});
  }
  Time nextDeadline() const { return silent ? kNever : next_heartbeat_; }

 private:
  static constexpr std::uint16_t kSwitchOnDisabled = 0x0250, kReady = 0x0231, kSwitchedOn = 0x0233,
                                 kEnabled = 0x0237, kQuickStop = 0x0217, kFault = 0x0218;

  void send(std::uint32_t function, std::initializer_list<std::uint8_t> bytes) {
    out.emplace_back(function + node, bytes);
  }

  void onNmt(const can::Frame& frame) {
    if (frame.data[1] != 0 && frame.data[1] != node) return;
    operational = frame.data[0] == 0x01;
    if (frame.data[0] == 0x81 || frame.data[0] == 0x82) {
      heartbeat_ms_ = 0;
      next_heartbeat_ = kNever;
      send(0x700, {0x00});
    }
    if (!operational) statusword = kSwitchOnDisabled;
  }

  static std::uint32_t number(const can::Frame& frame, std::size_t from, std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= static_cast<std::uint32_t>(frame.data[from + i]) << (8 * i);
    }
    return value;
  }

  void onSdo(const can::Frame& frame) {
    const fieldbus::ObjectId id{static_cast<std::uint16_t>(number(frame, 1, 2)), frame.data[3]};
    const std::uint8_t low = frame.data[1], high = frame.data[2], sub = frame.data[3];
    const auto refuse = [&](std::uint32_t code) {
      send(answers,
           {0x80, low, high, sub, static_cast<std::uint8_t>(code & 0xFF),
            static_cast<std::uint8_t>(code >> 8 & 0xFF),
            static_cast<std::uint8_t>(code >> 16 & 0xFF), static_cast<std::uint8_t>(code >> 24)});
    };
    const bool communication = id.index < 0x2000;
    if (aborts.count(id) != 0) return refuse(aborts[id]);
    if (!communication && objects.count(id) == 0) return refuse(0x06020000);
    if (frame.data[0] == 0x40) {
      Bytes data = objects.count(id) != 0 ? objects[id] : Bytes{0, 0, 0, 0};
      const auto command = static_cast<std::uint8_t>(0x43 | (4 - data.size()) << 2);
      data.resize(4);
      send(answers, {command, low, high, sub, data[0], data[1], data[2], data[3]});
    } else if ((frame.data[0] & 0xE0) == 0x20) {
      const std::size_t size = 4 - (frame.data[0] >> 2 & 3);
      objects[id] =
          Bytes(frame.data.begin() + 4, frame.data.begin() + 4 + static_cast<std::ptrdiff_t>(size));
      written.push_back(id);
      if (id.index == 0x1017) {
        heartbeat_ms_ = static_cast<int>(number(frame, 4, 2));
        next_heartbeat_ = heartbeat_ms_ > 0 ? Time{} : kNever;
      }
      if (id.index == 0x6040) {
        const std::uint16_t before = controlword;
        controlword = static_cast<std::uint16_t>(number(frame, 4, 2));
        if (!deaf_to_controlword) obey(before);
      }
      send(answers, {0x60, low, high, sub, 0, 0, 0, 0});
    }
  }

  void onRpdo1(const can::Frame& frame, Time now) {
    const std::uint16_t before = controlword;
    controlword = static_cast<std::uint16_t>(number(frame, 0, 2));
    if (!keeps_mode) mode = static_cast<std::int8_t>(frame.data[2]);
    target_position = static_cast<std::int32_t>(number(frame, 3, 4));
    if (enabled()) targets.push_back(target_position);
    if (!deaf_to_controlword) obey(before);
    const bool homing_edge = mode == 6 && (controlword & 0x10) != 0 && (before & 0x10) == 0;
    if (homing_edge && enabled()) {
      homing_began = now;
      homing_ends_ = now + std::chrono::milliseconds(100);
    }
    if (mode != 6 || !enabled()) homing_ends_ = kNever;
    const bool set_point = mode == 1 && (controlword & 0x10) != 0;
    if (set_point && (before & 0x10) == 0) profile_target_ = target_position;
    acknowledge_ = set_point;
    if (!enabled() || mode != 1) profile_target_ = position;
  }

  void onRpdo2(const can::Frame& frame) {
    target_velocity = static_cast<std::int32_t>(number(frame, 0, 4));
    target_torque = static_cast<std::int16_t>(number(frame, 4, 2));
    if (enabled()) velocities.push_back(target_velocity);
  }

  void obey(std::uint16_t before) {
    const unsigned bits = controlword & 0x0F;
    if (statusword == kFault) {
      if ((controlword & 0x80) != 0 && (before & 0x80) == 0) statusword = kSwitchOnDisabled;
    } else if ((bits & 0x02) == 0) {
      statusword = kSwitchOnDisabled;
    } else if ((bits & 0x04) == 0) {
      statusword = enabled() ? kQuickStop : kSwitchOnDisabled;
    } else if (statusword == kSwitchOnDisabled) {
      if (bits == 0x06) statusword = kReady;
    } else if (statusword != kQuickStop) {
      statusword = bits == 0x06 ? kReady : bits == 0x07 ? kSwitchedOn : kEnabled;
    }
  }

  void onSync(Time now) {
    const double dt = synced_ == Time{} ? 0.0 : toSeconds(now - synced_);
    synced_ = now;
    if (!operational) return;
    if (enabled() && !blocked) move(dt);
    unsigned word = statusword | statusword_bits;
    if (enabled() && mode == 6) word |= homingBits(now);
    if (enabled() && mode == 1) {
      word |= (acknowledge_ ? 0x1000u : 0u) | (position == profile_target_ ? 0x0400u : 0u);
    }
    if (tpdo_bytes == 0) return;
    const auto p = static_cast<std::uint32_t>(position + disturbance);
    send(0x180, {static_cast<std::uint8_t>(word & 0xFF), static_cast<std::uint8_t>(word >> 8),
                 static_cast<std::uint8_t>(mode), static_cast<std::uint8_t>(p & 0xFF),
                 static_cast<std::uint8_t>(p >> 8 & 0xFF),
                 static_cast<std::uint8_t>(p >> 16 & 0xFF), static_cast<std::uint8_t>(p >> 24)});
    out.back().size = static_cast<std::uint8_t>(tpdo_bytes);
  }

  unsigned homingBits(Time now) const {
    if (homing_ends_ == kNever) return 0x0400;
    if (homing_is_slow || now < homing_ends_) return 0;
    return homing_fails ? 0x2400 : 0x1400;
  }

  void move(double dt) {
    if (mode == 8) position = target_position;
    if (mode == 9) position += static_cast<std::int32_t>(target_velocity * dt);
    if (mode != 1) return;
    const auto step = static_cast<std::int32_t>(100000 * dt);  // 1 rad/s
    const std::int32_t left = profile_target_ - position;
    position = left > step ? position + step : left < -step ? position - step : profile_target_;
  }

  int heartbeat_ms_ = 0;
  Time next_heartbeat_ = kNever, synced_{}, homing_ends_ = kNever;
  std::int32_t profile_target_ = 0;
  bool acknowledge_ = false;
};

}  // namespace cia402::bus::test
