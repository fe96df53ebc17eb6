// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class SlaveTpdoTest : public testing_support::SlaveTest {};

TEST_F(SlaveTpdoTest, Type1IsSentWithEverySync) {
  presetPdos(255, 1);
  dictionary.onRead({0x6064, 0}, [](Entry& entry) {
    entry.number = 0xFFFFFFFE;
    return 0U;
  });
  operate();
  setValue(0x6041, 0x0237);
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 37 02 FE FF FF FF"));
  EXPECT_THAT(application.calls, ElementsAre("sync", "before tpdo"));
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 37 02 FE FF FF FF"));
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveTpdoTest, TypeNIsSentWithEveryNthSync) {
  presetPdos(255, 3);
  operate();
  std::vector<std::size_t> counts;
  for (int i = 0; i < 7; ++i) {
    send(0x080, {});
    counts.push_back(sent().size());
  }
  EXPECT_THAT(counts, ElementsAre(0, 0, 1, 0, 0, 1, 0));
}

TEST_F(SlaveTpdoTest, Type0IsSentWithTheSyncAfterAChange) {
  presetPdos(255, 0);
  operate();
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 00 00 00 00 00 00"));
  send(0x080, {});
  EXPECT_THAT(sent(), IsEmpty());
  setValue(0x6041, 1);
  device.notifyChange(now);
  EXPECT_THAT(sent(), IsEmpty());
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 01 00 00 00 00 00"));
}

TEST_F(SlaveTpdoTest, TheCountBeginsAtTheSyncStartValue) {
  presetPdos(255, 2);
  preset(0x1019, 0, 10);
  preset(0x1800, 6, 3);
  operate();
  std::vector<std::size_t> counts;
  for (std::uint8_t counter = 1; counter <= 6; ++counter) {
    send(0x080, {counter});
    counts.push_back(sent().size());
  }
  EXPECT_THAT(counts, ElementsAre(0, 0, 0, 1, 0, 1));
}

TEST_F(SlaveTpdoTest, OnlyOperationalSends) {
  presetPdos(255, 1);
  boot();
  send(0x080, {});
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveTpdoTest, EventDrivenIsSentOnStartAndOnChange) {
  presetPdos(255, 254);
  boot();
  send(0x000, {0x01, 0x01});
  EXPECT_THAT(sent(), ElementsAre("181 00 00 00 00 00 00"));
  device.notifyChange(now);
  EXPECT_THAT(sent(), IsEmpty());
  setValue(0x6041, 0x0250);
  device.notifyChange(now);
  EXPECT_THAT(sent(), ElementsAre("181 50 02 00 00 00 00"));
  send(0x080, {});
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveTpdoTest, SomeDevicesDoNotSendOnStart) {
  presetPdos(255, 254);
  behaviour.sends_event_tpdos_on_start = false;
  boot();
  send(0x000, {0x01, 0x01});
  EXPECT_THAT(sent(), IsEmpty());
  device.notifyChange(now);
  EXPECT_THAT(sent(), ElementsAre("181 00 00 00 00 00 00"));
}

TEST_F(SlaveTpdoTest, TheInhibitTimeHoldsChangesBackAndSendsTheLatest) {
  presetPdos(255, 254);
  preset(0x1800, 3, 50);
  operate();
  setValue(0x6041, 1);
  device.notifyChange(now);
  run(milliseconds(2));
  setValue(0x6041, 2);
  device.notifyChange(now);
  run(microseconds(2999));
  EXPECT_THAT(sent(), IsEmpty());
  run(microseconds(1));
  EXPECT_THAT(sent(), ElementsAre("181 02 00 00 00 00 00"));
  run(milliseconds(100));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SlaveTpdoTest, TheEventTimerRunsFromTheLastTransmission) {
  presetPdos(255, 254);
  preset(0x1800, 5, 10);
  operate();
  run(milliseconds(6));
  setValue(0x6041, 1);
  device.notifyChange(now);
  EXPECT_THAT(sent(), ElementsAre("181 01 00 00 00 00 00"));
  run(milliseconds(9));
  EXPECT_THAT(sent(), IsEmpty());
  run(milliseconds(1));
  EXPECT_THAT(sent(), ElementsAre("181 01 00 00 00 00 00"));
  run(milliseconds(10));
  EXPECT_THAT(sent(), ElementsAre("181 01 00 00 00 00 00"));
}

TEST_F(SlaveTpdoTest, Type255MayKnowOnlyTheEventTimer) {
  presetPdos(255, 255);
  preset(0x1800, 5, 10);
  behaviour.type255_event_timer_only = true;
  operate();
  setValue(0x6041, 1);
  device.notifyChange(now);
  EXPECT_THAT(sent(), IsEmpty());
  run(milliseconds(10));
  EXPECT_THAT(sent(), ElementsAre("181 01 00 00 00 00 00"));
}

TEST_F(SlaveTpdoTest, ANewEventTimerTakesEffectAtOnce) {
  presetPdos(255, 254);
  behaviour.sends_event_tpdos_on_start = false;
  operate();
  sdo({0x2B, 0x00, 0x18, 5, 10, 0, 0, 0});
  run(milliseconds(10));
  EXPECT_THAT(sent(), ElementsAre("181 00 00 00 00 00 00"));
}

TEST_F(SlaveTpdoTest, AnswersRemoteRequestsWhereBit30IsClear) {
  presetPdos(255, 1);
  operate();
  setValue(0x6041, 5);
  requestRemote(0x181);
  EXPECT_THAT(sent(), ElementsAre("181 05 00 00 00 00 00"));
  sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x80});
  sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x40});
  requestRemote(0x181);
  EXPECT_THAT(sent(), IsEmpty());
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 05 00 00 00 00 00"));
}

TEST_F(SlaveTpdoTest, Type253SamplesOnRequestAndType252AtTheSync) {
  presetPdos(255, 253);
  operate();
  setValue(0x6041, 1);
  send(0x080, {});
  EXPECT_THAT(sent(), IsEmpty());
  setValue(0x6041, 2);
  requestRemote(0x181);
  EXPECT_THAT(sent(), ElementsAre("181 02 00 00 00 00 00"));
  sdo({0x2F, 0x00, 0x18, 2, 252, 0, 0, 0});
  requestRemote(0x181);
  EXPECT_THAT(sent(), IsEmpty());
  send(0x080, {});
  EXPECT_THAT(sent(), IsEmpty());
  setValue(0x6041, 3);
  requestRemote(0x181);
  EXPECT_THAT(sent(), ElementsAre("181 02 00 00 00 00 00"));
}

TEST_F(SlaveTpdoTest, SynchronousDataAreSampledAfterRpdosTookEffect) {
  presetPdos(1, 1);
  dictionary.onWrite({0x607A, 0}, [this](const Entry& entry) { setValue(0x6064, entry.number); });
  operate();
  send(0x201, {0x0F, 0x00, 9, 0, 0, 0});
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 00 00 09 00 00 00"));
  EXPECT_THAT(application.calls, ElementsAre("rpdo", "sync", "before tpdo"));
}

TEST_F(SlaveTpdoTest, AllFourPairsWork) {
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    preset(static_cast<std::uint16_t>(0x1800 + pdo), 1, 0x181U + 0x100U * pdo);
    preset(static_cast<std::uint16_t>(0x1800 + pdo), 2, 1);
    preset(static_cast<std::uint16_t>(0x1A00 + pdo), 0, 1);
    preset(static_cast<std::uint16_t>(0x1A00 + pdo), 1, 0x60610008);
  }
  operate();
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 00", "281 00", "381 00", "481 00"));
}

}  // namespace
}  // namespace cia402::sim
