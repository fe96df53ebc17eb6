// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/candump_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <sstream>

namespace cia402::can {
namespace {

using ::testing::HasSubstr;

LogEntry entryOf(const Frame& frame) {
  LogEntry entry;
  entry.stamp = std::chrono::nanoseconds(1'700'000'000'123'456'789);
  entry.interface = "can0";
  entry.frame = frame;
  return entry;
}

Frame extended(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  Frame frame(id, bytes);
  frame.extended = true;
  return frame;
}

Frame remote(std::uint32_t id, std::uint8_t length) {
  Frame frame(id, {});
  frame.remote = true;
  frame.size = length;
  return frame;
}

Frame errorFrame(std::uint32_t classes) {
  Frame frame(classes, {0, 0x20, 0, 0, 0, 0, 0x80, 0});
  frame.error = true;
  return frame;
}

Frame parsed(const std::string& frame) {
  const auto entry = parseLogLine("(1.0) can0 " + frame);
  EXPECT_TRUE(entry.ok()) << frame;
  return entry ? entry->frame : Frame();
}

std::string reason(const std::string& line) {
  const auto entry = parseLogLine(line);
  return entry ? "accepted" : entry.error().message;
}

TEST(FormatLogLine, WritesWhatCandumpWrites) {
  EXPECT_EQ(formatLogLine(entryOf(Frame(0x123, {0xDE, 0xAD, 0xBE, 0xEF}))),
            "(1700000000.123456) can0 123#DEADBEEF");
  EXPECT_EQ(formatLogLine(entryOf(Frame(0x080, {}))), "(1700000000.123456) can0 080#");
  EXPECT_EQ(formatLogLine(entryOf(extended(0x1ABCDEF, {1}))),
            "(1700000000.123456) can0 01ABCDEF#01");
  EXPECT_EQ(formatLogLine(entryOf(remote(0x701, 0))), "(1700000000.123456) can0 701#R");
  EXPECT_EQ(formatLogLine(entryOf(remote(0x701, 3))), "(1700000000.123456) can0 701#R3");
  EXPECT_EQ(formatLogLine(entryOf(errorFrame(0x204))),
            "(1700000000.123456) can0 20000204#0020000000008000");
}

TEST(FormatLogLine, PadsTheTimeAndAppendsAKnownDirection) {
  LogEntry entry = entryOf(Frame(0x7FF, {}));
  entry.stamp = std::chrono::microseconds(42);
  entry.direction = Direction::transmitted;
  EXPECT_EQ(formatLogLine(entry), "(0000000000.000042) can0 7FF# T");
  entry.direction = Direction::received;
  EXPECT_EQ(formatLogLine(entry), "(0000000000.000042) can0 7FF# R");
}

TEST(ParseLogLine, ReadsEveryField) {
  const auto entry = parseLogLine("(1700000000.123456) vcan0 123#DEADBEEF");
  ASSERT_TRUE(entry.ok()) << entry.error().message;
  EXPECT_EQ(entry->stamp, std::chrono::nanoseconds(1'700'000'000'123'456'000));
  EXPECT_EQ(entry->interface, "vcan0");
  EXPECT_EQ(entry->frame, Frame(0x123, {0xDE, 0xAD, 0xBE, 0xEF}));
  EXPECT_EQ(entry->direction, Direction::unknown);
}

TEST(ParseLogLine, ReadsEveryKindOfFrame) {
  EXPECT_EQ(parsed("080#"), Frame(0x080, {}));
  EXPECT_EQ(parsed("00000080#"), extended(0x80, {}));
  EXPECT_EQ(parsed("1FFFFFFF#0011223344556677"),
            extended(0x1FFFFFFF, {0x00, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77}));
  EXPECT_EQ(parsed("701#R"), remote(0x701, 0));
  EXPECT_EQ(parsed("701#R8"), remote(0x701, 8));
  EXPECT_EQ(parsed("20000204#0020000000008000"), errorFrame(0x204));
  EXPECT_EQ(parsed("5a1#aB.Cd"), Frame(0x5A1, {0xAB, 0xCD}));
  EXPECT_EQ(parsed("123#0102030405060708_F").size, 8);
}

TEST(ParseLogLine, ToleratesWhatOtherToolsLeave) {
  const auto carriage_return = parseLogLine("(1.5) can0 123#01\r");
  ASSERT_TRUE(carriage_return.ok());
  EXPECT_EQ(carriage_return->stamp, std::chrono::milliseconds(1500));
  const auto sent = parseLogLine("  (1)   can0\t123#01  T\r\n");
  ASSERT_TRUE(sent.ok());
  EXPECT_EQ(sent->direction, Direction::transmitted);
  EXPECT_EQ(sent->stamp, std::chrono::seconds(1));
  const auto nanoseconds = parseLogLine("(1.000000001) can0 123#01 R");
  ASSERT_TRUE(nanoseconds.ok());
  EXPECT_EQ(nanoseconds->stamp, std::chrono::nanoseconds(1'000'000'001));
  EXPECT_EQ(nanoseconds->direction, Direction::received);
}

TEST(ParseLogLine, SaysWhatIsWrong) {
  EXPECT_THAT(reason(""), HasSubstr("time stamp \"\""));
  EXPECT_THAT(reason("1.0 can0 123#"), HasSubstr("time stamp \"1.0\""));
  EXPECT_THAT(reason("(1.x) can0 123#"), HasSubstr("time stamp"));
  EXPECT_THAT(reason("(.1) can0 123#"), HasSubstr("time stamp"));
  EXPECT_THAT(reason("(1.) can0 123#"), HasSubstr("time stamp"));
  EXPECT_THAT(reason("(99999999999.0) can0 123#"), HasSubstr("time stamp"));
  EXPECT_THAT(reason("(9999999999.0) can0 123#"), HasSubstr("time stamp"));
  EXPECT_THAT(reason("(1.0)"), HasSubstr("no frame"));
  EXPECT_THAT(reason("(1.0) can0"), HasSubstr("no frame"));
  EXPECT_THAT(reason("(1.0) can0 123"), HasSubstr("has no '#'"));
  EXPECT_THAT(reason("(1.0) can0 12#"), HasSubstr("neither 3 nor 8"));
  EXPECT_THAT(reason("(1.0) can0 #"), HasSubstr("neither 3 nor 8"));
  EXPECT_THAT(reason("(1.0) can0 12G#"), HasSubstr("\"12G\" is not hexadecimal"));
  EXPECT_THAT(reason("(1.0) can0 800#"), HasSubstr("greater than 7FF"));
  EXPECT_THAT(reason("(1.0) can0 80000000#"), HasSubstr("greater than 1FFFFFFF"));
  EXPECT_THAT(reason("(1.0) can0 123#1"), HasSubstr("pairs of hexadecimal digits"));
  EXPECT_THAT(reason("(1.0) can0 123#0x"), HasSubstr("pairs of hexadecimal digits"));
  EXPECT_THAT(reason("(1.0) can0 123#01."), HasSubstr("pairs of hexadecimal digits"));
  EXPECT_THAT(reason("(1.0) can0 123#000102030405060708"), HasSubstr("more than 8 bytes"));
  EXPECT_THAT(reason("(1.0) can0 123#R9"), HasSubstr("remote frame length \"9\""));
  EXPECT_THAT(reason("(1.0) can0 123#R10"), HasSubstr("remote frame length"));
  EXPECT_THAT(reason("(1.0) can0 123##101"), HasSubstr("CAN FD"));
  EXPECT_THAT(reason("(1.0) can0 123#01 X"), HasSubstr("neither R nor T"));
  EXPECT_THAT(reason("(1.0) can0 123#01 T T"), HasSubstr("nothing may follow"));
}

TEST(ParseLogLine, QuotesWithoutControlCharactersAndBriefly) {
  const std::string message = reason("(1.0) can0 \x1b[31m" + std::string(500, 'A') + "#");
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_LT(message.size(), 120u);
}

TEST(ParseLogLine, SurvivesEveryTruncationAndAnyByteInAnyPlace) {
  const std::string good = "(1700000000.123456) can0 1FFFFFFF#DEADBEEF T";
  for (std::size_t i = 0; i < good.size(); ++i) (void)parseLogLine(good.substr(0, i)).ok();
  std::mt19937 random(1);
  int accepted = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string line = good;
    for (int k = 0; k < 3; ++k) line[random() % line.size()] = static_cast<char>(random() & 0xFF);
    const auto entry = parseLogLine(line);
    if (!entry) continue;
    ++accepted;  // what was accepted is a frame that can be written and read again
    const auto again = parseLogLine(formatLogLine(*entry));
    ASSERT_TRUE(again.ok()) << line;
    ASSERT_EQ(again->frame, entry->frame) << line;
  }
  EXPECT_GT(accepted, 10);
}

TEST(LogReader, SkipsBlankLinesAndCommentsAndGoesOnAfterAnError) {
  std::istringstream in(
      "# recorded at the bench\n"
      "\r\n"
      "(1.0) can0 080#\r\n"
      "rubbish\n"
      "   \n"
      "(2.0) can0 701#05 R\n"
      "(3.0) can0 701#7F");
  LogReader reader(in);
  auto entry = reader.next();
  ASSERT_TRUE(entry && entry->ok());
  EXPECT_EQ((*entry)->frame, Frame(0x080, {}));
  EXPECT_EQ(reader.line(), 3u);
  entry = reader.next();
  ASSERT_TRUE(entry);
  ASSERT_FALSE(entry->ok());
  EXPECT_THAT(entry->error().message, HasSubstr("line 4: time stamp \"rubbish\""));
  entry = reader.next();
  ASSERT_TRUE(entry && entry->ok());
  EXPECT_EQ((*entry)->frame, Frame(0x701, {0x05}));
  entry = reader.next();
  ASSERT_TRUE(entry && entry->ok());
  EXPECT_EQ((*entry)->frame, Frame(0x701, {0x7F}));
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
}

TEST(LogWriter, WritesLinesThatTheReaderGivesBack) {
  std::stringstream log;
  LogWriter writer(log);
  EXPECT_TRUE(writer.write(entryOf(Frame(0x201, {0x0F, 0x00}))));
  EXPECT_TRUE(writer.write(entryOf(remote(0x701, 1))));
  EXPECT_EQ(log.str(), "(1700000000.123456) can0 201#0F00\n(1700000000.123456) can0 701#R1\n");
  log.setstate(std::ios::badbit);
  EXPECT_FALSE(writer.write(entryOf(Frame(0x201, {}))));
}

}  // namespace
}  // namespace cia402::can
