// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "fieldbus/abort_code.h"
#include "fieldbus/bytes.h"
#include "fieldbus/object.h"

namespace cia402::canopen {

/// Node-ID of a device on the bus, 1..127 (CiA 301, 7.3.5); 0 addresses all nodes in NMT.
using NodeId = std::uint8_t;

// What the whole module speaks of.
namespace abort_code = fieldbus::abort_code;
using fieldbus::abortText;
using fieldbus::Bytes;
using fieldbus::DataType;
using fieldbus::isSigned;
using fieldbus::ObjectId;
using fieldbus::sizeBits;
using fieldbus::toBytes;
using fieldbus::toUnsigned;

}  // namespace cia402::canopen
