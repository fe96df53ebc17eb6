// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// LSS and TIME in words.
#include <array>
#include <cstdio>

#include "common/text.h"
#include "decode/frame_decoder.h"

namespace cia402::decode {
namespace {

using can::Frame;

std::uint32_t longAt(const Frame& frame, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4 && at + i < frame.data.size(); ++i) {
    value |= static_cast<std::uint32_t>(frame.data[at + i]) << (8 * i);
  }
  return value;
}

/// What follows the command specifier.
enum class Argument : std::uint8_t { none, mode, number, node, timing, delay, scan, error };

/// Command specifiers of CiA 305, in the words of the standard.
struct Row {
  std::uint8_t command;
  const char* name;
  Argument request, answer;
};
constexpr Row kRows[] = {
    {0x04, "switch state global", Argument::mode, Argument::none},
    {0x11, "configure node-ID", Argument::node, Argument::error},
    {0x13, "configure bit timing", Argument::timing, Argument::error},
    {0x15, "activate bit timing", Argument::delay, Argument::none},
    {0x17, "store configuration", Argument::none, Argument::error},
    {0x40, "switch state selective, vendor id", Argument::number, Argument::none},
    {0x41, "switch state selective, product code", Argument::number, Argument::none},
    {0x42, "switch state selective, revision", Argument::number, Argument::none},
    {0x43, "switch state selective, serial number", Argument::number, Argument::none},
    {0x44, "selected", Argument::none, Argument::none},
    {0x46, "identify, vendor id", Argument::number, Argument::none},
    {0x47, "identify, product code", Argument::number, Argument::none},
    {0x48, "identify, revision from", Argument::number, Argument::none},
    {0x49, "identify, revision to", Argument::number, Argument::none},
    {0x4A, "identify, serial number from", Argument::number, Argument::none},
    {0x4B, "identify, serial number to", Argument::number, Argument::none},
    {0x4C, "identify non-configured", Argument::none, Argument::none},
    {0x4F, "identified", Argument::none, Argument::none},
    {0x50, "identified as non-configured", Argument::none, Argument::none},
    {0x51, "fastscan", Argument::scan, Argument::none},
    {0x5A, "inquire vendor id", Argument::none, Argument::number},
    {0x5B, "inquire product code", Argument::none, Argument::number},
    {0x5C, "inquire revision", Argument::none, Argument::number},
    {0x5D, "inquire serial number", Argument::none, Argument::number},
    {0x5E, "inquire node-ID", Argument::none, Argument::node},
};

constexpr const char* kBitRates[] = {"1000 kbit/s", "800 kbit/s", "500 kbit/s",
                                     "250 kbit/s",  "125 kbit/s", "reserved",
                                     "50 kbit/s",   "20 kbit/s",  "10 kbit/s"};

std::string nodeText(std::uint8_t id) {
  return id == 0xFF ? " 255 (not configured)" : " " + std::to_string(id);
}

std::string timingText(const Frame& frame) {
  const unsigned index = frame.data[2];
  if (frame.data[1] != 0 || index >= sizeof kBitRates / sizeof *kBitRates) {
    return " table " + std::to_string(frame.data[1]) + ", index " + std::to_string(index);
  }
  return std::string(" ") + kBitRates[index];
}

/// Fastscan: number, bit to be checked (128: is there anybody?), part of the identity now, and
/// next.
std::string scanText(const Frame& frame) {
  if (frame.data[5] == 0x80) return ": is there a non-configured device?";
  static constexpr const char* kParts[] = {"vendor id", "product code", "revision",
                                           "serial number"};
  return std::string(": ") + kParts[frame.data[6] & 3U] + " " + hexText(longAt(frame, 1), 8) +
         " from bit " + std::to_string(frame.data[5]) + " up, next " + kParts[frame.data[7] & 3U];
}

std::string argumentText(Argument argument, const Frame& frame) {
  switch (argument) {
    case Argument::none:
      return "";
    case Argument::mode:
      return frame.data[1] == 0 ? " to waiting" : " to configuration";
    case Argument::number:
      return " " + hexText(longAt(frame, 1), 8);
    case Argument::node:
      return nodeText(frame.data[1]);
    case Argument::timing:
      return timingText(frame);
    case Argument::delay:
      return " in " + std::to_string(frame.data[1] | frame.data[2] << 8) + " ms";
    case Argument::scan:
      return scanText(frame);
    case Argument::error:
      break;
  }
  if (frame.data[1] == 0) return ": done";
  return ": error " + std::to_string(frame.data[1]) +
         (frame.data[1] == 0xFF ? ", specific " + std::to_string(frame.data[2]) : "");
}

}  // namespace

std::string lssText(const Frame& frame, bool from_master) {
  if (frame.size == 0) return "empty";
  for (const Row& row : kRows) {
    if (row.command != frame.data[0]) continue;
    return row.name + argumentText(from_master ? row.request : row.answer, frame);
  }
  return "unknown command " + hexText(frame.data[0], 2);
}

std::string timeText(const Frame& frame) {
  if (frame.size < 6) return "too short";
  const std::uint32_t milliseconds = longAt(frame, 0) & 0x0FFFFFFF;
  const int days = frame.data[4] | frame.data[5] << 8;
  // Days since 1984-01-01 to a date (civil calendar, era of 400 years that begins on 1 March 1600).
  const int from_era = days + 140'193;  // 1984-01-01 is so many days after 1600-03-01
  const int era = from_era / 146'097, day_of_era = from_era % 146'097;
  const int year_of_era =
      (day_of_era - day_of_era / 1460 + day_of_era / 36'524 - day_of_era / 146'096) / 365;
  const int day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  const int month_index = (5 * day_of_year + 2) / 153;  // from March
  const int day = day_of_year - (153 * month_index + 2) / 5 + 1;
  const int month = month_index < 10 ? month_index + 3 : month_index - 9;
  const int year = 1600 + 400 * era + year_of_era + (month <= 2 ? 1 : 0);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02d-%02d %02u:%02u:%02u.%03u", year, month, day,
                milliseconds / 3'600'000, milliseconds / 60'000 % 60, milliseconds / 1000 % 60,
                milliseconds % 1000);
  return text.data();
}

}  // namespace cia402::decode
