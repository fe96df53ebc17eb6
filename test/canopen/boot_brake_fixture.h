// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "canopen/node_fixture.h"

namespace cia402::canopen {

using test::Lines;

constexpr Duration kUnanswered = std::chrono::milliseconds(300);
// After 0.3 s without an answer it is reset, and told 0.05 s later that it goes on as before.
constexpr Duration kAwaitsBootUp = std::chrono::milliseconds(360);
constexpr char kReset[] = "000 82 03";
constexpr char kTellPreOperational[] = "000 80 03";
constexpr char kAskShownMode[] = "603 40 61 60 00 00 00 00 00";
constexpr char kAskStatusword[] = "603 40 41 60 00 00 00 00 00";
constexpr char kAskVelocity[] = "603 40 6C 60 00 00 00 00 00";
constexpr char kTarget[] = "603 23 FF 60 00 10 27 00 00";  // 10000, as it turns
constexpr char kOperationEnabled[] = "583 4B 41 60 00 37 12 00 00";
constexpr char kQuickStopActive[] = "583 4B 41 60 00 17 12 00 00";
constexpr char kSwitchOnDisabled[] = "583 4B 41 60 00 50 02 00 00";
constexpr char kFaultReactionActive[] = "583 4B 41 60 00 1F 12 00 00";
constexpr char kMode[] = "603 2F 60 60 00 09 00 00 00";
constexpr char kQuickStop[] = "603 2B 40 60 00 02 00 00 00";

/// Modes 4 and 10 push; mode 9 brakes.
class BootBrakeTest : public test::NodeFixture {
 protected:
  BootBrakeTest() {
    config.brakes = {brakeByMode9({4, 10})};
    for (const char* line : {kAskShownMode, kAskStatusword, kAskVelocity}) peer.forget(line);
    peer.on(kAskShownMode, Lines{"583 4F 61 60 00 0A 00 00 00"});
    peer.on(kAskStatusword, Lines{kOperationEnabled});
    StartupWrite stop;
    stop.object = {0x6040, 0};
    stop.data = {0x02, 0x00};
    stop.only_if_different = false;
    stop.always = true;
    config.writes = {stop};
    peer.on(kQuickStop, "583 60 40 60 00 00 00 00 00");
    peer.on(kAskVelocity, "583 43 6C 60 00 10 27 00 00");
    peer.on(kTarget, "583 60 FF 60 00 00 00 00 00");
    peer.on(kMode, "583 60 60 60 00 00 00 00 00");
  }
  void shows(const char* mode_answer) {
    peer.forget(kAskShownMode);
    peer.on(kAskShownMode, mode_answer);
  }
  void tpdo(const char* text) {
    node->receiveTpdo(0, test::frame(text), now);
    settle();
  }
  void rests() { peer.on(kAskStatusword, Lines{kSwitchOnDisabled}); }
  /// What is sent until the reset.
  Lines sentBeforeReset(Duration within = Duration::zero()) {
    boot();
    pass(2 * master.sync_period + within);
    Lines lines;
    for (const std::string& line : peer.take()) {
      if (line == kReset) return lines;
      lines.push_back(line);
    }
    ADD_FAILURE() << "it was not reset";
    return lines;
  }
};

}  // namespace cia402::canopen
