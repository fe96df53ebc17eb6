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
