// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class SlaveRpdoTest : public testing_support::SlaveTest {};

TEST_F(SlaveRpdoTest, EventDrivenDataTakeEffectAtOnce) {
  presetPdos(254, 1);
  operate();
  send(0x201, {0x0F, 0x00, 0xFE, 0xFF, 0xFF, 0xFF});
  EXPECT_EQ(value(0x6040), 0x0FU);
  EXPECT_EQ(asSigned(*dictionary.find({0x607A, 0})), -2);
  EXPECT_THAT(application.calls, ElementsAre("rpdo"));
}

TEST_F(SlaveRpdoTest, SynchronousDataWaitForTheSync) {
  presetPdos(1, 255);
  behaviour.sends_event_tpdos_on_start = false;
  operate();
  send(0x201, {0x06, 0x00, 0x01, 0, 0, 0});
  send(0x201, {0x07, 0x00, 0x02, 0, 0, 0});
  EXPECT_EQ(value(0x6040), 0U);
  EXPECT_THAT(application.calls, IsEmpty());
  send(0x080, {});
  EXPECT_EQ(value(0x6040), 7U);
  EXPECT_EQ(value(0x607A), 2U);
  EXPECT_THAT(application.calls, ElementsAre("rpdo", "sync"));
  send(0x080, {});
  EXPECT_THAT(application.calls, ElementsAre("rpdo", "sync", "sync"));
}

TEST_F(SlaveRpdoTest, IsIgnoredOutsideOperational) {
  presetPdos(254, 1);
  boot();
  send(0x201, {0x0F, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(value(0x6040), 0U);
}

TEST_F(SlaveRpdoTest, DataThatWaitAreForgottenOutsideOperational) {
  presetPdos(1, 255);
  operate();
  send(0x201, {0x0F, 0x00, 0, 0, 0, 0});
  send(0x000, {0x80, 0x01});
  send(0x000, {0x01, 0x01});
  send(0x080, {});
  EXPECT_EQ(value(0x6040), 0U);
}

TEST_F(SlaveRpdoTest, TooShortDataAreIgnoredAndReportedOnce) {
  presetPdos(254, 1);
  operate();
  send(0x201, {0x0F, 0x00, 1, 2, 3});
  send(0x201, {0x0F, 0x00, 1, 2, 3});
  EXPECT_EQ(value(0x6040), 0U);
  EXPECT_THAT(sent(), ElementsAre("081 10 82 11 00 00 00 00 00"));
  send(0x201, {0x0F, 0x00, 1, 2, 3, 4});
  EXPECT_THAT(sent(), ElementsAre("081 00 00 00 00 00 00 00 00"));
}

TEST_F(SlaveRpdoTest, TooLongDataAreTakenAndReported) {
  presetPdos(254, 1);
  operate();
  send(0x201, {0x0F, 0x00, 1, 2, 3, 4, 5});
  EXPECT_EQ(value(0x6040), 0x0FU);
  EXPECT_EQ(value(0x607A), 0x04030201U);
  EXPECT_THAT(sent(), ElementsAre("081 20 82 11 00 00 00 00 00"));
}

TEST_F(SlaveRpdoTest, WhatItsTimeOutDoesIsSaidBy1029h02) {
  add(0x1029, 2, DataType::uint8, Access::rw);
  presetPdos(254, 1);
  preset(0x1400, 5, 20);
  const auto after = [this](std::uint8_t reaction) {
    preset(0x1029, 2, reaction);
    operate();
    send(0x201, {0x0F, 0x00, 1, 2, 3, 4});
    run(milliseconds(20));
    EXPECT_THAT(sent(), Contains("081 50 82 11 00 00 00 00 00"));
    return device.nmtState();
  };
  EXPECT_EQ(after(1), canopen::NmtState::operational);
  EXPECT_EQ(after(0), canopen::NmtState::pre_operational);
  EXPECT_EQ(after(2), canopen::NmtState::stopped);
}

TEST_F(SlaveRpdoTest, ItsEventTimerRunsFromTheFirstFrameOn) {
  presetPdos(254, 1);
  preset(0x1400, 5, 20);
  operate();
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
  send(0x201, {0x0F, 0x00, 1, 2, 3, 4});
  run(milliseconds(19));
  send(0x201, {0x0F, 0x00, 1, 2, 3, 4});
  run(milliseconds(19));
  EXPECT_THAT(sent(), IsEmpty());
  run(milliseconds(1));
  EXPECT_THAT(sent(), ElementsAre("081 50 82 11 00 00 00 00 00"));
  send(0x201, {0x0F, 0x00, 1, 2, 3, 4});
  EXPECT_THAT(sent(), ElementsAre("081 00 00 00 00 00 00 00 00"));
}

TEST_F(SlaveRpdoTest, AnEmptyMappingTakesNothing) {
  presetPdos(254, 1);
  preset(0x1600, 0, 0);
  operate();
  send(0x201, {0x0F, 0x00, 1, 2, 3, 4});
  EXPECT_THAT(application.calls, IsEmpty());
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveRpdoTest, DummyEntriesLeaveGaps) {
  presetPdos(254, 1);
  preset(0x1600, 0, 3);
  preset(0x1600, 1, 0x00050008);
  preset(0x1600, 2, 0x60400010);
  preset(0x1600, 3, 0x60600008);
  operate();
  send(0x201, {0xEE, 0x34, 0x12, 0x08});
  EXPECT_EQ(value(0x6040), 0x1234U);
  EXPECT_EQ(value(0x6060), 8U);
}

TEST_F(SlaveRpdoTest, ARefusedValueLeavesTheOthersAlone) {
  presetPdos(254, 1);
  dictionary.onWriteCheck({0x6040, 0}, [](const Entry&, std::uint64_t) { return 0x06090030U; });
  operate();
  send(0x201, {0x0F, 0x00, 1, 0, 0, 0});
  EXPECT_EQ(value(0x6040), 0U);
  EXPECT_EQ(value(0x607A), 1U);
}

TEST_F(SlaveRpdoTest, EightBytesOfOneBitValuesAndNumbersMixPacked) {
  Entry& bit = add(0x2010, 1, DataType::boolean, Access::rw);
  bit.rpdo = true;
  presetPdos(254, 1);
  preset(0x1600, 1, 0x20100101);
  preset(0x1600, 2, 0x60600008);
  operate();
  send(0x201, {0x11, 0x00});
  EXPECT_EQ(value(0x2010, 1), 1U);
  EXPECT_EQ(value(0x6060), 8U);
}

}  // namespace
}  // namespace cia402::sim
