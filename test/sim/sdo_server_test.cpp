// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "slave_fixture.h"

namespace cia402::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::microseconds;
using testing_support::milliseconds;

class SdoServerTest : public testing_support::SlaveTest {};

TEST_F(SdoServerTest, AnswersUploadsOfUpToFourBytesExpedited) {
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), "581 43 00 10 00 92 01 02 00");
  EXPECT_EQ(sdo({0x40, 0x17, 0x10, 0x00, 0, 0, 0, 0}), "581 4B 17 10 00 00 00 00 00");
  EXPECT_EQ(sdo({0x40, 0x16, 0x10, 0x00, 0, 0, 0, 0}), "581 4F 16 10 00 02 00 00 00");
  dictionary.find({0x1000, 0})->type = DataType::visible_string;
  dictionary.find({0x1000, 0})->bytes = {'D', 'M', '4'};
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), "581 47 00 10 00 44 4D 34 00");
}

TEST_F(SdoServerTest, TakesExpeditedDownloads) {
  boot();
  EXPECT_EQ(sdo({0x2F, 0x60, 0x60, 0x00, 0xFE, 0, 0, 0}), "581 60 60 60 00 00 00 00 00");
  EXPECT_EQ(asSigned(*dictionary.find({0x6060, 0})), -2);
  EXPECT_EQ(sdo({0x2B, 0x40, 0x60, 0x00, 0x0F, 0x01, 0, 0}), "581 60 40 60 00 00 00 00 00");
  EXPECT_EQ(value(0x6040), 0x010FU);
  EXPECT_EQ(sdo({0x23, 0x65, 0x60, 0x00, 1, 2, 3, 4}), "581 60 65 60 00 00 00 00 00");
  EXPECT_EQ(value(0x6065), 0x04030201U);
}

TEST_F(SdoServerTest, TakesTheLengthFromTheObjectWhereTheClientDoesNotTell) {
  boot();
  EXPECT_EQ(sdo({0x22, 0x40, 0x60, 0x00, 0x0F, 0x01, 0xEE, 0xEE}), "581 60 40 60 00 00 00 00 00");
  EXPECT_EQ(value(0x6040), 0x010FU);
}

TEST_F(SdoServerTest, RefusesWithTheCodesOfTheStandard) {
  boot();
  EXPECT_EQ(sdo({0x40, 0x99, 0x99, 0x00, 0, 0, 0, 0}), "581 80 99 99 00 00 00 02 06");
  EXPECT_EQ(sdo({0x40, 0x16, 0x10, 0x03, 0, 0, 0, 0}), "581 80 16 10 03 11 00 09 06");
  EXPECT_EQ(sdo({0x2B, 0x41, 0x60, 0x00, 1, 0, 0, 0}), "581 80 41 60 00 02 00 01 06");
  EXPECT_EQ(sdo({0x23, 0x40, 0x60, 0x00, 1, 0, 0, 0}), "581 80 40 60 00 12 00 07 06");
  EXPECT_EQ(sdo({0x2F, 0x40, 0x60, 0x00, 1, 0, 0, 0}), "581 80 40 60 00 13 00 07 06");
}

TEST_F(SdoServerTest, MayKnowOnlyOneCodeForWrongLengths) {
  behaviour.generic_length_abort = true;
  boot();
  EXPECT_EQ(sdo({0x23, 0x40, 0x60, 0x00, 1, 0, 0, 0}), "581 80 40 60 00 10 00 07 06");
  EXPECT_EQ(sdo({0x2F, 0x40, 0x60, 0x00, 1, 0, 0, 0}), "581 80 40 60 00 10 00 07 06");
}

class SegmentedSdoTest : public SdoServerTest {
 protected:
  SegmentedSdoTest() {
    Entry name;
    name.id = {0x2000, 1};
    name.type = DataType::visible_string;
    name.bytes = {'J', 'o', 'i', 'n', 't', 'M', 'o', 't', 'o', 'r'};
    dictionary.add(name);
  }
  std::string text() {
    const Entry& entry = *dictionary.find({0x2000, 1});
    return std::string(entry.bytes.begin(), entry.bytes.end());
  }
};

TEST_F(SegmentedSdoTest, UploadsTenBytesInTwoSegments) {
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}), "581 41 00 20 01 0A 00 00 00");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 00 4A 6F 69 6E 74 4D 6F");
  EXPECT_EQ(sdo({0x70, 0, 0, 0, 0, 0, 0, 0}), "581 19 74 6F 72 00 00 00 00");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 80 00 20 01 01 00 04 05");
}

