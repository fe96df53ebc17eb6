// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class SlaveSyncTest : public testing_support::SlaveTest {};

TEST_F(SlaveSyncTest, ReachesTheApplicationUnlessStopped) {
  boot();
  send(0x080, {});
  EXPECT_THAT(application.calls, ElementsAre("sync"));
  send(0x000, {0x02, 0x01});
  forget();
  send(0x080, {});
  EXPECT_THAT(application.calls, IsEmpty());
}

TEST_F(SlaveSyncTest, FollowsItsCobId) {
  boot();
  EXPECT_EQ(sdo({0x23, 0x05, 0x10, 0x00, 0x90, 0, 0, 0}), "581 60 05 10 00 00 00 00 00");
  forget();
  send(0x080, {});
  EXPECT_THAT(application.calls, IsEmpty());
  send(0x090, {});
  EXPECT_THAT(application.calls, ElementsAre("sync"));
}

TEST_F(SlaveSyncTest, CannotProduceSyncWithoutAProducerNorUseExtendedIdentifiers) {
  behaviour.sync_producer = false;
  boot();
  EXPECT_EQ(sdo({0x23, 0x05, 0x10, 0x00, 0x80, 0, 0, 0x40}), "581 80 05 10 00 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x05, 0x10, 0x00, 0x80, 0, 0, 0x20}), "581 80 05 10 00 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x05, 0x10, 0x00, 0x01, 0x06, 0, 0}), "581 80 05 10 00 30 00 09 06");
}

TEST_F(SlaveSyncTest, TakesACounterOverflowOf0Or2To240WhileThePeriodIsZero) {
  boot();
  for (const std::uint8_t good : std::vector<std::uint8_t>{0, 2, 240}) {
    EXPECT_EQ(sdo({0x2F, 0x19, 0x10, 0x00, good, 0, 0, 0}), "581 60 19 10 00 00 00 00 00");
  }
  for (const std::uint8_t bad : std::vector<std::uint8_t>{1, 241, 255}) {
    EXPECT_EQ(sdo({0x2F, 0x19, 0x10, 0x00, bad, 0, 0, 0}), "581 80 19 10 00 30 00 09 06");
  }
  sdo({0x23, 0x06, 0x10, 0x00, 0xA0, 0x0F, 0, 0});
  EXPECT_EQ(sdo({0x2F, 0x19, 0x10, 0x00, 0, 0, 0, 0}), "581 80 19 10 00 22 00 00 08");
  EXPECT_EQ(value(0x1019), 240U);
}

TEST_F(SlaveSyncTest, ReportsAnUnexpectedLengthOnceAndIgnoresTheSync) {
  boot();
  send(0x080, {0x01});
  send(0x080, {0x02});
  EXPECT_THAT(application.calls, IsEmpty());
  EXPECT_THAT(sent(), ElementsAre("081 40 82 11 00 00 00 00 00"));
  send(0x080, {});
  EXPECT_THAT(application.calls, ElementsAre("sync"));
  EXPECT_THAT(sent(), ElementsAre("081 00 00 00 00 00 00 00 00"));
  send(0x080, {0x01});
  EXPECT_THAT(sent(), ElementsAre("081 40 82 11 00 00 00 00 00"));
}

TEST_F(SlaveSyncTest, WantsACounterWhereOneIsConfigured) {
  behaviour.accepts_plain_sync = false;
  preset(0x1019, 0, 240);
  boot();
  send(0x080, {});
  EXPECT_THAT(application.calls, IsEmpty());
  EXPECT_THAT(sent(), ElementsAre("081 40 82 11 00 00 00 00 00"));
  send(0x080, {0x05});
  EXPECT_THAT(application.calls, ElementsAre("sync"));
}

TEST_F(SlaveSyncTest, MayTakeAPlainSyncAllTheSame) {
  preset(0x1019, 0, 240);
  boot();
  send(0x080, {});
  EXPECT_THAT(application.calls, ElementsAre("sync"));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveSyncTest, MissesTheSyncAfterOneAndAHalfPeriods) {
  behaviour.sync_timeout = true;
  preset(0x1006, 0, 4000);
  boot();
  run(milliseconds(100));
  send(0x080, {});
  run(microseconds(5999));
  EXPECT_THAT(sent(), IsEmpty());
  run(microseconds(1));
  EXPECT_THAT(sent(), ElementsAre("081 01 82 11 00 00 00 00 00"));
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("081 00 00 00 00 00 00 00 00"));
}

TEST_F(SlaveSyncTest, DoesNotWatchThePeriodUnlessToldTo) {
  preset(0x1006, 0, 4000);
  boot();
  send(0x080, {});
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveSyncTest, ProducesSyncWhereBit30IsSetAndHearsItItself) {
  presetPdos(1, 1);
  preset(0x1006, 0, 2000);
  operate();
  EXPECT_EQ(sdo({0x23, 0x05, 0x10, 0x00, 0x80, 0, 0, 0x40}), "581 60 05 10 00 00 00 00 00");
  forget();
  run(milliseconds(3));
  EXPECT_THAT(sent(), ElementsAre("080", "181 00 00 00 00 00 00"));
  EXPECT_THAT(application.calls, testing::Contains("sync"));
  run(milliseconds(1));
  EXPECT_THAT(sent(), ElementsAre("080", "181 00 00 00 00 00 00"));
  // Its identifier stays while it runs.
  EXPECT_EQ(sdo({0x23, 0x05, 0x10, 0x00, 0x81, 0, 0, 0x40}), "581 80 05 10 00 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x05, 0x10, 0x00, 0x80, 0, 0, 0x00}), "581 60 05 10 00 00 00 00 00");
  forget();
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveSyncTest, CountsItsOwnSyncAndIsSilentWhileStopped) {
  preset(0x1005, 0, 0x40000080);
  preset(0x1006, 0, 1000);
  preset(0x1019, 0, 2);
  boot();
  run(milliseconds(3));
  EXPECT_THAT(sent(), ElementsAre("080 01", "080 02", "080 01"));
  send(0x000, {0x02, 0x01});
  run(milliseconds(10));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveSyncTest, SynchronousRpdosAfterTheWindowAreLost) {
  presetPdos(1, 255);
  add(0x1007, 0, DataType::uint32, Access::rw, 500);
  operate();
  send(0x201, {0x06, 0x00, 1, 0, 0, 0});  // no SYNC yet: no window
  send(0x080, {});
  EXPECT_EQ(value(0x607A), 1U);
  run(testing_support::microseconds(500));
  send(0x201, {0x06, 0x00, 2, 0, 0, 0});
  run(testing_support::microseconds(1));
  send(0x201, {0x06, 0x00, 3, 0, 0, 0});  // too late
  run(milliseconds(1));
  send(0x080, {});
  EXPECT_EQ(value(0x607A), 2U);
}

}  // namespace
}  // namespace cia402::sim
