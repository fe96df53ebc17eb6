// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/sdo_decoder.h"

#include <gtest/gtest.h>

#include "decode/decode_fixture.h"

namespace cia402::decode {
namespace {

/// Frames as CiA 301, 7.2.4.3 lays them out.
class Sdo : public testing::Test {
 protected:
  std::string request(std::initializer_list<std::uint8_t> bytes) {
    return sdo.request({0x601, bytes});
  }
  static NodeValues valuesOf(const drive::AxisConfig& axis) {
    NodeValues values;
    values.add(axis);
    return values;
  }
  std::string answer(std::initializer_list<std::uint8_t> bytes) {
    return sdo.answer({0x581, bytes});
  }

  config::RobotConfig robot = test::robot();
  NodeValues values =
      valuesOf(robot.axes.front().name == "shoulder" ? robot.axes[0] : robot.axes[1]);
  SdoDecoder sdo{&values};
};

TEST_F(Sdo, ExpeditedValuesAreInWords) {
  EXPECT_EQ(request({0x2F, 0x60, 0x60, 0x00, 0x08, 0, 0, 0}),
            "write 6060:00 mode_of_operation = 8 cyclic_position");
  EXPECT_EQ(answer({0x60, 0x60, 0x60, 0x00, 0, 0, 0, 0}), "written 6060:00 mode_of_operation");
  EXPECT_EQ(request({0x40, 0x64, 0x60, 0x00, 0, 0, 0, 0}), "read 6064:00 position_actual");
  EXPECT_EQ(answer({0x43, 0x64, 0x60, 0x00, 0xE0, 0x2E, 0x03, 0x00}),
            "read 6064:00 position_actual = 0.1 rad (208608)");
  EXPECT_EQ(answer({0x4B, 0x3F, 0x60, 0x00, 0x05, 0x73, 0, 0}),
            "read 603F:00 error_code = 0x7305 incremental sensor 1 fault");
  EXPECT_EQ(request({0x2B, 0x17, 0x10, 0x00, 0xF4, 0x01, 0, 0}),
            "write 1017:00 producer heartbeat time = 500 (0x01F4)");
  EXPECT_EQ(request({0x23, 0x00, 0x1A, 0x01, 0x10, 0x00, 0x41, 0x60}),
            "write 1A00:01 TPDO1 mapping, entry 1 = 1614872592 (0x60410010)");
}

TEST_F(Sdo, WithoutAnIndicatedSizeAllFourBytesAreTaken) {
  EXPECT_EQ(answer({0x42, 0x45, 0x23, 0x05, 0x01, 0x00, 0x00, 0x80}),
            "read 2345:05 = 2147483649 (0x80000001)");
}

TEST_F(Sdo, AValueOfTheWrongSizeIsTold) {
  EXPECT_EQ(answer({0x4F, 0x41, 0x60, 0x00, 0x37, 0, 0, 0}),
            "read 6041:00 statusword = \"7\" (1 bytes, but the profile says uint16)");
}

TEST_F(Sdo, AbortsAreInWords) {
  EXPECT_EQ(answer({0x80, 0x60, 0x60, 0x00, 0x30, 0x00, 0x09, 0x06}),
            "abort 6060:00 mode_of_operation: 0x06090030 (invalid value for parameter)");
  EXPECT_EQ(request({0x80, 0x60, 0x60, 0x00, 0x00, 0x00, 0x04, 0x05}),
            "abort 6060:00 mode_of_operation: 0x05040000 (SDO protocol timed out)");
}

TEST_F(Sdo, ASegmentedUploadIsPutTogether) {
  EXPECT_EQ(request({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0}), "read 1008:00 device name");
  EXPECT_EQ(answer({0x41, 0x08, 0x10, 0x00, 0x0A, 0, 0, 0}),
            "read 1008:00 device name, 10 bytes in segments");
  EXPECT_EQ(request({0x60, 0, 0, 0, 0, 0, 0, 0}), "next segment 1008:00 device name, toggle 0");
  EXPECT_EQ(answer({0x00, 'S', 'e', 'r', 'v', 'o', ' ', '1'}),
            "segment 1008:00 device name, toggle 0, 7 bytes");
  EXPECT_EQ(request({0x70, 0, 0, 0, 0, 0, 0, 0}), "next segment 1008:00 device name, toggle 1");
  EXPECT_EQ(answer({0x19, '2', '3', '4', 0, 0, 0, 0}),
            "segment 1008:00 device name, toggle 1, 3 bytes, the last: 10 bytes in all: "
            "\"Servo 1234\"");
}

TEST_F(Sdo, ASegmentedDownloadIsPutTogether) {
  EXPECT_EQ(request({0x21, 0x21, 0x20, 0x00, 0x08, 0, 0, 0}), "write 2021:00, 8 bytes in segments");
  EXPECT_EQ(answer({0x60, 0x21, 0x20, 0x00, 0, 0, 0, 0}), "written 2021:00");
  EXPECT_EQ(request({0x00, 1, 2, 3, 4, 5, 6, 7}), "segment 2021:00, toggle 0, 7 bytes");
  EXPECT_EQ(answer({0x20, 0, 0, 0, 0, 0, 0, 0}), "segment taken 2021:00, toggle 0");
  EXPECT_EQ(request({0x1D, 8, 0, 0, 0, 0, 0, 0}),
            "segment 2021:00, toggle 1, 1 byte, the last: 8 bytes in all: 01 02 03 04 05 06 07 08");
  EXPECT_EQ(answer({0x30, 0, 0, 0, 0, 0, 0, 0}), "segment taken 2021:00, toggle 1");
}

TEST_F(Sdo, ABlockDownloadIsPutTogether) {
  EXPECT_EQ(request({0xC6, 0x21, 0x20, 0x01, 0x0A, 0, 0, 0}),
            "block write 2021:01, 10 bytes, with CRC");
  EXPECT_EQ(answer({0xA4, 0x21, 0x20, 0x01, 0x7F, 0, 0, 0}),
            "block write accepted 2021:01, 127 segments a block, with CRC");
  // A segment 0x21 would be "initiate download" outside a block, 0x40 "initiate upload".
  EXPECT_EQ(request({0x01, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), "block segment 1 2021:01");
  EXPECT_EQ(request({0x82, 'h', 'i', 'j', 0, 0, 0, 0}), "block segment 2 2021:01, the last");
  EXPECT_EQ(answer({0xA2, 2, 0x7F, 0, 0, 0, 0, 0}), "segments up to 2 taken, 127 segments a block");
  EXPECT_EQ(request({0xD1, 0x34, 0x12, 0, 0, 0, 0, 0}),
            "end of blocks 2021:01, CRC 0x1234: 10 bytes in all: \"abcdefghij\"");
  EXPECT_EQ(answer({0xA1, 0, 0, 0, 0, 0, 0, 0}), "block write complete 2021:01");
}

TEST_F(Sdo, SegmentsOfABlockThatWereNotTakenComeAgain) {
  request({0xC2, 0x21, 0x20, 0x01, 0x0E, 0, 0, 0});
  answer({0xA0, 0x21, 0x20, 0x01, 0x02, 0, 0, 0});
  request({0x01, 'a', 'b', 'c', 'd', 'e', 'f', 'g'});
  request({0x82, 'h', 'i', 'j', 'k', 'l', 'm', 'n'});
  EXPECT_EQ(answer({0xA2, 1, 0x02, 0, 0, 0, 0, 0}), "segments up to 1 taken, 2 segments a block");
  EXPECT_EQ(request({0x81, 'h', 'i', 'j', 'k', 'l', 'm', 'n'}),
            "block segment 1 2021:01, the last");
  answer({0xA2, 1, 0x02, 0, 0, 0, 0, 0});
  EXPECT_EQ(request({0xC1, 0, 0, 0, 0, 0, 0, 0}),
            "end of blocks 2021:01, CRC 0x0000: 14 bytes in all: \"abcdefghijklmn\"");
}

TEST_F(Sdo, ABlockUploadIsPutTogether) {
  EXPECT_EQ(request({0xA4, 0x08, 0x10, 0x00, 0x7F, 0, 0, 0}),
            "block read 1008:00 device name, 127 segments a block, with CRC");
  EXPECT_EQ(answer({0xC6, 0x08, 0x10, 0x00, 0x05, 0, 0, 0}),
            "block read accepted 1008:00 device name, 5 bytes, with CRC");
  EXPECT_EQ(request({0xA3, 0, 0, 0, 0, 0, 0, 0}), "block read begins 1008:00 device name");
  EXPECT_EQ(answer({0x81, 'S', 'e', 'r', 'v', 'o', 0, 0}),
            "block segment 1 1008:00 device name, the last");
  EXPECT_EQ(request({0xA2, 1, 0x7F, 0, 0, 0, 0, 0}),
            "segments up to 1 taken, 127 segments a block");
  EXPECT_EQ(answer({0xC9, 0xCD, 0xAB, 0, 0, 0, 0, 0}),
            "end of blocks 1008:00 device name, CRC 0xABCD: 5 bytes in all: \"Servo\"");
  EXPECT_EQ(request({0xA1, 0, 0, 0, 0, 0, 0, 0}), "block read complete 1008:00 device name");
}

TEST_F(Sdo, AnAbortEndsABlockInTheMiddle) {
  request({0xC2, 0x21, 0x20, 0x01, 0x0E, 0, 0, 0});
  answer({0xA0, 0x21, 0x20, 0x01, 0x7F, 0, 0, 0});
  request({0x01, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(request({0x80, 0x21, 0x20, 0x01, 0x00, 0x00, 0x04, 0x05}),
            "abort 2021:01: 0x05040000 (SDO protocol timed out)");
  EXPECT_EQ(request({0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}), "read 6041:00 statusword");
}

TEST_F(Sdo, ATransferFromBeforeTheRecordingHasNoObject) {
  EXPECT_EQ(answer({0x00, 1, 2, 3, 4, 5, 6, 7}),
            "segment of a transfer that began before, toggle 0, 7 bytes");
  EXPECT_EQ(answer({0x13, 1, 2, 3, 4, 5, 6, 0}),
            "segment of a transfer that began before, toggle 1, 6 bytes, the last");
}

TEST_F(Sdo, LongTransfersAreCut) {
  request({0x21, 0x21, 0x20, 0x00, 0x46, 0, 0, 0});
  for (int i = 0; i < 9; ++i) request({0x00, 'x', 'x', 'x', 'x', 'x', 'x', 'x'});
  EXPECT_EQ(request({0x01, 'x', 'x', 'x', 'x', 'x', 'x', 'x'}),
            "segment 2021:00, toggle 0, 7 bytes, the last: 70 bytes in all: "
            "\"xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx\"... and so on");
}

TEST_F(Sdo, DamagedFramesHaveWords) {
  EXPECT_EQ(request({0x40, 0x41}), "too short for an SDO: 2 bytes");
  EXPECT_EQ(answer({}), "too short for an SDO: 0 bytes");
  EXPECT_EQ(request({0xE0, 0, 0, 0, 0, 0, 0, 0}), "no SDO command: 0xE0");
  EXPECT_EQ(answer({0xFF, 0, 0, 0, 0, 0, 0, 0}), "no SDO command: 0xFF");
}

}  // namespace
}  // namespace cia402::decode
