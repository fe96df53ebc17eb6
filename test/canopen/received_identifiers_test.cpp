// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/received_identifiers.h"

#include <gtest/gtest.h>

namespace cia402::canopen {
namespace {

PdoConfig pdo(PdoDirection direction, std::uint16_t cob_id) {
  PdoConfig config;
  config.direction = direction;
  config.cob_id = cob_id;
  return config;
}

MasterConfig withNodes(std::initializer_list<NodeId> ids) {
  MasterConfig master;
  for (const NodeId id : ids) {
    NodeConfig node;
    node.node_id = id;
    master.nodes.push_back(node);
  }
  return master;
}

TEST(ReceivedIdentifiers, AreTheServicesOfAllNodes) {
  const auto heard = receivedIdentifiers(withNodes({}));
  // NMT, SYNC, EMCY of 1 and 127, TIME, SDO answer and request, heartbeat of 1 and 127, LSS.
  for (const unsigned id : {0x000U, 0x080U, 0x081U, 0x0FFU, 0x100U, 0x581U, 0x601U, 0x67FU, 0x701U,
                            0x77FU, 0x7E4U, 0x7E5U}) {
    EXPECT_TRUE(heard[id]) << std::hex << id;
  }
  for (const unsigned id : {0x001U, 0x07FU, 0x101U, 0x181U, 0x201U, 0x57FU, 0x680U, 0x6FFU, 0x780U,
                            0x7E3U, 0x7E6U, 0x7FFU}) {
    EXPECT_FALSE(heard[id]) << std::hex << id;
  }
}

TEST(ReceivedIdentifiers, AreThePdosOfConfiguredNodesBothWays) {
  const auto heard = receivedIdentifiers(withNodes({3}));
  for (const unsigned id : {0x183U, 0x203U, 0x283U, 0x303U, 0x383U, 0x403U, 0x483U, 0x503U}) {
    EXPECT_TRUE(heard[id]) << std::hex << id;
  }
  EXPECT_FALSE(heard[0x182] || heard[0x184] || heard[0x204]) << "of others";
}

TEST(ReceivedIdentifiers, AreThoseThatTheConfigurationNames) {
  MasterConfig master = withNodes({3});
  master.nodes[0].pdos = {pdo(PdoDirection::tpdo, 0x1C5), pdo(PdoDirection::rpdo, 0x6A0)};
  master.nodes[0].sdo_channel = {0x6E1, 0x6E2};
  const auto heard = receivedIdentifiers(master);
  for (const unsigned id : {0x1C5U, 0x6A0U, 0x6E1U, 0x6E2U}) EXPECT_TRUE(heard[id]) << id;
}

TEST(ReceivedIdentifiers, AreAllWhereADriveKeepsCobIdsThatNobodyKnowsYet) {
  MasterConfig master = withNodes({3});
  master.nodes[0].pdos = {pdo(PdoDirection::tpdo, 0)};
  EXPECT_TRUE(receivedIdentifiers(master).all());
  master.nodes[0].pdos[0].enabled = false;
  EXPECT_FALSE(receivedIdentifiers(master).all()) << "one that is only made invalid says nothing";
}

}  // namespace
}  // namespace cia402::canopen
