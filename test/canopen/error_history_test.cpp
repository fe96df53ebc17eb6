// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/emcy/error_history.h"

#include <gmock/gmock.h>

#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using testing::HasSubstr;

class ErrorHistoryTest : public test::SdoClientFixture {
 protected:
  ErrorHistory read(unsigned most = ErrorHistoryReader::kAll) {
    ErrorHistoryReader reader(most);
    for (int i = 0; i < 600; ++i) {
      if (reader.step(client)) return reader.history();
      run();
    }
    ADD_FAILURE() << "never done";
    return reader.history();
  }
  void hold(const char* count) { peer.on("601 40 03 10 00 00 00 00 00", count); }
  void answer(int sub_index, const std::string& data) {
    char request[40], response[40];
    std::snprintf(request, sizeof request, "601 40 03 10 %02X 00 00 00 00", unsigned(sub_index));
    std::snprintf(response, sizeof response, "581 %s", data.c_str());
    peer.on(request, response);
  }
};

TEST_F(ErrorHistoryTest, ReadsTheNumberThenTheEntriesNewestFirst) {
  hold("581 4F 03 10 00 02 00 00 00");
  answer(1, "43 03 10 01 11 86 34 12");  // 0x12348611
  answer(2, "43 03 10 02 10 23 00 00");  // 0x00002310
  const ErrorHistory history = read();
  EXPECT_TRUE(history.readable);
  EXPECT_EQ(history.recorded, 2u);
  EXPECT_EQ(history.remark, "");
  ASSERT_EQ(history.entries.size(), 2u);
  EXPECT_EQ(history.entries[0].code, 0x8611);
  EXPECT_EQ(history.entries[0].info, 0x1234);
  EXPECT_EQ(history.entries[1].code, 0x2310);
  EXPECT_EQ(history.entries[1].info, 0);
}

TEST_F(ErrorHistoryTest, AsksForNoEntryWhereThereIsNone) {
  hold("581 4F 03 10 00 00 00 00 00");
  const ErrorHistory history = read();
  EXPECT_TRUE(history.readable);
  EXPECT_TRUE(history.entries.empty());
  EXPECT_EQ(peer.sent.size(), 1u);
}

TEST_F(ErrorHistoryTest, ReadsNoMoreThanWasAskedFor) {
  hold("581 4F 03 10 00 09 00 00 00");
  answer(1, "43 03 10 01 11 86 00 00");
  answer(2, "43 03 10 02 12 86 00 00");
  const ErrorHistory history = read(2);
  EXPECT_EQ(history.recorded, 9u);
  EXPECT_EQ(history.entries.size(), 2u);
  EXPECT_EQ(history.remark, "");
}

TEST_F(ErrorHistoryTest, TellsADriveWithoutOne) {
  hold("581 80 03 10 00 00 00 02 06");  // 0x06020000: no such object
  const ErrorHistory history = read();
  EXPECT_FALSE(history.readable);
  EXPECT_EQ(history.remark, "the drive keeps no error history: 1003:00 does not exist");
}

TEST_F(ErrorHistoryTest, NoDataAvailableMeansThatThereIsNoError) {
  hold("581 80 03 10 00 24 00 00 08");  // 0x08000024
  const ErrorHistory history = read();
  EXPECT_TRUE(history.readable);
  EXPECT_EQ(history.recorded, 0u);
  EXPECT_EQ(history.remark, "");
}

TEST_F(ErrorHistoryTest, WhereTheCountIsThatOfThePlacesTheErrorsEndWithTheData) {
  hold("581 4F 03 10 00 08 00 00 00");
  answer(1, "43 03 10 01 11 86 00 00");
  answer(2, "80 03 10 02 24 00 00 08");
  const ErrorHistory history = read();
  EXPECT_EQ(history.recorded, 1u);
  EXPECT_EQ(history.entries.size(), 1u);
  EXPECT_EQ(history.remark, "");
}

TEST_F(ErrorHistoryTest, TellsADriveThatDoesNotAnswer) {
  ErrorHistoryReader reader;
  EXPECT_FALSE(reader.step(client));
  run();
  for (int i = 0; i < 2; ++i) wait(500);
  EXPECT_TRUE(reader.step(client));
  EXPECT_THAT(reader.history().remark, HasSubstr("1003:00 not read: "));
}

TEST_F(ErrorHistoryTest, KeepsWhatItReadBeforeADriveRefusesAnEntry) {
  hold("581 4F 03 10 00 03 00 00 00");
  answer(1, "43 03 10 01 11 86 00 00");
  answer(2, "80 03 10 02 11 00 09 06");  // 0x06090011: no such sub-index
  const ErrorHistory history = read();
  EXPECT_TRUE(history.readable);
  EXPECT_EQ(history.entries.size(), 1u);
  EXPECT_EQ(history.remark, "the drive holds 1 of 3 errors that it counts (1003:00)");
}

TEST_F(ErrorHistoryTest, TellsAnotherRefusalWithItsReason) {
  hold("581 4F 03 10 00 03 00 00 00");
  answer(1, "80 03 10 01 22 00 00 08");  // 0x08000022: device state
  EXPECT_THAT(read().remark, HasSubstr("entry 1 of 3 errors not read: "));
}

TEST_F(ErrorHistoryTest, TakesANumberOfFourBytesAndEntriesOfTwo) {
  hold("581 43 03 10 00 01 00 00 00");
  answer(1, "4B 03 10 01 05 73 00 00");
  const ErrorHistory history = read();
  ASSERT_EQ(history.entries.size(), 1u);
  EXPECT_EQ(history.entries[0].code, 0x7305);
  EXPECT_EQ(history.entries[0].info, 0);
}

TEST_F(ErrorHistoryTest, RefusesNonsense) {
  hold("581 43 03 10 00 00 00 00 01");
  EXPECT_EQ(read().remark, "1003:00 is no number of errors: the drive sent 4 bytes, 16777216");
}

TEST_F(ErrorHistoryTest, RefusesAnEntryOfOneByte) {
  hold("581 4F 03 10 00 01 00 00 00");
  answer(1, "4F 03 10 01 05 00 00 00");
  EXPECT_EQ(read().remark, "entry 1 of 1003h has 1 bytes instead of 4");
}

TEST_F(ErrorHistoryTest, WaitsForEachAnswer) {
  ErrorHistoryReader reader;
  EXPECT_FALSE(reader.step(client));
  client.tick(now);
  EXPECT_FALSE(reader.step(client)) << "none has come yet";
  receive("581 4F 03 10 00 01 00 00 00");
  EXPECT_FALSE(reader.step(client));
  client.tick(now);
  EXPECT_FALSE(reader.step(client));
  receive("581 43 03 10 01 11 86 00 00");
  EXPECT_TRUE(reader.step(client));
  EXPECT_EQ(reader.history().remark, "");
  EXPECT_EQ(reader.history().entries.size(), 1u);
}

}  // namespace
}  // namespace cia402::canopen
