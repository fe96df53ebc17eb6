// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/object_names.h"

#include <gtest/gtest.h>

namespace cia402::decode {
namespace {

TEST(ObjectNames, CommunicationObjectsHaveTheNamesOfTheStandard) {
  EXPECT_EQ(communicationObjectName({0x1000, 0}), "device type");
  EXPECT_EQ(communicationObjectName({0x1018, 4}), "serial number");
  EXPECT_EQ(communicationObjectName({0x1018, 0}), "identity");
  EXPECT_EQ(communicationObjectName({0x1003, 0}), "error history, count");
  EXPECT_EQ(communicationObjectName({0x1003, 5}), "error history");
}

TEST(ObjectNames, PdoParametersNameTheirPdo) {
  EXPECT_EQ(communicationObjectName({0x1400, 1}), "RPDO1 COB-ID");
  EXPECT_EQ(communicationObjectName({0x1603, 0}), "RPDO4 mapping, count");
  EXPECT_EQ(communicationObjectName({0x1801, 5}), "TPDO2 event timer");
  EXPECT_EQ(communicationObjectName({0x1BFF, 3}), "TPDO512 mapping, entry 3");
}

TEST(ObjectNames, OthersHaveNone) {
  EXPECT_EQ(communicationObjectName({0x6041, 0}), "");
  EXPECT_EQ(communicationObjectName({0x1C00, 0}), "");
  EXPECT_EQ(communicationObjectName({0x1000, 1}), "");
}

}  // namespace
}  // namespace cia402::decode
