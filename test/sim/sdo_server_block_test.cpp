// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Block transfers of the simulated SDO server, and its second channel, byte by byte as CiA 301,
// 7.2.4.3.8 to 7.2.4.3.16 has them.
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::milliseconds;

class SdoServerBlockTest : public testing_support::SlaveTest {
 protected:
  SdoServerBlockTest() {
    // The CRC-16 of the standard has 0x31C3 for these nine characters.
    add(0x2000, 1, DataType::visible_string, Access::rw).bytes = {'1', '2', '3', '4', '5',
                                                                  '6', '7', '8', '9'};
    dictionary.find({0x2000, 1})->initial_bytes = dictionary.find({0x2000, 1})->bytes;
  }
  std::vector<std::string> ask(std::initializer_list<std::uint8_t> bytes) {
    forget();
    send(0x601, bytes);
    return sent();
  }
  std::string text() const {
    const Entry* entry = dictionary.find({0x2000, 1});
    return {entry->bytes.begin(), entry->bytes.end()};
  }
};

TEST_F(SdoServerBlockTest, UploadsInSegmentsAndEndsWithTheCrc) {
  boot();
  EXPECT_THAT(ask({0xA4, 0x00, 0x20, 0x01, 0x7F, 0, 0, 0}),
              ElementsAre("581 C6 00 20 01 09 00 00 00"));
  EXPECT_THAT(ask({0xA3, 0, 0, 0, 0, 0, 0, 0}),
              ElementsAre("581 01 31 32 33 34 35 36 37", "581 82 38 39 00 00 00 00 00"));
  EXPECT_THAT(ask({0xA2, 2, 0x7F, 0, 0, 0, 0, 0}), ElementsAre("581 D5 C3 31 00 00 00 00 00"));
  EXPECT_THAT(ask({0xA1, 0, 0, 0, 0, 0, 0, 0}), IsEmpty());
}

