// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bus/canopen/dcf_reading.h"
#include "bus/reply.h"
#include "cia402_driver/common/time.h"

namespace cia402::bus {

class Network;

/// Reads the objects of a drive that a DCF is to hold; made by DcfDraft.
struct SaveDcfCommand {
  using Answer = bus::Answer;
  std::string axis;
  std::shared_ptr<DcfReading> reading;  ///< not nullptr; complete once answered with success

  void begin(Network& network, const Reply<>& reply, Time now) const;
};

}  // namespace cia402::bus
