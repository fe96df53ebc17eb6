// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace cia402::fieldbus {

/// SDO abort codes of CiA 301, table 22, as far as the code needs them by name.
namespace abort_code {
inline constexpr std::uint32_t kToggleBit = 0x05030000;
inline constexpr std::uint32_t kTimeout = 0x05040000;
inline constexpr std::uint32_t kInvalidCommand = 0x05040001;
inline constexpr std::uint32_t kInvalidBlockSize = 0x05040002;
inline constexpr std::uint32_t kInvalidSequence = 0x05040003;
inline constexpr std::uint32_t kCrcError = 0x05040004;
inline constexpr std::uint32_t kOutOfMemory = 0x05040005;
inline constexpr std::uint32_t kUnsupportedAccess = 0x06010000;
inline constexpr std::uint32_t kWriteOnly = 0x06010001;
inline constexpr std::uint32_t kReadOnly = 0x06010002;
inline constexpr std::uint32_t kNoSuchObject = 0x06020000;
inline constexpr std::uint32_t kNotMappable = 0x06040041;
inline constexpr std::uint32_t kPdoLength = 0x06040042;
inline constexpr std::uint32_t kLengthMismatch = 0x06070010;
inline constexpr std::uint32_t kLengthTooHigh = 0x06070012;
inline constexpr std::uint32_t kLengthTooLow = 0x06070013;
inline constexpr std::uint32_t kNoSuchSubindex = 0x06090011;
inline constexpr std::uint32_t kInvalidValue = 0x06090030;
inline constexpr std::uint32_t kValueTooHigh = 0x06090031;
inline constexpr std::uint32_t kValueTooLow = 0x06090032;
inline constexpr std::uint32_t kNoConnection = 0x060A0023;
inline constexpr std::uint32_t kGeneral = 0x08000000;
inline constexpr std::uint32_t kCannotTransfer = 0x08000020;
inline constexpr std::uint32_t kLocalControl = 0x08000021;
inline constexpr std::uint32_t kDeviceState = 0x08000022;
inline constexpr std::uint32_t kNoData = 0x08000024;
/// It says that the object is not there, or is not for writing or mapping, whatever the value.
constexpr bool saysLacking(std::uint32_t code) {
  return code == kNoSuchObject || code == kNoSuchSubindex || code == kReadOnly ||
         code == kNotMappable;
}
/// It says that the object is not written now, or not by everybody, whatever the value.
constexpr bool saysForbidden(std::uint32_t code) {
  return code == kUnsupportedAccess || code == kReadOnly || code == kCannotTransfer ||
         code == kLocalControl || code == kDeviceState;
}
}  // namespace abort_code

/// The code with its meaning in words: "0x06010002 (attempt to write a read-only object)". Unknown
/// codes come as "0x... (abort code unknown to CiA 301)".
std::string abortText(std::uint32_t code);

}  // namespace cia402::fieldbus