TEST_F(SdoServerBlockTest, SendsAgainWhatWasNotAcknowledged) {
  boot();
  ask({0xA4, 0x00, 0x20, 0x01, 0x7F, 0, 0, 0});
  ask({0xA3, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(ask({0xA2, 1, 0x7F, 0, 0, 0, 0, 0}), ElementsAre("581 81 38 39 00 00 00 00 00"));
  EXPECT_THAT(ask({0xA2, 1, 0x7F, 0, 0, 0, 0, 0}), ElementsAre("581 D5 C3 31 00 00 00 00 00"));
}

TEST_F(SdoServerBlockTest, KeepsToTheBlockSizeOfTheClient) {
  boot();
  ask({0xA4, 0x00, 0x20, 0x01, 1, 0, 0, 0});
  EXPECT_THAT(ask({0xA3, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("581 01 31 32 33 34 35 36 37"));
  EXPECT_THAT(ask({0xA2, 1, 1, 0, 0, 0, 0, 0}), ElementsAre("581 81 38 39 00 00 00 00 00"));
}

TEST_F(SdoServerBlockTest, AnswersAShortUploadInTheOrdinaryWay) {
  boot();
  EXPECT_THAT(ask({0xA4, 0x00, 0x10, 0x00, 0x7F, 0x1C, 0, 0}),
              ElementsAre("581 43 00 10 00 92 01 02 00"));
}

TEST_F(SdoServerBlockTest, DownloadsAndChecksTheCrc) {
  boot();
  EXPECT_THAT(ask({0xC6, 0x00, 0x20, 0x01, 0x09, 0, 0, 0}),
              ElementsAre("581 A4 00 20 01 7F 00 00 00"));
  EXPECT_THAT(ask({0x01, '9', '8', '7', '6', '5', '4', '3'}), IsEmpty());
  EXPECT_THAT(ask({0x82, '2', '1', 0, 0, 0, 0, 0}), ElementsAre("581 A2 02 7F 00 00 00 00 00"));
  EXPECT_EQ(text(), "123456789") << "not before the CRC";
  EXPECT_THAT(ask({0xD5, 0xC3, 0x31, 0, 0, 0, 0, 0}), ElementsAre("581 80 00 20 01 04 00 04 05"));
  EXPECT_EQ(text(), "123456789");
}

TEST_F(SdoServerBlockTest, TakesADownloadWithTheRightCrc) {
  dictionary.find({0x2000, 1})->bytes = {'x'};
  dictionary.find({0x2000, 1})->initial_bytes = {'x'};
  boot();
  ask({0xC6, 0x00, 0x20, 0x01, 0x09, 0, 0, 0});
  ask({0x01, '1', '2', '3', '4', '5', '6', '7'});
  ask({0x82, '8', '9', 0, 0, 0, 0, 0});
  EXPECT_THAT(ask({0xD5, 0xC3, 0x31, 0, 0, 0, 0, 0}), ElementsAre("581 A1 00 00 00 00 00 00 00"));
  EXPECT_EQ(text(), "123456789");
}

TEST_F(SdoServerBlockTest, TellsTheLastSegmentThatCameInOrder) {
  boot();
  ask({0xC6, 0x00, 0x20, 0x01, 0x10, 0, 0, 0});
  ask({0x01, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_THAT(ask({0x83, 1, 2, 0, 0, 0, 0, 0}), ElementsAre("581 A2 01 7F 00 00 00 00 00"));
}

TEST_F(SdoServerBlockTest, AsksForItsOwnBlockSizeAndCanDoWithoutCrc) {
  behaviour.sdo_block_size = 1;
  behaviour.sdo_block_crc = false;
  boot();
  EXPECT_THAT(ask({0xC6, 0x00, 0x20, 0x01, 0x08, 0, 0, 0}),
              ElementsAre("581 A0 00 20 01 01 00 00 00"));
  EXPECT_THAT(ask({0x01, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}),
              ElementsAre("581 A2 01 01 00 00 00 00 00"));
  EXPECT_THAT(ask({0x81, 'h', 0, 0, 0, 0, 0, 0}), ElementsAre("581 A2 01 01 00 00 00 00 00"));
  EXPECT_THAT(ask({0xD9, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("581 A1 00 00 00 00 00 00 00"));
  EXPECT_EQ(text(), "abcdefgh");
}

TEST_F(SdoServerBlockTest, RefusesOtherLengthsThanAnnounced) {
  behaviour.sdo_block_crc = false;
  boot();
  ask({0xC6, 0x00, 0x20, 0x01, 0x09, 0, 0, 0});
  ask({0x81, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_THAT(ask({0xC1, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("581 80 00 20 01 13 00 07 06"));
  EXPECT_EQ(text(), "123456789");
}

TEST_F(SdoServerBlockTest, RefusesAnEndBeforeTheEndAndSubBlocksOfNoSegments) {
  boot();
  EXPECT_THAT(ask({0xC1, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("581 80 00 00 00 01 00 04 05"));
  EXPECT_THAT(ask({0xA4, 0x00, 0x20, 0x01, 0, 0, 0, 0}),
              ElementsAre("581 80 00 20 01 02 00 04 05"));
}

TEST_F(SdoServerBlockTest, HasASecondChannelOnTheCobIdsOf1201h) {
  add(0x1201, 0, DataType::uint8, Access::constant, 2);
  add(0x1201, 1, DataType::uint32, Access::rw, 0x80000000);
  add(0x1201, 2, DataType::uint32, Access::rw, 0x80000000);
  boot();
  send(0x641, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_THAT(sent(), IsEmpty()) << "not valid yet";
  EXPECT_EQ(sdo({0x23, 0x01, 0x12, 1, 0x41, 0x06, 0, 0}), "581 60 01 12 01 00 00 00 00");
  EXPECT_EQ(sdo({0x23, 0x01, 0x12, 2, 0xC1, 0x05, 0, 0}), "581 60 01 12 02 00 00 00 00");
  send(0x641, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_THAT(sent(), testing::Contains("5C1 43 00 10 00 92 01 02 00"));
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), "581 43 00 10 00 92 01 02 00");
}

}  // namespace
}  // namespace cia402::sim
