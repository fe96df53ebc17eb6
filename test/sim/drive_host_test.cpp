// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/world/drive_host.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

#include "folders.h"

namespace cia402::sim {
namespace {

using namespace std::chrono_literals;

/// A wire whose frames a test stamps, and that keeps what the drives send.
class Wire : public can::Interface {
 public:
  bool send(const can::Frame& frame) override {
    sent.push_back(frame);
    return true;
  }
  std::optional<can::ReceivedFrame> receive(Time) override {
    if (waiting.empty()) return std::nullopt;
    const can::ReceivedFrame next = waiting.front();
    waiting.pop_front();
    return next;
  }
  void maintain(Time) override {}
  int fd() const override { return -1; }
  can::BusState state() const override { return can::BusState::error_active; }
  const can::BusCounters& counters() const override { return counters_; }
  std::string describe() const override { return "can0"; }

  std::deque<can::ReceivedFrame> waiting;
  std::vector<can::Frame> sent;

 private:
  can::BusCounters counters_;
};

/// Node 5 expects the heartbeat of node 127 every 100 ms.
class DriveHostTest : public testing::Test {
 protected:
  DriveHostTest() {
    const auto definition =
        loadDriveDefinition(cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml");
    EXPECT_TRUE(definition.ok());
    axes_.push_back({"x", 5, definition.value(), {{}}, {}, {{"x", 0}}});
    host.emplace(axes_, wire, Time{1s});
    host->step(Time{2s});
    // 1016h:01 = 0x007F0064
    onWire(2s, can::Frame(0x605, {0x23, 0x16, 0x10, 0x01, 0x64, 0x00, 0x7F, 0x00}));
    host->step(Time{2s});
    host->step(Time{2100ms});
    EXPECT_TRUE(sent(can::Frame(0x585, {0x60, 0x16, 0x10, 0x01, 0x00, 0x00, 0x00, 0x00})));
    wire.sent.clear();
  }

  void onWire(Duration stamp, const can::Frame& frame) {
    wire.waiting.push_back({frame, Time{stamp}});
  }
  void heartbeats(Duration from, Duration to) {
    for (Duration at = from; at <= to; at += 50ms) onWire(at, can::Frame(0x77F, {0x05}));
  }
  bool sent(const can::Frame& frame) const {
    return std::find(wire.sent.begin(), wire.sent.end(), frame) != wire.sent.end();
  }
  /// EMCY with error code 0x8130.
  bool lost() const {
    return std::any_of(wire.sent.begin(), wire.sent.end(), [](const can::Frame& frame) {
      return frame.id == 0x085 && frame.data[0] == 0x30 && frame.data[1] == 0x81;
    });
  }

  Wire wire;
  std::optional<DriveHost> host;

 private:
  std::vector<SimulatedDrive> axes_;
};

TEST_F(DriveHostTest, SteppedLateTheDrivesMissNoHeartbeatThatWasInTime) {
  heartbeats(2150ms, 2150ms);
  host->step(Time{2160ms});
  heartbeats(2200ms, 3s);
  host->step(Time{3010ms});
  EXPECT_FALSE(lost());
}

TEST_F(DriveHostTest, AHoleOnTheWireIsSeenHoweverLateItIsLookedAt) {
  heartbeats(2150ms, 2500ms);
  heartbeats(2650ms, 3s);
  host->step(Time{3010ms});
  EXPECT_TRUE(lost());
}

TEST_F(DriveHostTest, StampsThatGoBackOrLieAheadMoveNoDrivesTimeBackOrAhead) {
  heartbeats(2150ms, 2200ms);
  onWire(1s, can::Frame(0x77F, {0x05}));
  onWire(9s, can::Frame(0x77F, {0x05}));
  host->step(Time{2210ms});
  EXPECT_FALSE(lost());
  host->step(Time{2320ms});
  EXPECT_TRUE(lost());
}

}  // namespace
}  // namespace cia402::sim
