// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "bus/reply.h"
#include "cia402_driver/common/time.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {

class AxisCycle;

/// The value of an object.
struct ObjectAnswer : Answer {
  fieldbus::Bytes data;                                      ///< wire order
  double number = std::numeric_limits<double>::quiet_NaN();  ///< in device units
  std::string text;                                          ///< value with unit
};

/// Reads an object by profile name or "6041:00".
struct ReadObjectCommand {
  using Answer = ObjectAnswer;
  std::string axis, object;

  void begin(AxisCycle& cycle, const Reply<ObjectAnswer>& reply, Time now) const;
};

/// Writes an object: a number in device units (decimal, or 0x... as the bit pattern; a float where
/// the object carries one), or a text for strings.
struct WriteObjectCommand {
  using Answer = bus::Answer;
  std::string axis, object, value;

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

}  // namespace cia402::bus
