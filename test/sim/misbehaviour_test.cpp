// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives that do what they should not: switches of DeviceBehaviour and injected faults.
#include "drive_fixture.h"
#include "folders.h"
#include "sim/world/world.h"
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::milliseconds;

class MisbehaviourTest : public testing_support::SlaveTest {
 protected:
  /// In operation, with the statusword in TPDO 1, and in TPDO 2 as it was 29 ms ago.
  void operateWithTwoStatuswords() {
    presetPdos(1, 1);
    preset(0x1801, 1, 0x281);
    preset(0x1801, 2, 1);
    preset(0x1A01, 0, 1);
    preset(0x1A01, 1, 0x60410010);
    behaviour.stale_statusword = milliseconds(29);
    operate();
    send(0x080, {});
  }
};

TEST_F(MisbehaviourTest, StartsItselfOperational) {
  behaviour.starts_operational = true;
  boot();
  EXPECT_EQ(device.nmtState(), canopen::NmtState::operational);
}

TEST_F(MisbehaviourTest, TakesNoNoticeOfNmtStart) {
  behaviour.stays_pre_operational = true;
  preset(0x1017, 0, 50);
  boot();
  send(0x000, {0x01, 0x01});
  run(milliseconds(60));
  EXPECT_EQ(device.nmtState(), canopen::NmtState::pre_operational);
  EXPECT_THAT(sent(), ElementsAre("701 7F"));
  send(0x000, {0x02, 0x01});
  EXPECT_EQ(device.nmtState(), canopen::NmtState::stopped);
}

TEST_F(MisbehaviourTest, SendsBootUpTwice) {
  behaviour.boots_again_after = milliseconds(70);
  preset(0x1017, 0, 50);
  boot();
  run(milliseconds(100));
  EXPECT_THAT(sent(), ElementsAre("701 7F", "701 00", "701 7F"));
  send(0x000, {0x01, 0x01});
  run(milliseconds(500));
  EXPECT_THAT(sent(), testing::Not(testing::Contains("701 00")));
}

TEST_F(MisbehaviourTest, RefusesOtherPdoIdentifiersButNotBit31) {
  behaviour.pdo_identifiers = PdoIdentifiers::fixed;
  boot();
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 0x01, 0x82, 0x01, 0, 0x80}), "581 80 00 18 01 02 00 01 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 0x01, 0x81, 0x01, 0, 0x00}), "581 60 00 18 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 0x01, 0x02, 0x02, 0, 0x80}), "581 80 00 14 01 02 00 01 06");
}

TEST_F(MisbehaviourTest, RefusesEveryWriteToAPdoIdentifier) {
  behaviour.pdo_identifiers = PdoIdentifiers::read_only;
  boot();
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 0x01, 0x81, 0x01, 0, 0x80}), "581 80 00 18 01 02 00 01 06");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x18, 0x02, 1, 0, 0, 0}), "581 60 00 18 02 00 00 00 00");
}

TEST_F(MisbehaviourTest, SendsTpdosOfAWrongLength) {
  presetPdos(1, 1);
  behaviour.tpdo_size_error = -1;
  operate();
  dictionary.find({0x6064, 0})->number = 0x44332211;
  send(0x080, {});
  device.behaviour().tpdo_size_error = 1;
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 00 00 11 22 33", "181 00 00 11 22 33 44 00"));
}

TEST_F(MisbehaviourTest, HasAFixedNumberOfMappedObjectsWithFillers) {
  presetPdos(1, 1);
  behaviour.fixed_map_entries = 4;
  operate();
  EXPECT_EQ(sdo({0x40, 0x00, 0x1A, 0, 0, 0, 0, 0}), "581 4F 00 1A 00 04 00 00 00");
  EXPECT_EQ(sdo({0x40, 0x00, 0x1A, 3, 0, 0, 0, 0}), "581 43 00 1A 03 00 00 00 00");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x1A, 0, 0, 0, 0, 0}), "581 80 00 1A 00 02 00 01 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 2, 0, 0, 0, 0}), "581 80 00 1A 02 22 00 00 08") << "valid";
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x80}), "581 60 00 18 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 2, 0x00, 0, 0, 0}), "581 60 00 1A 02 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x00}), "581 60 00 18 01 00 00 00 00");
  forget();
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 00 00"));
}

TEST_F(MisbehaviourTest, InsistsOnBit30OfItsTpdos) {
  presetPdos(1, 1);
  behaviour.keeps_rtr_bit = true;
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x18, 1, 0, 0, 0, 0}), "581 43 00 18 01 81 01 00 40");
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x80}), "581 80 00 18 01 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0xC0}), "581 60 00 18 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x01, 0x02, 0, 0x80}), "581 60 00 14 01 00 00 00 00");
}

