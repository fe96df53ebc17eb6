// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/statusword.h"

namespace cia402::sim {
namespace {

constexpr std::uint16_t kVoltageBit = 0x0010;
constexpr std::uint16_t kWarningBit = 0x0080;
constexpr std::uint16_t kRemoteBit = 0x0200;

std::uint16_t vendorBits(const DriveQuirks& quirks, Time now) {
  const std::uint64_t turn = static_cast<std::uint64_t>(now.time_since_epoch().count() / 10000000);
  return static_cast<std::uint16_t>((turn * 0x9E3779B97F4A7C15U >> 40U) & quirks.vendor_bits);
}

}  // namespace

std::uint16_t makeStatusword(const StatuswordParts& parts, const DriveQuirks& quirks, Time now) {
  std::uint16_t word = statusBits(parts.shown);
  if (parts.ready && parts.remote) word |= kRemoteBit;
  if (parts.ready && parts.voltage) word |= kVoltageBit;
  if (parts.warning) word |= kWarningBit;
  if (parts.shown == PdsState::fault) word |= quirks.fault_bits;
  word |= parts.of_mode;
  if (quirks.vendor_bits == 0) return word;
  return static_cast<std::uint16_t>((word & ~quirks.vendor_bits) | vendorBits(quirks, now));
}

}  // namespace cia402::sim
