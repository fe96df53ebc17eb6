// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/cyclic_identifiers.h"

#include <gmock/gmock.h>

#include <utility>
#include <vector>

namespace cia402::canopen {
namespace {

MasterConfig masterWith(std::vector<PdoConfig> pdos) {
  MasterConfig master;
  NodeConfig node;
  node.node_id = 3;
  node.pdos = std::move(pdos);
  master.nodes = {node};
  return master;
}

PdoConfig rpdo(std::uint16_t cob_id) {
  PdoConfig pdo;
  pdo.direction = PdoDirection::rpdo;
  pdo.cob_id = cob_id;
  return pdo;
}

TEST(CyclicIdentifiers, AreSyncTimeHeartbeatAndRpdosWhereverADriveMayHaveThem) {
  const auto identifiers = cyclicIdentifiers(masterWith({rpdo(0x6A3), rpdo(0)}));
  for (const std::uint32_t id : {0x080U, 0x100U, 0x77FU, 0x203U, 0x503U, 0x6A3U, 0x1F5U}) {
    EXPECT_THAT(identifiers, testing::Contains(id)) << std::hex << id;
  }
}

TEST(CyclicIdentifiers, AreNotThoseOfCommandsAndTransfers) {
  MasterConfig master = masterWith({});
  master.nodes[0].sdo_channel = {0x690, 0x5F0};
  const auto identifiers = cyclicIdentifiers(master);
  for (const std::uint32_t id : {0x000U, 0x601U, 0x603U, 0x67FU, 0x690U, 0x7E5U}) {
    EXPECT_THAT(identifiers, testing::Not(testing::Contains(id))) << std::hex << id;
  }
}

TEST(CyclicIdentifiers, IncludeAnRpdoInThePlaceOfAnSdoRequest) {
  EXPECT_THAT(cyclicIdentifiers(masterWith({rpdo(0x610)})), testing::Contains(0x610U));
}

TEST(CyclicIdentifiers, DoNotDependOnAnSdoChannelBeyond11Bits) {
  MasterConfig master = masterWith({});
  const auto without = cyclicIdentifiers(master);
  for (const std::uint16_t request : {std::uint16_t{0x800}, std::uint16_t{0xFFFF}}) {
    master.nodes[0].sdo_channel = {request, 0x5F0};
    EXPECT_EQ(cyclicIdentifiers(master), without) << std::hex << request;
  }
}

TEST(CyclicIdentifiers, LeaveATpdoOutThatLiesWhereRequestsDo) {
  PdoConfig tpdo = rpdo(0x610);
  tpdo.direction = PdoDirection::tpdo;
  EXPECT_THAT(cyclicIdentifiers(masterWith({tpdo})), testing::Not(testing::Contains(0x610U)));
}

TEST(CyclicIdentifiers, HaveElevenBits) {
  const auto identifiers = cyclicIdentifiers(masterWith({rpdo(0x800)}));
  EXPECT_EQ(identifiers.back(), 0x7FFU);
  EXPECT_EQ(identifiers, cyclicIdentifiers(masterWith({})));
}

}  // namespace
}  // namespace cia402::canopen
