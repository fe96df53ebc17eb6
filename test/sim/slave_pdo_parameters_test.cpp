// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class SlavePdoParametersTest : public testing_support::SlaveTest {};

TEST_F(SlavePdoParametersTest, TakesTheStandardsSequence) {
  presetPdos(1, 1);
  boot();
  const std::string done = "581 60 00 1A ";
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x80}), "581 60 00 18 01 00 00 00 00");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x1A, 0, 0, 0, 0, 0}), done + "00 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 1, 0x08, 0, 0x61, 0x60}), done + "01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 2, 0x20, 0, 0x64, 0x60}), done + "02 00 00 00 00");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x1A, 0, 2, 0, 0, 0}), done + "00 00 00 00 00");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x18, 2, 1, 0, 0, 0}), "581 60 00 18 02 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x18, 1, 0x99, 0x01, 0, 0}), "581 60 00 18 01 00 00 00 00");
  send(0x000, {0x01, 0x01});
  setValue(0x6061, 8);
  setValue(0x6064, 0x01020304);
  forget();
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("199 08 04 03 02 01"));
}

TEST_F(SlavePdoParametersTest, KeepsTheCobIdWhileThePdoIsValid) {
  presetPdos(255, 255);
  boot();
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0, 0}), "581 80 00 14 01 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0, 0x80}), "581 80 00 14 01 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x01, 0x02, 0, 0x80}), "581 60 00 14 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0, 0}), "581 60 00 14 01 00 00 00 00");
}

TEST_F(SlavePdoParametersTest, MayLetTheCobIdChangeWithTheDisablingWrite) {
  presetPdos(255, 255);
  behaviour.disable_may_change_id = true;
  boot();
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0, 0x80}), "581 60 00 14 01 00 00 00 00");
}

TEST_F(SlavePdoParametersTest, RefusesRestrictedAndExtendedIdentifiers) {
  boot();
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x81, 0x05, 0, 0}), "581 80 00 14 01 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x00, 0x00, 0, 0}), "581 80 00 14 01 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x01, 0x02, 0, 0x20}), "581 80 00 14 01 30 00 09 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x14, 1, 0x80, 0x05, 0, 0}), "581 60 00 14 01 00 00 00 00");
}

TEST_F(SlavePdoParametersTest, KnowsTheTransmissionTypes) {
  boot();
  const auto type = [this](std::uint8_t record, std::uint8_t number) {
    return sdo({0x2F, 0x00, record, 2, number, 0, 0, 0}).substr(4, 2) == "60";
  };
  for (const std::uint8_t good : std::vector<std::uint8_t>{0, 1, 240, 254, 255}) {
    EXPECT_TRUE(type(0x14, good)) << int{good};
    EXPECT_TRUE(type(0x18, good)) << int{good};
  }
  for (const std::uint8_t bad : std::vector<std::uint8_t>{241, 251}) {
    EXPECT_FALSE(type(0x14, bad)) << int{bad};
    EXPECT_FALSE(type(0x18, bad)) << int{bad};
  }
  EXPECT_FALSE(type(0x14, 252));
  EXPECT_TRUE(type(0x18, 252));
  device.behaviour().rtr_types = false;
  EXPECT_FALSE(type(0x18, 252));
  EXPECT_FALSE(type(0x18, 253));
}

TEST_F(SlavePdoParametersTest, MappingNeedsAnInvalidPdoAndNoActiveEntries) {
  presetPdos(255, 255);
  boot();
  EXPECT_EQ(sdo({0x2F, 0x00, 0x1A, 0, 0, 0, 0, 0}), "581 80 00 1A 00 22 00 00 08");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 1, 0x08, 0, 0x61, 0x60}), "581 80 00 1A 01 22 00 00 08");
  sdo({0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x80});
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 1, 0x08, 0, 0x61, 0x60}), "581 80 00 1A 01 00 00 01 06");
  EXPECT_EQ(value(0x1A00, 1), 0x60410010U);
}

TEST_F(SlavePdoParametersTest, SomeDevicesMapAtAnyTime) {
  presetPdos(255, 1);
  behaviour.mapping_requires_invalid = false;
  operate();
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 1, 0x08, 0, 0x61, 0x60}), "581 60 00 1A 01 00 00 00 00");
  setValue(0x6061, 8);
  forget();
  send(0x080, {});
  EXPECT_THAT(sent(), ElementsAre("181 08 00 00 00 00"));
}

