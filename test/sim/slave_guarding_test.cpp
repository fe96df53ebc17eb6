// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive_fixture.h"
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::milliseconds;

/// Node 1 with 100Ch and 100Dh beside 1017h.
class SlaveGuardingTest : public testing_support::SlaveTest {
 protected:
  SlaveGuardingTest() {
    add(0x100C, 0, DataType::uint16, Access::rw);
    add(0x100D, 0, DataType::uint8, Access::rw);
  }
  void guard() { requestRemote(0x701); }
};

TEST_F(SlaveGuardingTest, AnswersWithItsStateAndATogglingBitThatBeginsAtZero) {
  boot();
  guard();
  guard();
  send(0x000, {0x01, 0x01});
  guard();
  send(0x000, {0x02, 0x01});
  guard();
  guard();
  EXPECT_THAT(sent(), ElementsAre("701 7F", "701 FF", "701 05", "701 84", "701 04"));
}

TEST_F(SlaveGuardingTest, OnlyAResetMakesTheToggleBitBeginAnew) {
  boot();
  guard();
  send(0x000, {0x01, 0x01});
  guard();
  forget();
  send(0x000, {0x82, 0x01});
  guard();  // while it initialises
  run(milliseconds(20));
  guard();
  EXPECT_THAT(sent(), ElementsAre("701 00", "701 7F"));
  send(0x000, {0x81, 0x01});
  run(milliseconds(20));
  guard();
  guard();
  EXPECT_THAT(sent(), ElementsAre("701 00", "701 7F", "701 FF"));
}

TEST_F(SlaveGuardingTest, AnswersOnlyRequestsForItself) {
  boot();
  requestRemote(0x702);
  send(0x701, {0x05});
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveGuardingTest, TheHeartbeatTakesItsPlaceWhileItIsProduced) {
  preset(0x1017, 0, 1000);
  boot();
  guard();
  EXPECT_THAT(sent(), IsEmpty());
  sdo({0x2B, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  guard();
  EXPECT_THAT(sent(), ElementsAre("701 7F"));
}

TEST_F(SlaveGuardingTest, LosesTheMasterAfterGuardTimeTimesFactorWithoutARequest) {
  preset(0x100C, 0, 100);
  preset(0x100D, 0, 3);
  operate();
  run(milliseconds(1000));  // supervision begins with the first request
  EXPECT_THAT(application.calls, IsEmpty());
  guard();
  run(milliseconds(200));
  guard();
  run(milliseconds(299));
  EXPECT_THAT(application.calls, IsEmpty());
  forget();
  run(milliseconds(1));
  EXPECT_THAT(sent(), ElementsAre("081 30 81 11 00 00 00 00 00"));
  EXPECT_THAT(application.calls, ElementsAre("state 7F", "lost"));
  EXPECT_EQ(value(0x1001), 0x11U);
  run(milliseconds(1000));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveGuardingTest, ReportsTheReturnOfTheMasterAndWatchesAgain) {
  preset(0x100C, 0, 100);
  preset(0x100D, 0, 2);
  operate();
  guard();
  run(milliseconds(200));
  forget();
  guard();
  EXPECT_THAT(application.calls, ElementsAre("back"));
  EXPECT_THAT(sent(), ElementsAre("701 FF", "081 00 00 00 00 00 00 00 00"));
  run(milliseconds(200));
  EXPECT_THAT(sent(), ElementsAre("081 30 81 11 00 00 00 00 00"));
}

TEST_F(SlaveGuardingTest, ReactsAsTheErrorBehaviourAsks) {
  preset(0x100C, 0, 100);
  preset(0x100D, 0, 1);
  preset(0x1029, 1, 1);
  operate();
  guard();
  run(milliseconds(100));
  EXPECT_EQ(device.nmtState(), canopen::NmtState::operational);
  preset(0x1029, 1, 2);
  guard();
  run(milliseconds(100));
  EXPECT_EQ(device.nmtState(), canopen::NmtState::stopped);
}

TEST_F(SlaveGuardingTest, AFactorOrTimeOfZeroIsNotSupervised) {
  preset(0x100C, 0, 100);
  operate();
  guard();
  run(milliseconds(5000));
  EXPECT_THAT(application.calls, IsEmpty());
  sdo({0x2F, 0x0D, 0x10, 0x00, 2, 0, 0, 0});  // counts from this write
  forget();
  run(milliseconds(199));
  EXPECT_THAT(application.calls, IsEmpty());
  sdo({0x2B, 0x0C, 0x10, 0x00, 0, 0, 0, 0});
  forget();
  run(milliseconds(5000));
  EXPECT_THAT(application.calls, IsEmpty());
}

TEST_F(SlaveGuardingTest, AProducedHeartbeatEndsTheSupervision) {
  preset(0x100C, 0, 100);
  preset(0x100D, 0, 2);
  operate();
  guard();
  sdo({0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0});
  forget();
  run(milliseconds(900));
  EXPECT_THAT(application.calls, IsEmpty());
}

TEST_F(SlaveGuardingTest, AResetForgetsTheMaster) {
  preset(0x100C, 0, 100);
  preset(0x100D, 0, 2);
  operate();
  guard();
  send(0x000, {0x82, 0x01});
  run(milliseconds(20));
  forget();
  run(milliseconds(5000));
  EXPECT_THAT(application.calls, IsEmpty());
  EXPECT_THAT(sent(), IsEmpty());
}

TEST(SlaveGuarding, ADriveWithoutHeartbeatObjectsStopsWhenItIsNoLongerGuarded) {
  DriveBench bench("generic_cia402_guarding");
  const auto guard = [&bench] {
    can::Frame request(0x701, {});
    request.remote = true;
    request.size = 1;
    bench.drive->receive(request, bench.now);
  };
  EXPECT_EQ(bench.abortOf({0x40, 0x17, 0x10, 0x00, 0, 0, 0, 0}), 0x06020000U);
  EXPECT_EQ(bench.abortOf({0x40, 0x16, 0x10, 0x01, 0, 0, 0, 0}), 0x06020000U);
  bench.write(0x100C, 0, 50, 2);
  bench.write(0x100D, 0, 2, 1);
  bench.write(0x6007, 0, 3, 2);  // quick stop
  bench.write(0x1029, 1, 1, 1);  // stays operational
  bench.nmt(0x01);
  guard();
  EXPECT_EQ(bench.sent.back(), can::Frame(0x701, {0x05}));
  bench.enable();
  EXPECT_EQ(bench.state(), 0x27);
  bench.run(ms(100));
  EXPECT_EQ(bench.state(), 0x40);
  EXPECT_THAT(bench.emergencies(), testing::Contains(std::make_pair(0x8130, 0x11)));
}

}  // namespace
}  // namespace cia402::sim
