// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "canopen/node_fixture.h"

namespace cia402::canopen {

using test::Lines;

constexpr char kNmtStop[] = "000 02 03";
constexpr char kMotorStop[] = "603 2B 40 60 00 02 00 00 00";  // controlword 0x0002, quick stop

class LastStopTest : public test::NodeFixture {
 protected:
  LastStopTest() {
    StartupWrite stop;
    stop.object = {0x6040, 0};
    stop.name = "controlword";
    stop.data = {0x02, 0x00};
    stop.only_if_different = false;
    stop.always = true;
    config.writes = {stop};
    config.boot.search_period = Duration::zero();
    peer.on(kMotorStop, "583 60 40 60 00 00 00 00 00");
  }
  /// Until the last heartbeat is 0.3 s old. Nobody hears the node then, and it hears nobody.
  void lose() {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    peer.take();
    peer.forget(kMotorStop);
    pass(std::chrono::milliseconds(300));
    ASSERT_EQ(node->health(), Health::lost);
  }
  /// When each of `line` was sent, ms from now on.
  std::vector<int> times(const char* line, Duration span) {
    std::vector<int> at;
    const Lines sent = peer.take();
    const auto count = [&](const Lines& lines, int ms) {
      for (const std::string& text : lines) {
        if (text == line) at.push_back(ms);
      }
    };
    count(sent, 0);
    for (int ms = 1; std::chrono::milliseconds(ms) <= span; ++ms) {
      pass(std::chrono::milliseconds(1));
      count(peer.take(), ms);
    }
    return at;
  }
};

/// Mode 4 pushes; mode 9 brakes. The mode comes with the position.
class LastStopInTorqueTest : public LastStopTest {
 protected:
  LastStopInTorqueTest() {
    config.brakes = {brakeByMode9({4})};
    PdoConfig& tpdo = config.pdos.at(1);
    tpdo.entries.at(1) = {{0x6061, 0}, 8, "mode display"};
    peer.on("603 40 41 60 00 00 00 00 00", "583 4B 41 60 00 50 02 00 00");  // as the boot begins
    peer.forget("603 40 00 1A 02 00 00 00 00");
    peer.on("603 40 00 1A 02 00 00 00 00", "583 43 00 1A 02 08 00 61 60");
  }
  void loseIn(const char* mode) {
    boot();
    ASSERT_EQ(node->health(), Health::ready) << node->problem();
    node->receiveTpdo(0, test::frame(std::string("183 37 12 ") + mode), now);
    peer.take();
    peer.forget(kMotorStop);
    pass(milliseconds(300));
    ASSERT_EQ(node->health(), Health::lost);
  }
};

}  // namespace cia402::canopen
