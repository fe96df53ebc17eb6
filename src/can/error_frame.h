// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "can/bus.h"
#include "can/frame.h"

namespace cia402::can {

/// Error classes, the bits of an error frame's identifier (linux/can/error.h).
namespace error_class {
inline constexpr std::uint32_t kTxTimeout = 0x001;
inline constexpr std::uint32_t kLostArbitration = 0x002;
inline constexpr std::uint32_t kController = 0x004;  ///< details in data[1]
inline constexpr std::uint32_t kProtocol = 0x008;    ///< details in data[2], place in data[3]
inline constexpr std::uint32_t kTransceiver = 0x010;
inline constexpr std::uint32_t kNoAcknowledge = 0x020;
inline constexpr std::uint32_t kBusOff = 0x040;
inline constexpr std::uint32_t kBusError = 0x080;
inline constexpr std::uint32_t kRestarted = 0x100;
inline constexpr std::uint32_t kCounters = 0x200;  ///< TEC in data[6], REC in data[7]
}  // namespace error_class

/// Controller status, bits of data[1] of an error frame of class kController.
namespace controller_status {
inline constexpr std::uint8_t kRxOverflow = 0x01;
inline constexpr std::uint8_t kTxOverflow = 0x02;
inline constexpr std::uint8_t kRxWarning = 0x04;
inline constexpr std::uint8_t kTxWarning = 0x08;
inline constexpr std::uint8_t kRxPassive = 0x10;
inline constexpr std::uint8_t kTxPassive = 0x20;
inline constexpr std::uint8_t kActive = 0x40;
}  // namespace controller_status

/// An error frame in words: all its classes with their details, separated by "; ", e.g.
/// "controller error passive (transmit); transmit errors 128, receive errors 0".
/// Unknown bits are named by number.
std::string describeErrorFrame(const Frame& frame);

/// The controller's state after an error frame, given the one before. Frames that say nothing about
/// the state (lost arbitration, single bus errors) leave it alone.
BusState stateAfter(const Frame& error_frame, BusState before);

/// Names of the error classes by their bit, e.g. "lost arbitration" for bit 1.
const char* errorClassName(std::size_t bit);
/// Adds an error frame to the counters: in all, by class, and what was lost with it.
void countErrorFrame(const Frame& error_frame, BusCounters& counters);

/// True if the error frame tells that the controller or its driver lost received frames.
bool reportsReceiveOverflow(const Frame& error_frame);

}  // namespace cia402::can
