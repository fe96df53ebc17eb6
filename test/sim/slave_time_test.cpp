// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing_support::milliseconds;

class SlaveTimeTest : public testing_support::SlaveTest {
 protected:
  SlaveTimeTest() { add(0x1012, 0, DataType::uint32, Access::rw, 0x100); }
};

TEST_F(SlaveTimeTest, KeepsTheTimeThatItHears) {
  preset(0x1012, 0, 0x80000100);
  boot();
  run(milliseconds(7));
  // 0x03938700 ms = 60,000,000 ms after midnight; 0x3CB5 days; the upper four bits are reserved.
  send(0x100, {0x00, 0x87, 0x93, 0xF3, 0xB5, 0x3C});
  ASSERT_TRUE(device.lastTime());
  EXPECT_EQ(device.lastTime()->milliseconds, 0x03938700U);
  EXPECT_EQ(device.lastTime()->days, 0x3CB5U);
  EXPECT_EQ(device.lastTime()->at, now);
  send(0x000, {0x82, 0x01});
  run(milliseconds(50));
  EXPECT_FALSE(device.lastTime());
}

TEST_F(SlaveTimeTest, ListensOnlyWhereBit31IsSet) {
  boot();
  send(0x100, {0x00, 0x87, 0x93, 0x03, 0xB5, 0x3C});
  EXPECT_FALSE(device.lastTime());
  EXPECT_EQ(sdo({0x23, 0x12, 0x10, 0x00, 0x00, 0x01, 0, 0x80}), "581 60 12 10 00 00 00 00 00");
  send(0x100, {0x00, 0x87, 0x93, 0x03, 0xB5});  // five bytes are no time
  EXPECT_FALSE(device.lastTime());
  send(0x100, {0x00, 0x87, 0x93, 0x03, 0xB5, 0x3C});
  EXPECT_TRUE(device.lastTime());
}

TEST_F(SlaveTimeTest, CannotProduceNorMoveItsIdentifierWhileListening) {
  preset(0x1012, 0, 0x80000100);
  boot();
  EXPECT_EQ(sdo({0x23, 0x12, 0x10, 0x00, 0x00, 0x01, 0, 0x40}), "581 80 12 10 00 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x12, 0x10, 0x00, 0x00, 0x02, 0, 0x80}), "581 80 12 10 00 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x12, 0x10, 0x00, 0x00, 0x02, 0, 0x00}), "581 60 12 10 00 00 00 00 00");
}

}  // namespace
}  // namespace cia402::sim