class MappingCheckTest : public SlavePdoParametersTest {
 protected:
  // The abort code of the count write after these entries, low byte first as on the wire.
  std::string map(std::uint8_t record, std::vector<std::uint32_t> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::uint32_t v = values[i];
      const auto byte = [v](unsigned shift) { return static_cast<std::uint8_t>(v >> shift); };
      EXPECT_EQ(sdo({0x23, 0x00, record, static_cast<std::uint8_t>(i + 1), byte(0), byte(8),
                     byte(16), byte(24)})
                    .substr(4, 2),
                "60");
    }
    return sdo({0x2F, 0x00, record, 0, static_cast<std::uint8_t>(values.size()), 0, 0, 0})
        .substr(16);
  }
};

TEST_F(MappingCheckTest, TellsWhatIsWrongWhenTheCountIsWritten) {
  boot();
  EXPECT_EQ(map(0x1A, {0x60410010, 0x60640020}), "00 00 00 00");
  boot();
  EXPECT_EQ(map(0x1A, {0x60420010}), "00 00 02 06");
  EXPECT_EQ(map(0x1A, {0x60410110}), "00 00 02 06");
  EXPECT_EQ(map(0x1A, {0x60650020}), "41 00 04 06");
  EXPECT_EQ(map(0x16, {0x60410010}), "41 00 04 06");
  EXPECT_EQ(map(0x1A, {0x60410020}), "42 00 04 06");
  EXPECT_EQ(map(0x1A, {0x60640020, 0x60640020, 0x60610008}), "42 00 04 06");
  EXPECT_EQ(map(0x1A, {0x60640020, 0x60640020}), "00 00 00 00");
}

TEST_F(MappingCheckTest, RefusesMoreEntriesThanItHas) {
  boot();
  EXPECT_EQ(sdo({0x2F, 0x00, 0x1A, 0, 9, 0, 0, 0}), "581 80 00 1A 00 42 00 04 06");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x1A, 0, 255, 0, 0, 0}), "581 80 00 1A 00 42 00 04 06");
}

TEST_F(MappingCheckTest, TakesDummyEntriesInRpdosOnly) {
  boot();
  EXPECT_EQ(map(0x16, {0x00060010, 0x607A0020, 0x00050008, 0x00020008}), "00 00 00 00");
  EXPECT_EQ(map(0x1A, {0x00060010}), "00 00 02 06");
  boot();
  EXPECT_EQ(map(0x16, {0x00060008}), "42 00 04 06");
}

TEST_F(SlavePdoParametersTest, MayCheckAnEntryWhenItIsWritten) {
  behaviour.map_entry_checked_on_write = true;
  boot();
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 1, 0x20, 0, 0x65, 0x60}), "581 80 00 1A 01 41 00 04 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 1, 0x00, 0, 0x00, 0x00}), "581 60 00 1A 01 00 00 00 00");
}

TEST_F(SlavePdoParametersTest, AReadOnlyCountFollowsTheEntries) {
  behaviour.map_count_read_only = true;
  boot();
  EXPECT_EQ(sdo({0x2F, 0x00, 0x1A, 0, 0, 0, 0, 0}), "581 80 00 1A 00 02 00 01 06");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 1, 0x10, 0, 0x41, 0x60}), "581 60 00 1A 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 2, 0x20, 0, 0x64, 0x60}), "581 60 00 1A 02 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x00, 0x1A, 3, 0x20, 0, 0x64, 0x60}), "581 80 00 1A 03 42 00 04 06");
  EXPECT_EQ(sdo({0x40, 0x00, 0x1A, 0, 0, 0, 0, 0}), "581 4F 00 1A 00 02 00 00 00");
}

TEST_F(SlavePdoParametersTest, MayLockTimersWhileThePdoIsValid) {
  presetPdos(255, 255);
  behaviour.timers_require_invalid = true;
  boot();
  EXPECT_EQ(sdo({0x2B, 0x00, 0x18, 3, 10, 0, 0, 0}), "581 80 00 18 03 22 00 00 08");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x18, 6, 10, 0, 0, 0}), "581 80 00 18 06 22 00 00 08");
  device.behaviour().timers_require_invalid = false;
  EXPECT_EQ(sdo({0x2B, 0x00, 0x18, 3, 10, 0, 0, 0}), "581 60 00 18 03 00 00 00 00");
  EXPECT_EQ(sdo({0x2F, 0x00, 0x18, 6, 241, 0, 0, 0}), "581 80 00 18 06 30 00 09 06");
}

}  // namespace
}  // namespace cia402::sim
