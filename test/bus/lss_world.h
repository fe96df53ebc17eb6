// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/robot_world.h"
#include "canopen/lss_slave.h"

namespace cia402::bus::test {

inline constexpr canopen::lss::Identity kIdentities[] = {{0xABC, 7, 0x10002, 11},
                                                         {0xABC, 7, 0x10002, 22}};
inline constexpr const char* kShoulder =
    "vendor 0x00000ABC, product 0x00000007, revision 0x00010002, "
    "serial 11 (0x0000000B)";

inline config::RobotConfig byIdentity(std::size_t axes) {
  config::RobotConfig robot = testRobot();
  for (std::size_t i = 0; i < axes; ++i) {
    robot.devices[i].lss = canopen::DeviceLss();
    robot.devices[i].lss->identity = kIdentities[i];
  }
  return robot;
}

/// Shoulder and elbow with LSS; the first `unconfigured` of them come without a node-ID and are to
/// get it by their identity.
struct LssWorld : RobotWorld {
  explicit LssWorld(std::size_t unconfigured, const config::RobotConfig& config)
      : RobotWorld(config) {
    for (std::size_t i = 0; i < 2; ++i) {
      const canopen::lss::Identity& own = kIdentities[i];
      slaves[i].identity = {own.vendor_id, own.product_code, own.revision, own.serial};
      for (std::uint8_t part = 0; part < 4; ++part) {
        const std::uint32_t number = own.part(part);
        drives[i].objects[{0x1018, static_cast<std::uint8_t>(part + 1)}] = {
            static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8),
            static_cast<std::uint8_t>(number >> 16), static_cast<std::uint8_t>(number >> 24)};
      }
      if (i < unconfigured) {
        drives[i].silent = true;
      } else {
        slaves[i].node_id = slaves[i].pending = drives[i].node;
      }
    }
    bystanders = [this](const can::Frame& frame) { return hear(frame); };
  }
  explicit LssWorld(std::size_t unconfigured) : LssWorld(unconfigured, byIdentity(unconfigured)) {}

  /// Without power, and back without a node-ID.
  void takeAway(std::size_t axis) {
    drives[axis].silent = true;
    gone[axis] = true;
  }
  void bringBack(std::size_t axis) {
    slaves[axis].node_id = slaves[axis].pending = 0xFF;
    gone[axis] = false;
  }
  NetworkSnapshot shown() const {
    NetworkSnapshot snapshot;
    network.fill(snapshot);
    return snapshot;
  }
  fieldbus::Health health(std::size_t axis) const { return network.axis(axis).state().health; }
  /// LSS requests that begin with these bytes.
  std::size_t asked(std::uint8_t command, int second = -1, int third = -1) const {
    std::size_t count = 0;
    for (const Sent& request : sentWithId(0x7E5)) {
      const auto& d = request.frame.data;
      count += d[0] == command && (second < 0 || d[1] == second) && (third < 0 || d[2] == third);
    }
    return count;
  }

  canopen::test::LssSlave slaves[2];
  bool gone[2] = {false, false};

 private:
  std::optional<can::Frame> hear(const can::Frame& frame) {
    std::optional<can::Frame> answer;
    for (std::size_t i = 0; i < 2; ++i) {
      if (gone[i]) continue;
      if (frame.id == 0x7E5) {
        std::array<std::uint8_t, 7> d{};
        const std::uint8_t cs = slaves[i].hear(frame, d);
        if (cs != 0) answer = can::Frame(0x7E4, {cs, d[0], d[1], d[2], d[3], d[4], d[5], d[6]});
      }
      drives[i].silent = slaves[i].node_id != drives[i].node;
    }
    return answer;
  }
};

inline bool ready(LssWorld& world) {
  return world.runUntil([&] {
    return world.health(0) == fieldbus::Health::ready && world.health(1) == fieldbus::Health::ready;
  });
}

}  // namespace cia402::bus::test