TEST_F(MisbehaviourTest, TakesABadCobIdAndRefusesTheMapping) {
  behaviour.misleading_cob_id_abort = true;
  boot();
  // 0x6E0 is no identifier of a PDO (CiA 301, table 42).
  EXPECT_EQ(sdo({0x23, 0x01, 0x18, 1, 0xE0, 0x06, 0, 0x80}), "581 60 01 18 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x01, 0x1A, 2, 0x20, 0, 0x64, 0x60}), "581 80 01 1A 02 41 00 04 06");
  EXPECT_EQ(sdo({0x23, 0x01, 0x18, 1, 0x81, 0x02, 0, 0x80}), "581 60 01 18 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x01, 0x1A, 2, 0x20, 0, 0x64, 0x60}), "581 60 01 1A 02 00 00 00 00");
}

TEST_F(MisbehaviourTest, AnnouncesFourBytesAndSendsMore) {
  Entry& text = add(0x100A, 0, DataType::visible_string, Access::constant);
  text.bytes = text.initial_bytes = {'1', '.', '2', '3', '4', '5'};
  behaviour.announces_four_bytes = true;
  boot();
  EXPECT_EQ(sdo({0x40, 0x0A, 0x10, 0, 0, 0, 0, 0}), "581 41 0A 10 00 04 00 00 00");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 03 31 2E 32 33 34 35 00");
  // Nothing is left to be sent: the abort names the last object.
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 80 0A 10 00 01 00 04 05");
}

TEST_F(MisbehaviourTest, AnswersAfterItsBootWhatCameBefore) {
  behaviour.answers_after_boot = true;
  behaviour.boot_time = milliseconds(100);
  device.behaviour() = behaviour;
  device.powerOn(now);
  run(milliseconds(50));
  send(0x601, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  send(0x601, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  EXPECT_THAT(sent(), IsEmpty());
  run(milliseconds(60));
  EXPECT_THAT(sent(),
              ElementsAre("701 00", "581 43 00 10 00 92 01 02 00", "581 43 00 10 00 92 01 02 00"));
}

TEST_F(MisbehaviourTest, ReportsOverrunsAfterItsBoot) {
  behaviour.overruns_at_boot = 2;
  device.behaviour() = behaviour;
  device.powerOn(now);
  run(behaviour.boot_time);
  EXPECT_THAT(sent(),
              ElementsAre("701 00", "081 10 81 11 00 00 00 00 00", "081 10 81 11 00 00 00 00 00"));
}

TEST_F(MisbehaviourTest, BootsInAnotherTimeEachTime) {
  behaviour.boot_time_varies = milliseconds(200);
  device.behaviour() = behaviour;
  std::vector<Duration> times;
  for (int i = 0; i < 3; ++i) {
    device.powerOn(now);
    const Time begin = now;
    while (device.nmtState() == canopen::NmtState::boot_up) run(milliseconds(1));
    times.push_back(now - begin);
    EXPECT_GE(times.back(), behaviour.boot_time);
    EXPECT_LE(times.back(), behaviour.boot_time + milliseconds(201));
  }
  EXPECT_TRUE(times[0] != times[1] && times[1] != times[2]);
}

TEST_F(MisbehaviourTest, TakesSynchronousRpdosAtOnce) {
  presetPdos(1, 1);
  behaviour.rpdos_at_once = true;
  operate();
  send(0x201, {0x06, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(dictionary.find({0x6040, 0})->number, 6U);
}

TEST_F(MisbehaviourTest, TellsTwoStatuswordsForAWhile) {
  operateWithTwoStatuswords();
  setValue(0x6041, 0x0631);
  forget();
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 31 06 00 00 00 00", "281 00 00"));
  run(milliseconds(29));
  forget();
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 31 06 00 00 00 00", "281 31 06"));
}

// Also one that changes sooner than that comes, 29 ms late.
TEST_F(MisbehaviourTest, TellsEachStatuswordLate) {
  operateWithTwoStatuswords();
  std::vector<std::string> late;
  for (const std::uint64_t word : {0x0631U, 0x0633U, 0x0637U, 0x0631U}) {
    setValue(0x6041, word);
    forget();
    send(0x080, {});
    late.push_back(sent().back());
    run(milliseconds(20));
  }
  EXPECT_THAT(late, ElementsAre("281 00 00", "281 00 00", "281 31 06", "281 33 06"));
}

TEST_F(MisbehaviourTest, NmtResetNodeHoldsTheBusButAPowerOnDoesNot) {
  behaviour.reset_jams_bus = milliseconds(300);
  boot();
  EXPECT_LE(device.jamsUntil(), now);
  send(0x000, {0x82, 0x01});
  EXPECT_LE(device.jamsUntil(), now) << "reset communication";
  run(behaviour.boot_time);
  send(0x000, {0x81, 0x01});
  EXPECT_EQ(device.jamsUntil(), now + milliseconds(300));
}

TEST(Misbehaviour, AStormOfEmergenciesEndsWhenItIsCleared) {
  DriveBench bench("generic_cia402");
  ASSERT_TRUE(bench.drive->inject("emergency_storm", bench.now));
  bench.run(ms(100));
  EXPECT_EQ(bench.emergencies().size(), 101U);
  EXPECT_EQ(bench.emergencies()[0], std::make_pair(0x6100, 0x01));
  EXPECT_EQ(bench.state(), 0x40);  // no fault
  ASSERT_TRUE(bench.drive->inject("clear", bench.now));
  bench.sent.clear();
  bench.run(ms(100));
  EXPECT_TRUE(bench.emergencies().empty());
}

TEST(Misbehaviour, TheInhibitTimeHoldsAStorm) {
  DriveBench bench("generic_cia402");
  bench.write(0x1015, 0, 100, 2);  // 10 ms
  bench.sent.clear();
  ASSERT_TRUE(bench.drive->inject("emergency_storm", bench.now));
  bench.run(ms(95));
  EXPECT_EQ(bench.emergencies().size(), 10U);
}

TEST(Misbehaviour, AnExchangedDriveHasAnotherSerialNumberAndNothingStored) {
  DriveBench bench("generic_cia402");
  const std::uint32_t serial = bench.read(0x1018, 4);
  bench.write(0x6065, 0, 4711, 4);
  bench.write(0x1010, 1, 0x65766173, 4);
  ASSERT_TRUE(bench.drive->inject("exchange", bench.now));
  bench.run(ms(1000));
  EXPECT_EQ(bench.read(0x1018, 4), serial + 1);
  EXPECT_EQ(bench.read(0x6065), 65536U);
}

TEST(Misbehaviour, ADriveWithNarrowPdosLoads) {
  DriveBench bench("generic_cia402_narrow");
  EXPECT_EQ(bench.abortOf({0x40, 0x02, 0x14, 0x01, 0, 0, 0, 0}), 0x06020000U);
  EXPECT_EQ(bench.abortOf({0x40, 0x00, 0x1A, 0x03, 0, 0, 0, 0}), 0x06090011U);
  EXPECT_EQ(bench.refusal(0x1800, 1, 0x80000182, 4), 0x06010002U);
  EXPECT_EQ(bench.refusal(0x1800, 1, 0x80000181, 4), 0U);
  bench.write(0x1A00, 0, 0, 1);
  bench.write(0x1A00, 1, 0x60610008, 4);
  EXPECT_EQ(bench.refusal(0x1A00, 0, 1, 1), 0x06040041U);
}

/// A drive in a world, with somebody who acknowledges.
class BusOffDrive : public testing::Test {
 protected:
  BusOffDrive() {
    world.bus().setAnalyser(true);
    const auto definition =
        loadDriveDefinition(cia402::test::configFolder() + "/simulated_drives/generic_cia402.yaml");
    drive = &world.addDrive("x", definition.value(), 1, {});
    world.bus().setMonitor([this](const can::Frame& frame, Time) {
      if (!frame.error) frames.push_back(testing_support::toText(frame));
    });
    world.powerOn();
    world.advance(Time(ms(100)));
    frames.clear();
  }
  void run(Duration duration) { world.advance(world.now() + duration); }

  World world{1e6};
  Drive* drive = nullptr;
  std::vector<std::string> frames;
};

TEST_F(BusOffDrive, StaysSilentForever) {
  world.port(0).forceBusOff();
  run(std::chrono::seconds(60));
  EXPECT_EQ(world.port(0).state(), can::BusState::bus_off);
  EXPECT_THAT(frames, IsEmpty());
}

TEST_F(BusOffDrive, ComesBackByItselfWhereItIsMadeToAndSaysSo) {
  drive->dictionary().find({0x6007, 0})->number = 0;  // a master that is lost does not matter
  drive->device().behaviour().restart_after_bus_off = ms(200);
  world.port(0).forceBusOff();
  run(ms(199));
  EXPECT_EQ(world.port(0).state(), can::BusState::bus_off);
  run(ms(10));
  EXPECT_EQ(world.port(0).state(), can::BusState::error_active);
  EXPECT_THAT(frames, ElementsAre("081 40 81 11 00 00 00 00 00", "081 00 00 00 00 00 00 00 00"));
}

TEST_F(BusOffDrive, ComesBackWithItsPower) {
  world.port(0).forceBusOff();
  run(ms(10));
  ASSERT_TRUE(drive->inject("power_cycle", world.now()));
  run(ms(1000));
  EXPECT_THAT(frames, ElementsAre("701 00"));
}

TEST_F(BusOffDrive, StopsAsIfTheMasterWereLost) {
  drive->dictionary().find({0x6007, 0})->number = 3;  // quick stop
  const auto master = [&](const can::Frame& frame) {
    drive->receive(frame, world.now());
    run(ms(1));
  };
  for (const std::uint8_t word : {std::uint8_t{0x06}, std::uint8_t{0x07}, std::uint8_t{0x0F}}) {
    master(can::Frame(0x601, {0x2B, 0x40, 0x60, 0x00, word, 0x00, 0, 0}));
  }
  ASSERT_TRUE(drive->truth(world.now()).power_stage_on);
  world.port(0).forceBusOff();
  run(ms(50));
  EXPECT_FALSE(drive->truth(world.now()).power_stage_on);
}

}  // namespace
}  // namespace cia402::sim
