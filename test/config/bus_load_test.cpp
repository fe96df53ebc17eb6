// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "config/robot.h"

namespace cia402::config {
namespace {

TEST(BusLoad, WhatComesOnEventsComesWithEverySyncUnlessItsInhibitTimeIsLonger) {
  canopen::MasterConfig master;
  master.heartbeat = Duration(0);
  canopen::NodeConfig node;
  node.heartbeat = Duration(0);
  canopen::PdoConfig statusword;
  statusword.direction = canopen::PdoDirection::tpdo;
  statusword.entries = {{{0x6041, 0}, 16, "statusword"}};  // 63 bits, 75 at worst
  node.pdos.push_back(statusword);
  master.nodes.push_back(node);
  canopen::PdoConfig& pdo = master.nodes[0].pdos[0];
  for (const unsigned type : {254U, 255U}) {
    pdo.transmission = static_cast<std::uint8_t>(type);
    for (const unsigned inhibit : {0U, 20U, 40U}) {  // 100 us; SYNC comes every 4 ms
      SCOPED_TRACE(inhibit);
      pdo.inhibit = static_cast<std::uint16_t>(inhibit);
      const BusLoad load = busLoad(master, 1e6);
      EXPECT_DOUBLE_EQ(load.nominal, (47 + 63) * 250 / 1e6);
      EXPECT_DOUBLE_EQ(load.worst, (55 + 75) * 250 / 1e6);
      EXPECT_DOUBLE_EQ(load.feasible_rate, 0.8e6 / (55 + 75));
    }
    pdo.inhibit = 80;  // at most 125 a second
    const BusLoad load = busLoad(master, 1e6);
    EXPECT_DOUBLE_EQ(load.nominal, (47 * 250 + 63 * 125) / 1e6);
    EXPECT_DOUBLE_EQ(load.worst, (55 * 250 + 75 * 125) / 1e6);
    EXPECT_DOUBLE_EQ(load.feasible_rate, (0.8e6 - 75 * 125) / 55);
  }
}

}  // namespace
}  // namespace cia402::config
