// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "cia402_driver/common/time.h"

namespace cia402::fieldbus {

/// An emergency object (CiA 301, 7.2.7).
struct Emergency {
  std::uint16_t code = 0;           ///< 0x0000: error reset or no error
  std::uint8_t error_register = 0;  ///< object 1001h
  std::array<std::uint8_t, 5> vendor{};
  std::uint8_t size = kSize;  ///< bytes of the frame; what was missing is 0 here
  Time stamp{};

  static constexpr std::uint8_t kSize = 8;  ///< as the standard has it
};

/// The code by which a device tells that its outputs fail to come (CiA 301, table 26).
inline constexpr std::uint16_t kOutputsLate = 0x8250;

/// The error class of an emergency code in words, after CiA 301 table 26 and CiA 402 (most specific
/// first), e.g. "following error" for 0x8611, "current, device output side" for 0x23xx.
std::string emergencyText(std::uint16_t code);
/// Bits of object 1001h by name, e.g. "generic, voltage"; "none" for 0.
std::string errorRegisterText(std::uint8_t bits);
/// The manufacturer-specific bytes in hexadecimal, e.g. "12 00 00 00 00"; empty if all are 0.
std::string vendorBytesText(const Emergency& emergency);

}  // namespace cia402::fieldbus
