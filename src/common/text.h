// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Numbers and lists in sentences.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402 {

/// Adds to a list in a sentence.
void append(std::string& list, std::string_view item, std::string_view separator = "; ");
/// All of a list: "a; b".
std::string joined(const std::vector<std::string>& items, std::string_view separator = "; ");

/// "0x0237": a number in at least so many hexadecimal digits.
std::string hexText(std::uint64_t value, int digits);
/// "08 2A": bytes in hexadecimal; empty where there is none.
std::string hexBytes(const std::uint8_t* bytes, std::size_t count);

/// "0.25", "1e+06": of a number as many of `digits` significant digits as it takes.
std::string numberText(double value, int digits = 6);
/// The same in seconds: "0.25 s", "150 s".
std::string secondsText(Duration duration);
/// "0.250 s".
std::string secondsText(Duration duration, int decimals);
/// "4 ms", "1.25 ms": as many of `digits` significant digits as it takes.
std::string millisecondsText(Duration duration, int digits = 6);
/// "85 %", "87.5 %": a share of 1, rounded to so many decimals, without zeros at the end.
std::string percentText(double share, int decimals = 0);

}  // namespace cia402
