// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "drive_fixture.h"

namespace cia402::sim {
namespace {

constexpr std::uint32_t kSave = 0x65766173;  // "save" as it stands on the wire: 73 61 76 65
constexpr std::uint32_t kLoad = 0x64616F6C;  // "load": 6C 6F 61 64

class ParameterStoreTest : public testing::Test {
 protected:
  void powerCycle() {
    bench.drive->powerOff(bench.now);
    bench.drive->powerOn(bench.now);
    bench.run(ms(100));
  }
  DriveBench bench{"generic_cia402"};
};

TEST_F(ParameterStoreTest, KeepsTheMarkOfAConfigurationUntilSomethingChanges) {
  bench.write(0x1020, 1, 12345, 4);
  bench.write(0x1020, 2, 678, 4);
  bench.write(0x6065, 0, 65536, 4);  // what it was before
  bench.control(0x0006);             // no parameters
  bench.write(0x6060, 0, 8, 1);
  bench.write(0x607A, 0, 99, 4);
  EXPECT_EQ(bench.read(0x1020, 1), 12345U);
  bench.write(0x6065, 0, 65537, 4);
  EXPECT_EQ(bench.read(0x1020, 1), 0U);
  EXPECT_EQ(bench.read(0x1020, 2), 0U);
}

TEST_F(ParameterStoreTest, ARefusedWriteLeavesTheMark) {
  bench.write(0x1020, 1, 12345, 4);
  EXPECT_NE(bench.refusal(0x605A, 0, 99, 2), 0U);
  EXPECT_EQ(bench.read(0x1020, 1), 12345U);
}

TEST_F(ParameterStoreTest, StoresTheMarkWithTheParameters) {
  bench.write(0x6065, 0, 4711, 4);
  bench.write(0x1020, 1, 12345, 4);
  powerCycle();
  EXPECT_EQ(bench.read(0x1020, 1), 0U);
  EXPECT_EQ(bench.read(0x6065), 65536U);
  bench.write(0x6065, 0, 4711, 4);
  bench.write(0x1020, 1, 12345, 4);
  bench.write(0x1010, 1, kSave, 4);
  powerCycle();
  EXPECT_EQ(bench.read(0x1020, 1), 12345U);
  EXPECT_EQ(bench.read(0x6065), 4711U);
  bench.write(0x1011, 1, kLoad, 4);
  EXPECT_EQ(bench.read(0x6065), 4711U);  // takes effect with the next reset
  powerCycle();
  EXPECT_EQ(bench.read(0x1020, 1), 0U);
  EXPECT_EQ(bench.read(0x6065), 65536U);
}

// H0C.13, H02.31 and H0E.10 of an SV660C.
class ParameterMemoryTest : public ParameterStoreTest {
 protected:
  ParameterMemoryTest() : sv660c("sv660c") { sv660c.run(ms(700)); }
  void powerCycleSv660c() {
    sv660c.drive->powerOff(sv660c.now);
    sv660c.drive->powerOn(sv660c.now);
    sv660c.run(ms(800));
  }
  std::uint64_t number(std::uint16_t index, std::uint8_t sub) {
    return sv660c.drive->dictionary().find({index, sub})->number;
  }
  DriveBench sv660c;
};

TEST_F(ParameterMemoryTest, KeepsWhatIsWrittenWhileItsSwitchSaysSo) {
  sv660c.write(0x2008, 1, 250, 2);  // H0C.13 is 1 from the factory
  sv660c.write(0x200C, 0x0E, 0, 2);
  sv660c.write(0x2008, 3, 300, 2);
  sv660c.write(0x2008, 1, 251, 2);
  powerCycleSv660c();
  EXPECT_EQ(number(0x2008, 1), 250U);
  EXPECT_EQ(number(0x2008, 3), 640U);
  EXPECT_EQ(number(0x200C, 0x0E), 1U) << "0 was not to be kept";
  sv660c.write(0x6065, 0, 4711, 4);
  powerCycleSv660c();
  EXPECT_EQ(number(0x6065, 0), 27486951U) << "no parameter of the maker";
}

TEST_F(ParameterMemoryTest, IsThatOfTheFactoryAfterItsResetAndSilentWithoutCanopen) {
  sv660c.write(0x2008, 1, 250, 2);
  sv660c.write(0x2002, 0x20, 2, 2);  // clears the fault record
  EXPECT_EQ(number(0x2008, 1), 250U);
  sv660c.write(0x2002, 0x20, 1, 2);
  EXPECT_EQ(number(0x2008, 1), 400U);
  EXPECT_EQ(number(0x2002, 1), 1U);
  EXPECT_EQ(number(0x200E, 0x0B), 0U);
  EXPECT_EQ(number(0x2002, 0x20), 0U);
  EXPECT_EQ(sv660c.read(0x2008, 1), 400U) << "it is there until the power was off";
  powerCycleSv660c();
  const std::size_t before = sv660c.sent.size();
  sv660c.frame(0x601, {0x40, 0x08, 0x20, 0x01, 0, 0, 0, 0});
  sv660c.run(ms(500));
  EXPECT_EQ(sv660c.sent.size(), before) << "neither boot-up nor answer";
}

TEST_F(ParameterStoreTest, ASubIndexStoresItsOwnGroup) {
  bench.write(0x6065, 0, 4711, 4);
  bench.write(0x1017, 0, 250, 2);
  bench.write(0x1010, 2, kSave, 4);  // communication
  powerCycle();
  EXPECT_EQ(bench.read(0x6065), 65536U);
  EXPECT_EQ(bench.read(0x1017) & 0xFFFF, 250U);
}

TEST_F(ParameterStoreTest, WantsTheSignatureAndTheDriveDisabled) {
  EXPECT_EQ(bench.refusal(0x1010, 1, kLoad, 4), 0x08000020U);
  EXPECT_EQ(bench.refusal(0x1011, 1, kSave, 4), 0x08000020U);
  bench.enable();
  EXPECT_EQ(bench.refusal(0x1010, 1, kSave, 4), 0x08000022U);
  EXPECT_EQ(bench.refusal(0x1011, 1, kLoad, 4), 0x08000022U);
}

TEST_F(ParameterStoreTest, AnswersWhenTheSlowMemoryIsDone) {
  bench.drive->device().behaviour().store_time = ms(3000);
  bench.sent.clear();
  bench.frame(0x601, {0x23, 0x10, 0x10, 0x01, 0x73, 0x61, 0x76, 0x65});
  bench.run(ms(3000));
  EXPECT_TRUE(bench.sent.empty());
  bench.run(ms(1));
  ASSERT_EQ(bench.sent.size(), 1U);
  EXPECT_EQ(bench.sent[0], can::Frame(0x581, {0x60, 0x10, 0x10, 0x01, 0, 0, 0, 0}));
  EXPECT_EQ(bench.read(0x1010, 1), 1U);  // within a millisecond
}

}  // namespace
}  // namespace cia402::sim
