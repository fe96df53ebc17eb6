// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/protocol.h"

#include <cstdio>

namespace cia402::canopen::lss {
namespace {

can::Frame request(Command command, std::uint32_t number = 0, std::uint8_t fifth = 0,
                   std::uint8_t sixth = 0, std::uint8_t seventh = 0) {
  return can::Frame(
      kRequestId, {static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(number),
                   static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number >> 16),
                   static_cast<std::uint8_t>(number >> 24), fifth, sixth, seventh});
}

Command offset(Command first, std::size_t part) {
  return static_cast<Command>(static_cast<std::size_t>(first) + part);
}

struct ErrorRow {
  Command command;
  std::uint8_t code;
  const char* text;
};
// CiA 305: configure node-ID, configure bit timing parameters, store configuration.
constexpr ErrorRow kErrors[] = {
    {Command::configure_node_id, 1, "node-ID out of range"},
    {Command::configure_bit_timing, 1, "bit timing not supported"},
    {Command::store, 1, "the device cannot store its LSS settings"},
    {Command::store, 2, "the storage medium cannot be accessed"},
};

struct RateRow {
  unsigned kbit_per_s;
  std::uint8_t index;
};
constexpr RateRow kRates[] = {
    {1000, 0}, {800, 1}, {500, 2}, {250, 3}, {125, 4}, {50, 6}, {20, 7}, {10, 8},
};

}  // namespace

std::uint32_t Identity::part(std::size_t index) const {
  const std::uint32_t parts[kParts] = {vendor_id, product_code, revision, serial};
  return parts[index];
}

void Identity::setPart(std::size_t index, std::uint32_t value) {
  std::uint32_t* const parts[kParts] = {&vendor_id, &product_code, &revision, &serial};
  *parts[index] = value;
}

bool operator==(const Identity& a, const Identity& b) {
  return a.vendor_id == b.vendor_id && a.product_code == b.product_code &&
         a.revision == b.revision && a.serial == b.serial;
}

const char* partName(std::size_t part) {
  constexpr const char* kNames[kParts] = {"vendor id", "product code", "revision number",
                                          "serial number"};
  return kNames[part];
}

std::string toString(const Identity& identity) {
  char text[112];
  std::snprintf(
      text, sizeof(text), "vendor 0x%08X, product 0x%08X, revision 0x%08X, serial %u (0x%08X)",
      static_cast<unsigned>(identity.vendor_id), static_cast<unsigned>(identity.product_code),
      static_cast<unsigned>(identity.revision), static_cast<unsigned>(identity.serial),
      static_cast<unsigned>(identity.serial));
  return text;
}

can::Frame switchGlobal(State state) {
  return request(Command::switch_global, static_cast<std::uint8_t>(state));
}

std::array<can::Frame, 4> switchSelective(const Identity& identity) {
  return {request(Command::switch_vendor, identity.vendor_id),
          request(Command::switch_product, identity.product_code),
          request(Command::switch_revision, identity.revision),
          request(Command::switch_serial, identity.serial)};
}

can::Frame inquire(std::size_t part) { return request(offset(Command::inquire_vendor, part)); }
can::Frame inquireNodeId() { return request(Command::inquire_node_id); }
can::Frame configureNodeId(std::uint8_t node) { return request(Command::configure_node_id, node); }

can::Frame configureBitTiming(std::uint8_t index) {
  constexpr std::uint32_t kStandardTable = 0;
  return request(Command::configure_bit_timing, kStandardTable | static_cast<std::uint32_t>(index)
                                                                     << 8);
}

can::Frame activateBitTiming(std::uint16_t delay_ms) {
  return request(Command::activate_bit_timing, delay_ms);
}

can::Frame store() { return request(Command::store); }

can::Frame fastscan(std::uint32_t number, std::uint8_t bit, std::uint8_t sub, std::uint8_t next) {
  return request(Command::fastscan, number, bit, sub, next);
}

std::uint32_t numberOf(const can::Frame& answer) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number |= static_cast<std::uint32_t>(answer.data[1 + i]) << (8 * i);
  }
  return number;
}

std::uint8_t nodeIdOf(const can::Frame& answer) { return answer.data[1]; }

std::optional<std::string> errorOf(const can::Frame& answer) {
  constexpr std::uint8_t kOfTheMaker = 0xFF;
  const std::uint8_t code = answer.data[1];
  if (code == 0) return {};
  std::string text = "error " + std::to_string(code);
  if (code == kOfTheMaker) return text + " (of the maker: " + std::to_string(answer.data[2]) + ")";
  for (const ErrorRow& row : kErrors) {
    if (static_cast<std::uint8_t>(row.command) == answer.data[0] && row.code == code) {
      return text + " (" + row.text + ")";
    }
  }
  return text + " (unknown to CiA 305)";
}

std::optional<std::uint8_t> bitTimingIndex(unsigned kbit_per_s) {
  for (const RateRow& row : kRates) {
    if (row.kbit_per_s == kbit_per_s) return row.index;
  }
  return {};
}

std::string bitRates() {
  std::string text;
  constexpr std::size_t kCount = sizeof(kRates) / sizeof(kRates[0]);
  for (std::size_t i = 0; i < kCount; ++i) {
    if (i > 0) text += i + 1 == kCount ? " or " : ", ";
    text += std::to_string(kRates[i].kbit_per_s);
  }
  return text;
}

}  // namespace cia402::canopen::lss
