// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "can/frame.h"
#include "canopen/object.h"

namespace cia402::canopen {

/// NMT states as a heartbeat carries them (CiA 301, 7.2.8.3.2.1); `unknown` is ours: never heard
/// of.
enum class NmtState : std::uint8_t {
  boot_up = 0x00,
  stopped = 0x04,
  operational = 0x05,
  pre_operational = 0x7F,
  unknown = 0xFF,
};
/// "pre-operational", ...: words for messages.
const char* toString(NmtState state);

/// NMT command specifiers (CiA 301, 7.2.8.3.1).
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};
/// "reset communication", ...: words for messages.
const char* toString(NmtCommand command);

/// The frame that commands `node` (0: all nodes).
can::Frame nmtFrame(NmtCommand command, NodeId node);

}  // namespace cia402::canopen
