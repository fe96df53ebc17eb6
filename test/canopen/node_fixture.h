// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopen/node/node.h"
#include "canopen/process_objects.h"
#include "canopen/scripted_drive.h"
#include "canopen/scripted_peer.h"

namespace cia402::canopen::test {

using Lines = std::vector<std::string>;

/// What the boot of node 3 asks first: 1000h, and 1018h:01.
constexpr char kAskDeviceType[] = "603 40 00 10 00 00 00 00 00";
constexpr char kAskVendor[] = "603 40 18 10 01 00 00 00 00";

/// Node 3, "shoulder", against a scripted servo, in virtual time.
class NodeFixture : public ::testing::Test {
 protected:
  NodeFixture() { addServo(peer, 3); }

  void create() { node.emplace(config, master, peer); }
  /// Hands over answers until the wire is quiet.
  void settle() {
    peer.deliver([this](const can::Frame& received) { node->receive(received, now, now); });
  }
  void boot(bool reset = true) {
    create();
    node->boot(now, reset);
    settle();
  }
  void hear(const std::string& text) {
    node->receive(frame(text), now, now);
    settle();
  }
  /// Lets time pass as a bus thread would: tick whenever a deadline is due.
  void pass(Duration duration) {
    const Time end = now + duration;
    while (node->nextDeadline() <= end) {
      now = std::max(now, node->nextDeadline());
      node->tick(now);
      settle();
    }
    now = end;
  }
  bool sentLine(const std::string& text) const {
    return std::find(peer.sent.begin(), peer.sent.end(), text) != peer.sent.end();
  }

  /// A drive whose motor mode 9 brakes. @param pushing the modes whose stop would let it go
  static BootBrake brakeByMode9(std::vector<int> pushing) {
    return {{0x6041, 0}, {0x6061, 0}, {0x6060, 0}, {0x606C, 0}, {0x60FF, 0}, std::move(pushing), 9};
  }

  ScriptedPeer peer;
  NodeConfig config = servoConfig(3, "shoulder");
  MasterConfig master;
  std::optional<Node> node;
  Time now{std::chrono::hours(1)};  // as a running clock has it
};

}  // namespace cia402::canopen::test
