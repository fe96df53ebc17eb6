// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "fieldbus/object.h"

namespace cia402::decode {

/// Name of an object of the communication profile (CiA 301, 7.5): "heartbeat time",
/// "TPDO2 mapping, entry 1"; empty if it is none.
std::string communicationObjectName(fieldbus::ObjectId object);

}  // namespace cia402::decode