TEST_F(SegmentedSdoTest, UploadsExactlySevenBytesInOneFullSegment) {
  dictionary.find({0x2000, 1})->initial_bytes = {'1', '2', '3', '4', '5', '6', '7'};
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}), "581 41 00 20 01 07 00 00 00");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 01 31 32 33 34 35 36 37");
}

TEST_F(SegmentedSdoTest, UploadsAnEmptyStringAsAnEmptySegment) {
  dictionary.find({0x2000, 1})->initial_bytes.clear();
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}), "581 41 00 20 01 00 00 00 00");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 0F 00 00 00 00 00 00 00");
}

TEST_F(SegmentedSdoTest, MayKeepTheSizeToItself) {
  behaviour.upload_without_size = true;
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}), "581 40 00 20 01 00 00 00 00");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 00 4A 6F 69 6E 74 4D 6F");
  EXPECT_EQ(sdo({0x40, 0x16, 0x10, 0x00, 0, 0, 0, 0}), "581 42 16 10 00 02 00 00 00");
}

TEST_F(SegmentedSdoTest, DownloadsWithAndWithoutAnAnnouncedSize) {
  boot();
  EXPECT_EQ(sdo({0x21, 0x00, 0x20, 0x01, 0x09, 0, 0, 0}), "581 60 00 20 01 00 00 00 00");
  EXPECT_EQ(sdo({0x00, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), "581 20 00 00 00 00 00 00 00");
  EXPECT_EQ(text(), "JointMotor");
  EXPECT_EQ(sdo({0x1B, 'h', 'i', 0, 0, 0, 0, 0}), "581 30 00 00 00 00 00 00 00");
  EXPECT_EQ(text(), "abcdefghi");
  EXPECT_EQ(sdo({0x20, 0x00, 0x20, 0x01, 0, 0, 0, 0}), "581 60 00 20 01 00 00 00 00");
  EXPECT_EQ(sdo({0x0D, 'x', 0, 0, 0, 0, 0, 0}), "581 20 00 00 00 00 00 00 00");
  EXPECT_EQ(text(), "x");
}

TEST_F(SegmentedSdoTest, DownloadsANumberInASegment) {
  boot();
  EXPECT_EQ(sdo({0x21, 0x65, 0x60, 0x00, 0x04, 0, 0, 0}), "581 60 65 60 00 00 00 00 00");
  EXPECT_EQ(sdo({0x07, 1, 2, 3, 4, 0, 0, 0}), "581 20 00 00 00 00 00 00 00");
  EXPECT_EQ(value(0x6065), 0x04030201U);
}

TEST_F(SegmentedSdoTest, RefusesAtOnceWhatItWillNotTake) {
  boot();
  EXPECT_EQ(sdo({0x21, 0x41, 0x60, 0x00, 2, 0, 0, 0}), "581 80 41 60 00 02 00 01 06");
  EXPECT_EQ(sdo({0x21, 0x65, 0x60, 0x00, 8, 0, 0, 0}), "581 80 65 60 00 12 00 07 06");
  EXPECT_EQ(sdo({0x21, 0x00, 0x20, 0x01, 0, 0, 0, 0x7F}), "581 80 00 20 01 05 00 04 05");
}

TEST_F(SegmentedSdoTest, RefusesOtherLengthsThanAnnounced) {
  boot();
  sdo({0x21, 0x00, 0x20, 0x01, 0x08, 0, 0, 0});
  EXPECT_EQ(sdo({0x01, 1, 2, 3, 4, 5, 6, 7}), "581 80 00 20 01 13 00 07 06");
  sdo({0x21, 0x00, 0x20, 0x01, 0x06, 0, 0, 0});
  EXPECT_EQ(sdo({0x00, 1, 2, 3, 4, 5, 6, 7}), "581 80 00 20 01 12 00 07 06");
  EXPECT_EQ(text(), "JointMotor");
}

TEST_F(SegmentedSdoTest, AbortsOnAToggleBitThatDoesNotAlternate) {
  boot();
  sdo({0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  EXPECT_EQ(sdo({0x70, 0, 0, 0, 0, 0, 0, 0}), "581 80 00 20 01 00 00 03 05");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 80 00 20 01 01 00 04 05");
  sdo({0x20, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  sdo({0x00, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(sdo({0x01, 1, 2, 3, 4, 5, 6, 7}), "581 80 00 20 01 00 00 03 05");
  EXPECT_EQ(text(), "JointMotor");
}

TEST_F(SegmentedSdoTest, AClientAbortEndsTheTransferWithoutAnAnswer) {
  boot();
  sdo({0x20, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  EXPECT_EQ(sdo({0x80, 0x00, 0x20, 0x01, 0x00, 0x00, 0x04, 0x05}), "none");
  EXPECT_EQ(sdo({0x0D, 'x', 0, 0, 0, 0, 0, 0}), "581 80 00 20 01 01 00 04 05");
  EXPECT_EQ(text(), "JointMotor");
}

TEST_F(SegmentedSdoTest, ANewInitiateReplacesTheTransferInProgress) {
  boot();
  sdo({0x20, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  sdo({0x00, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(sdo({0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}), "581 41 00 20 01 0A 00 00 00");
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), "581 00 4A 6F 69 6E 74 4D 6F");
}

TEST_F(SdoServerTest, RefusesUnknownCommandsAndBlockTransferWhereItHasNone) {
  behaviour.sdo_block = false;
  boot();
  EXPECT_EQ(sdo({0xA4, 0x00, 0x10, 0x00, 0x7F, 0, 0, 0}), "581 80 00 10 00 01 00 04 05");
  EXPECT_EQ(sdo({0xC2, 0x17, 0x10, 0x00, 2, 0, 0, 0}), "581 80 17 10 00 01 00 04 05");
  EXPECT_EQ(sdo({0xE0, 0x17, 0x10, 0x00, 0, 0, 0, 0}), "581 80 17 10 00 01 00 04 05");
}

TEST_F(SdoServerTest, WorksInPreOperationalAndOperationalOnly) {
  operate();
  EXPECT_NE(sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), "none");
  send(0x000, {0x02, 0x01});
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), "none");
}

TEST_F(SdoServerTest, IgnoresShortRequestsUnlessItIsOneOfThose) {
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0x00}), "none");
  device.behaviour().accepts_short_sdo = true;
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0x00}), "581 43 00 10 00 92 01 02 00");
}

TEST_F(SdoServerTest, AnswersEachRequestAfterTheLatencyInOrder) {
  behaviour.sdo_latency = microseconds(300);
  boot();
  send(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  send(0x601, {0x40, 0x16, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(device.nextEvent(), now + microseconds(300));
  run(microseconds(299));
  EXPECT_THAT(sent(), IsEmpty());
  run(microseconds(1));
  EXPECT_THAT(sent(), ElementsAre("581 43 00 10 00 92 01 02 00"));
  run(microseconds(300));
  EXPECT_THAT(sent(), ElementsAre("581 4F 16 10 00 02 00 00 00"));
}

TEST_F(SdoServerTest, ASilentServerNeverAnswers) {
  behaviour.sdo_silent = true;
  boot();
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), "none");
}

TEST_F(SdoServerTest, DropsWhatWaitsWhenStopped) {
  behaviour.sdo_latency = milliseconds(1);
  boot();
  send(0x601, {0x2B, 0x40, 0x60, 0x00, 0x06, 0x00, 0, 0});
  send(0x000, {0x02, 0x01});
  run(milliseconds(5));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(value(0x6040), 0U);
}

// Requests of a Damiao DM motor, node 1 (fact sheet, section 4.5).
struct DamiaoRequest {
  const char* name;
  std::uint8_t bytes[8];
  std::uint16_t index;
  std::uint8_t sub;
  DataType type;
  std::uint64_t number;
};

class DamiaoRequestTest : public SdoServerTest,
                          public testing::WithParamInterface<DamiaoRequest> {};

TEST_P(DamiaoRequestTest, IsTakenAndConfirmed) {
  const DamiaoRequest& request = GetParam();
  add(request.index, request.sub, request.type, Access::rw, 0x11);
  boot();
  can::Frame frame(0x601, {});
  frame.size = 8;
  std::copy(std::begin(request.bytes), std::end(request.bytes), frame.data.begin());
  device.receive(frame, now);
  char answer[40];
  std::snprintf(answer, sizeof(answer), "581 60 %02X %02X %02X 00 00 00 00", request.bytes[1],
                request.bytes[2], request.bytes[3]);
  EXPECT_EQ(sent().at(0), answer);
  EXPECT_EQ(value(request.index, request.sub), request.number);
}

constexpr DataType kU8 = DataType::uint8, kU16 = DataType::uint16, kI16 = DataType::int16,
                   kI32 = DataType::int32, kU32 = DataType::uint32;
INSTANTIATE_TEST_SUITE_P(
    FactSheet, DamiaoRequestTest,
    testing::Values(
        DamiaoRequest{"mode1", {0x2B, 0x60, 0x60, 0, 1, 0, 0, 0}, 0x6060, 0, kU16, 1},
        DamiaoRequest{"mode2", {0x2B, 0x60, 0x60, 0, 2, 0, 0, 0}, 0x6060, 0, kU16, 2},
        DamiaoRequest{"mode4", {0x2B, 0x60, 0x60, 0, 4, 0, 0, 0}, 0x6060, 0, kU16, 4},
        DamiaoRequest{"mode6", {0x2B, 0x60, 0x60, 0, 6, 0, 0, 0}, 0x6060, 0, kU16, 6},
        DamiaoRequest{"shutdown", {0x2B, 0x40, 0x60, 0, 6, 0, 0, 0}, 0x6040, 0, kU16, 6},
        DamiaoRequest{"switch_on", {0x2B, 0x40, 0x60, 0, 7, 0, 0, 0}, 0x6040, 0, kU16, 7},
        DamiaoRequest{"enable", {0x2B, 0x40, 0x60, 0, 0xF, 0, 0, 0}, 0x6040, 0, kU16, 15},
        DamiaoRequest{"quick_stop", {0x2B, 0x40, 0x60, 0, 2, 0, 0, 0}, 0x6040, 0, kU16, 2},
        DamiaoRequest{"reset", {0x2B, 0x40, 0x60, 0, 0x80, 0, 0, 0}, 0x6040, 0, kU16, 128},
        DamiaoRequest{"one", {0x23, 0x7A, 0x60, 0, 0, 0, 0x80, 0x3F}, 0x607A, 0, kI32, 0x3F800000},
        DamiaoRequest{
            "minus_pi", {0x23, 0x7A, 0x60, 0, 0xDB, 0x0F, 0x49, 0xC0}, 0x607A, 0, kI32, 0xC0490FDB},
        DamiaoRequest{"ten", {0x23, 0xFF, 0x60, 0, 0, 0, 0x20, 0x41}, 0x60FF, 0, kI32, 0x41200000},
        DamiaoRequest{
            "minus_half", {0x23, 0xFF, 0x60, 0, 0, 0, 0, 0xBF}, 0x60FF, 0, kI32, 0xBF000000},
        DamiaoRequest{
            "torque32", {0x23, 0x71, 0x60, 0, 0x9A, 0x99, 0x99, 0x3E}, 0x6071, 0, kI32, 0x3E99999A},
        DamiaoRequest{"torque16", {0x2B, 0x71, 0x60, 0, 0x99, 0x3E, 0, 0}, 0x6071, 0, kI16, 0x3E99},
        DamiaoRequest{
            "acceleration", {0x23, 0x83, 0x60, 0, 0, 0, 0xA0, 0x41}, 0x6083, 0, kU32, 0x41A00000},
        DamiaoRequest{
            "deceleration", {0x23, 0x84, 0x60, 0, 0, 0, 0xA0, 0x41}, 0x6084, 0, kU32, 0x41A00000},
        DamiaoRequest{
            "stop_ramp", {0x23, 0x85, 0x60, 0, 0, 0x40, 0x1C, 0x46}, 0x6085, 0, kU32, 0x461C4000},
        DamiaoRequest{"option", {0x2B, 0x5A, 0x60, 0, 1, 0, 0, 0}, 0x605A, 0, kI16, 1},
        DamiaoRequest{"profile", {0x2B, 0x86, 0x60, 0, 1, 0, 0, 0}, 0x6086, 0, kI16, 1},
        DamiaoRequest{"no_counter", {0x2F, 0x19, 0x10, 0, 0, 0, 0, 0}, 0x1019, 0, kU8, 0},
        DamiaoRequest{"behaviour", {0x2F, 0x29, 0x10, 1, 0, 0, 0, 0}, 0x1029, 1, kU8, 0},
        DamiaoRequest{"heartbeat", {0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0}, 0x1017, 0, kU16, 100},
        DamiaoRequest{
            "consumer", {0x23, 0x16, 0x10, 1, 0xE8, 0x03, 0x7F, 0}, 0x1016, 1, kU32, 0x007F03E8}),
    [](const auto& request) { return std::string(request.param.name); });

}  // namespace
}  // namespace cia402::sim
