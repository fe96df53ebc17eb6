// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/cyclic_identifiers.h"

#include <gmock/gmock.h>

namespace cia402::canopen {
namespace {

TEST(CyclicIdentifiers, AreSyncTimeHeartbeatAndRpdosButNoTransfersAndCommands) {
  MasterConfig master;
  master.node_id = 127;
  NodeConfig node;
  node.node_id = 3;
  PdoConfig fixed;  // an RPDO that the drive has elsewhere
  fixed.direction = PdoDirection::rpdo;
  fixed.cob_id = 0x6A3;
  PdoConfig tpdo;
  tpdo.direction = PdoDirection::tpdo;
  tpdo.cob_id = 0x183;
  PdoConfig unknown;  // read at boot
  unknown.direction = PdoDirection::rpdo;
  unknown.cob_id = 0;
  node.pdos = {fixed, tpdo, unknown};
  master.nodes = {node};
  EXPECT_THAT(cyclicIdentifiers(master), testing::UnorderedElementsAre(0x080, 0x100, 0x77F, 0x203,
                                                                       0x303, 0x403, 0x503, 0x6A3));
}

}  // namespace
}  // namespace cia402::canopen
