// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "canopen/lss/task.h"
#include "canopen/lss_slave.h"
#include "canopen/scripted_peer.h"

namespace cia402::canopen::test {

/// Tasks against devices on a wire in virtual time.
class LssFixture : public ::testing::Test {
 protected:
  /// Runs a task to its end. @return whether it was done (not failed).
  bool run(LssTask& task) {
    const Time end = wire.now + std::chrono::minutes(10);
    while (wire.now < end) {
      const LssTask::Status status = task.advance(master, wire.now);
      if (status != LssTask::Status::running) return status == LssTask::Status::done;
      step();
    }
    ADD_FAILURE() << "the task does not end, it is " << task.step();
    return false;
  }
  /// Until the request has ended.
  void finish() {
    while (master.busy()) step();
  }
  void step() {
    wire.now = std::max(wire.now, std::min(master.nextDeadline(), wire.nextDeadline()));
    wire.deliver([this](const can::Frame& frame) { master.receive(frame, wire.now); });
    master.tick(wire.now);
  }
  std::size_t sentCount(const std::string& line) const {
    return static_cast<std::size_t>(
        std::count_if(wire.sent.begin(), wire.sent.end(),
                      [&](const can::Frame& frame) { return text(frame) == line; }));
  }

  LssWire wire;
  LssMaster master{wire};
};

inline constexpr lss::Identity kServo{0x0000ABCD, 0x000D0117, 0x00010002, 12345};
inline constexpr lss::Identity kOther{0x0000ABCD, 0x000D0117, 0x00010002, 12346};
inline std::array<std::uint32_t, 4> parts(const lss::Identity& i) {
  return {i.vendor_id, i.product_code, i.revision, i.serial};
}

}  // namespace cia402::canopen::test
