// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bus/reply.h"
#include "canopen/lss/protocol.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

class Network;

/// The devices that have no node-ID.
struct LssScanAnswer : Answer {
  std::vector<canopen::lss::Identity> devices;
  std::vector<std::string> device_axes;  ///< the axis of each device, or empty
};

/// Finds all devices without a node-ID; refused while something is in motion.
struct LssScanCommand {
  using Answer = LssScanAnswer;
  Duration window{std::chrono::milliseconds(20)};  ///< for each answer, see LssOptions

  void begin(Network& network, const Reply<LssScanAnswer>& reply, Time now) const;
};

/// Gives the device of an identity a node-ID; refused while something is in motion.
struct LssAssignCommand {
  using Answer = bus::Answer;
  canopen::lss::Identity identity;
  int node_id = 0;  ///< 1..127, and nobody's
  bool store = false;

  void begin(Network& network, const Reply<>& reply, Time now) const;
};

/// Sets the bit timing of one axis' drive, or of all where `axis` is empty; with `activate` all
/// devices on the bus take it. Refused unless the axes are disabled.
struct LssBitTimingCommand {
  using Answer = bus::Answer;
  std::string axis;
  unsigned kbit_per_s = 0;
  bool store = false, activate = false;
  Duration delay{std::chrono::seconds(1)};  ///< of silence before and after the change

  void begin(Network& network, const Reply<>& reply, Time now) const;
};

}  // namespace cia402::bus
