// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "can/frame.h"
#include "canopen/object.h"

// The frames of the layer setting services (CiA 305). Every frame has eight bytes: a command
// specifier, its parameters little-endian, zeros.
namespace cia402::canopen::lss {

inline constexpr std::uint32_t kRequestId = 0x7E5;  ///< master to slaves
inline constexpr std::uint32_t kAnswerId = 0x7E4;   ///< slaves to master

/// Node-ID of a device that has none: "unconfigured", it takes part in fastscan.
inline constexpr std::uint8_t kUnconfigured = 0xFF;
/// 1 to 127: a device that has it takes no part in fastscan.
inline constexpr bool isNodeId(std::uint8_t node) { return node >= 1 && node <= 127; }

/// Command specifiers.
enum class Command : std::uint8_t {
  switch_global = 0x04,
  configure_node_id = 0x11,
  configure_bit_timing = 0x13,
  activate_bit_timing = 0x15,
  store = 0x17,
  switch_vendor = 0x40,
  switch_product = 0x41,
  switch_revision = 0x42,
  switch_serial = 0x43,
  switched = 0x44,  ///< answer
  identify_vendor = 0x46,
  identify_product = 0x47,
  identify_revision_low = 0x48,
  identify_revision_high = 0x49,
  identify_serial_low = 0x4A,
  identify_serial_high = 0x4B,
  identify_unconfigured = 0x4C,
  identified = 0x4F,               ///< answer
  identified_unconfigured = 0x50,  ///< answer
  fastscan = 0x51,
  inquire_vendor = 0x5A,
  inquire_product = 0x5B,
  inquire_revision = 0x5C,
  inquire_serial = 0x5D,
  inquire_node_id = 0x5E,
};

/// LSS states of a device (CiA 305): only in `configuration` it takes requests that change it.
enum class State : std::uint8_t { waiting = 0, configuration = 1 };

/// The LSS address of a device, the same numbers as in its identity object 1018h: unique in the
/// world, if the maker gives serial numbers.
struct Identity {
  std::uint32_t vendor_id = 0, product_code = 0, revision = 0, serial = 0;
  /// In the order of 1018h and of LSSSub. @pre index < 4
  std::uint32_t part(std::size_t index) const;
  void setPart(std::size_t index, std::uint32_t value);
};
bool operator==(const Identity& a, const Identity& b);
inline bool operator!=(const Identity& a, const Identity& b) { return !(a == b); }
inline constexpr std::size_t kParts = 4;
/// "vendor id", "product code", "revision number", "serial number".
const char* partName(std::size_t part);
/// "vendor 0x0000ABCD, product 0x000D0117, revision 0x00010002, serial 12345 (0x00003039)".
std::string toString(const Identity& identity);

// --- Requests ----------------------------------------------------------------------------------
/// All devices change to `state`; none answers.
can::Frame switchGlobal(State state);
/// Four frames; the device with this identity answers `switched` to the fourth.
std::array<can::Frame, 4> switchSelective(const Identity& identity);
/// @pre part < 4
can::Frame inquire(std::size_t part);
can::Frame inquireNodeId();
/// @param node 1..127, or kUnconfigured.
can::Frame configureNodeId(std::uint8_t node);
/// @param index of the table of CiA 305, see bitTimingIndex().
can::Frame configureBitTiming(std::uint8_t index);
/// @param delay_ms for which the devices are silent, twice: before and after the change.
can::Frame activateBitTiming(std::uint16_t delay_ms);
can::Frame store();

/// BitChecked of the frame that starts a fastscan.
inline constexpr std::uint8_t kFastscanStart = 0x80;
/// Asks: has anybody a number in part `sub` whose bits 31..bit are those of `number`?
/// @param next part that the devices shall look at next; with bit 0 and next < sub the one that
/// still answers enters the configuration state.
can::Frame fastscan(std::uint32_t number, std::uint8_t bit, std::uint8_t sub, std::uint8_t next);

// --- Answers -----------------------------------------------------------------------------------
/// The number that an inquiry brought.
std::uint32_t numberOf(const can::Frame& answer);
std::uint8_t nodeIdOf(const can::Frame& answer);
/// What a configure or store command came to: nothing for success, else the error in words, e.g.
/// "error 1 (node-ID out of range)" or "error 255 (of the maker: 7)".
std::optional<std::string> errorOf(const can::Frame& answer);

// --- Bit timing --------------------------------------------------------------------------------
/// Index in the standard bit timing table (CiA 305) for a rate: 0 is 1000 kbit/s, 8 is 10 kbit/s;
/// nothing for a rate that the table does not have (5 is reserved).
std::optional<std::uint8_t> bitTimingIndex(unsigned kbit_per_s);
/// "1000, 800, 500, 250, 125, 50, 20 or 10".
std::string bitRates();

}  // namespace cia402::canopen::lss
