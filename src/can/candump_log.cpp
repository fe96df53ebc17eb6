// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/candump_log.h"

#include <cstdint>
#include <cstdio>
#include <istream>
#include <ostream>

namespace cia402::can {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;  // CAN_ERR_FLAG
constexpr std::size_t kLongestQuote = 40;

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

bool isDigit(char c) { return c >= '0' && c <= '9'; }

int hexDigit(char c) {
  if (isDigit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string_view nextWord(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && isBlank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !isBlank(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

// A piece of the log for a message: short, and without control characters.
std::string quote(std::string_view text) {
  std::string quoted = "\"";
  for (char c : text.substr(0, kLongestQuote)) quoted += c >= ' ' && c <= '~' ? c : '?';
  return quoted + (text.size() > kLongestQuote ? "...\"" : "\"");
}

Result<std::chrono::nanoseconds> parseStamp(std::string_view word) {
  const Error wrong{"time stamp " + quote(word) + " is not like (1700000000.123456)"};
  if (word.size() < 3 || word.front() != '(' || word.back() != ')') return wrong;
  word = word.substr(1, word.size() - 2);
  const std::size_t point = word.find('.');
  const std::string_view seconds = word.substr(0, point);
  const std::string_view fraction =
      point == std::string_view::npos ? std::string_view{} : word.substr(point + 1);
  if (seconds.empty() || seconds.size() > 10 || fraction.size() > 9) return wrong;
  if (point != std::string_view::npos && fraction.empty()) return wrong;
  // At most nine decimals and 10^10 seconds: 10^19 would not fit, 9.2 * 10^18 does.
  std::int64_t count = 0;
  for (char c : seconds) {
    if (!isDigit(c)) return wrong;
    count = count * 10 + (c - '0');
  }
  if (count > 9'000'000'000) return wrong;
  for (std::size_t i = 0; i < 9; ++i) {
    if (i < fraction.size() && !isDigit(fraction[i])) return wrong;
    count = count * 10 + (i < fraction.size() ? fraction[i] - '0' : 0);
  }
  return std::chrono::nanoseconds(count);
}

Result<Frame> parseIdentifier(std::string_view word) {
  if (word.size() != 3 && word.size() != 8) {
    return Error{"identifier " + quote(word) + " has neither 3 nor 8 hexadecimal digits"};
  }
  std::uint32_t id = 0;
  for (char c : word) {
    const int digit = hexDigit(c);
    if (digit < 0) return Error{"identifier " + quote(word) + " is not hexadecimal"};
    id = id << 4 | static_cast<std::uint32_t>(digit);
  }
  Frame frame;
  frame.error = word.size() == 8 && (id & kErrorFlag) != 0;
  frame.extended = word.size() == 8 && !frame.error;
  frame.id = frame.error ? id & ~kErrorFlag : id;
  if (frame.id > (word.size() == 8 ? 0x1FFFFFFFU : 0x7FFU)) {
    return Error{"identifier " + quote(word) + " is greater than " +
                 (word.size() == 8 ? "1FFFFFFF" : "7FF")};
  }
  return frame;
}

// The raw data length code 9..15 of some controllers after `_`; it tells nothing about the data.
bool isLengthSuffix(std::string_view text) {
  return text.empty() || (text.size() == 2 && text[0] == '_' && hexDigit(text[1]) > 8);
}

Result<Frame> parseRemote(Frame frame, std::string_view length) {
  frame.remote = true;
  if (!length.empty() && length[0] >= '0' && length[0] <= '8') {
    frame.size = static_cast<std::uint8_t>(length[0] - '0');
    length.remove_prefix(1);
  }
  if (!isLengthSuffix(length))
    return Error{"remote frame length " + quote(length) + " is not 0..8"};
  return frame;
}

Result<Frame> parseData(Frame frame, std::string_view text) {
  const std::string_view all = text;
  while (!text.empty() && text[0] != '_') {
    if (text[0] == '.' && frame.size > 0) text.remove_prefix(1);
    const int high = text.empty() ? -1 : hexDigit(text[0]);
    const int low = text.size() < 2 ? -1 : hexDigit(text[1]);
    if (high < 0 || low < 0)
      return Error{"data " + quote(all) + " are not pairs of hexadecimal digits"};
    if (frame.size == frame.data.size())
      return Error{"data " + quote(all) + " are more than 8 bytes"};
    frame.data[frame.size++] = static_cast<std::uint8_t>(high << 4 | low);
    text.remove_prefix(2);
  }
  if (!isLengthSuffix(text)) return Error{"length suffix " + quote(text) + " is not _9.._F"};
  return frame;
}

Result<Frame> parseFrame(std::string_view word) {
  const std::size_t hash = word.find('#');
  if (hash == std::string_view::npos) return Error{"frame " + quote(word) + " has no '#'"};
  const std::string_view content = word.substr(hash + 1);
  if (!content.empty() && content[0] == '#') {
    return Error{"frame " + quote(word) + " is a CAN FD frame; only classic CAN is supported"};
  }
  Result<Frame> frame = parseIdentifier(word.substr(0, hash));
  if (!frame) return frame;
  const bool remote = !content.empty() && (content[0] == 'R' || content[0] == 'r');
  return remote ? parseRemote(*frame, content.substr(1)) : parseData(*frame, content);
}

}  // namespace

std::string formatLogLine(const LogEntry& entry) {
  const std::int64_t microseconds = entry.stamp.count() / 1000;
  const Frame& frame = entry.frame;
  char text[48];
  std::snprintf(text, sizeof text, "(%010lld.%06lld) ",
                static_cast<long long>(microseconds / 1'000'000),
                static_cast<long long>(microseconds % 1'000'000));
  std::string line = text + entry.interface;
  const bool long_id = frame.extended || frame.error;
  std::snprintf(text, sizeof text, long_id ? " %08X#" : " %03X#",
                static_cast<unsigned>(frame.id | (frame.error ? kErrorFlag : 0U)));
  line += text;
  if (frame.remote) {
    line += 'R';
    if (frame.size > 0) line += static_cast<char>('0' + (frame.size > 8 ? 8 : frame.size));
  } else {
    for (std::size_t i = 0; i < frame.size && i < frame.data.size(); ++i) {
      std::snprintf(text, sizeof text, "%02X", static_cast<unsigned>(frame.data[i]));
      line += text;
    }
  }
  if (entry.direction == Direction::received) line += " R";
  if (entry.direction == Direction::transmitted) line += " T";
  return line;
}

Result<LogEntry> parseLogLine(std::string_view line) {
  LogEntry entry;
  std::string_view rest = line;
  const auto stamp = parseStamp(nextWord(rest));
  if (!stamp) return stamp.error();
  entry.stamp = *stamp;
  entry.interface = std::string(nextWord(rest));
  const std::string_view frame_word = nextWord(rest);
  if (frame_word.empty()) return Error{"no frame after the interface " + quote(entry.interface)};
  const auto frame = parseFrame(frame_word);
  if (!frame) return frame.error();
  entry.frame = *frame;
  const std::string_view direction = nextWord(rest);
  if (direction == "R") {
    entry.direction = Direction::received;
  } else if (direction == "T") {
    entry.direction = Direction::transmitted;
  } else if (!direction.empty()) {
    return Error{quote(direction) + " after the frame is neither R nor T"};
  }
  const std::string_view surplus = nextWord(rest);
  if (!surplus.empty())
    return Error{"nothing may follow the direction, but " + quote(surplus) + " does"};
  return entry;
}

bool LogWriter::write(const LogEntry& entry) {
  out_ << formatLogLine(entry) << '\n';
  return out_.good();
}

std::optional<Result<LogEntry>> LogReader::next() {
  std::string line;
  while (std::getline(in_, line)) {
    ++line_;
    std::string_view rest = line;
    const std::string_view first = nextWord(rest);
    if (first.empty() || first[0] == '#') continue;
    auto entry = parseLogLine(line);
    if (!entry) return Error{"line " + std::to_string(line_) + ": " + entry.error().message};
    return entry;
  }
  return std::nullopt;
}

}  // namespace cia402::can
