// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/robot.h"

namespace cia402::config {
namespace {

using canopen::PdoDirection;

TEST(PdoTable, SaysWhenEachPdoIsSent) {
  struct Row {
    PdoDirection direction;
    unsigned type, request_every, refresh_every, cob_id;
    const char* text;
  };
  const Row rows[] = {
      {PdoDirection::tpdo, 0, 1, 1, 0x185, "tpdo1   0x185   sync, on change      16"},
      {PdoDirection::tpdo, 1, 1, 1, 0x185, "tpdo1   0x185   sync                 16"},
      {PdoDirection::tpdo, 2, 1, 1, 0x185, "tpdo1   0x185   sync / 2             16"},
      {PdoDirection::tpdo, 240, 1, 1, 0x185, "tpdo1   0x185   sync / 240           16"},
      {PdoDirection::tpdo, 252, 5, 1, 0x185, "tpdo1   0x185   asked, sync / 5      16"},
      {PdoDirection::tpdo, 253, 1, 1, 0x185, "tpdo1   0x185   asked, sync / 1      16"},
      {PdoDirection::tpdo, 254, 1, 1, 0x185, "tpdo1   0x185   event                16"},
      {PdoDirection::tpdo, 255, 1, 1, 0, "tpdo1   drive   event                16"},
      {PdoDirection::rpdo, 1, 1, 1, 0x205, "rpdo1   0x205   sync                 16"},
      {PdoDirection::rpdo, 1, 1, 10, 0x205, "rpdo1   0x205   change, sync / 10    16"},
  };
  for (const Row& row : rows) {
    canopen::MasterConfig master;
    canopen::NodeConfig node;
    node.node_id = 5;
    node.name = "servo";
    canopen::PdoConfig pdo;
    pdo.direction = row.direction;
    pdo.number = 1;
    pdo.cob_id = static_cast<std::uint16_t>(row.cob_id);
    pdo.transmission = static_cast<std::uint8_t>(row.type);
    pdo.request_every = static_cast<std::uint16_t>(row.request_every);
    pdo.refresh_every = static_cast<std::uint16_t>(row.refresh_every);
    pdo.entries = {{{0x6041, 0}, 16, "word"}};
    node.pdos.push_back(pdo);
    master.nodes.push_back(node);
    EXPECT_THAT(pdoTable(master, 1e6), testing::HasSubstr(row.text));
    master.nodes[0].pdos[0].enabled = false;
    EXPECT_THAT(pdoTable(master, 1e6), testing::Not(testing::HasSubstr("word"))) << row.text;
  }
}

}  // namespace
}  // namespace cia402::config
