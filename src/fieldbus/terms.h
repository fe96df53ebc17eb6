// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cia402::fieldbus {

/// What people who know a bus call its things. An axis, which does not know the bus, tells of its
/// troubles in these words. A plural is made by an `s`.
struct Terms {
  const char* device;          ///< "node"
  const char* address;         ///< how it is found on its bus: "node-ID or bit rate"
  const char* cyclic;          ///< what carries values in the cycle, either way: "PDO"
  const char* input;           ///< what brings values of the device: "TPDO"
  const char* output;          ///< what takes values to the device: "RPDO"
  const char* access;          ///< the way to objects beside the cycle: "SDO"
  const char* emergency;       ///< "EMCY"
  const char* stop_and_start;  ///< Device::stopAndStart(): "NMT stop and start"
  const char* outputs_late;    ///< kOutputsLate: "no RPDO reached it in time (1400:05)"
  const char* outputs_check;   ///< what to look at then: "the bus and the COB-IDs of its RPDOs"
};

}  // namespace cia402::fieldbus
