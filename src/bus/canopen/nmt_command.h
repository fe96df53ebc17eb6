// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/reply.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

class Network;

/// An NMT command of CiA 301, 7.2.8.3.1, by its word (start, stop, pre_operational, reset_node,
/// reset_communication) to one axis' node, or to all where `axis` is empty. Every command is
/// refused while the power stage of an axis may be on.
struct NmtServiceCommand {
  using Answer = bus::Answer;
  std::string axis, command;

  void begin(Network& network, const Reply<>& reply, Time now) const;
};

}  // namespace cia402::bus
