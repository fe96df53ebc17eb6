// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "canopen/scripted_peer.h"
#include "canopen/sdo/client.h"

namespace cia402::canopen::test {

/// The SDO client of node 1 against a scripted server, in virtual time.
class SdoClientFixture : public ::testing::Test {
 protected:
  static SdoOptions options() {
    SdoOptions result;
    result.timeout = std::chrono::milliseconds(500);
    result.retries = 1;
    return result;
  }
  /// Starts what is queued and hands over the answers until the wire is quiet.
  void run() {
    client.tick(now);
    peer.deliver([this](const can::Frame& answer) { client.receive(answer, now); });
  }
  void receive(const std::string& text) { client.receive(frame(text), now); }
  void wait(int ms) {
    now += std::chrono::milliseconds(ms);
    client.tick(now);
  }

  ScriptedPeer peer;
  SdoClient client{1, peer, options()};
  Time now{};
};

}  // namespace cia402::canopen::test
