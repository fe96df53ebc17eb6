// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canopen/config.h"
#include "canopen/node/node.h"

namespace cia402::canopen {

/// What the master leaves in 1020h (CiA 301, 7.5.2.23) after a complete configuration.
struct ConfigurationSignature {
  std::uint32_t date = 0;  ///< 1020h:01, days since 1984-01-01
  std::uint32_t time = 0;  ///< 1020h:02, ms of the day
};

/// With ConfigurationCheck::date the configured date; else a checksum of all that a boot writes and
/// of the device that takes it (vendor, product, revision, i.e. firmware, serial), in numbers that
/// are a date and a time of day: never 0, which means "not configured".
/// @param external_sync MasterConfig::external_sync: a drive may be the one that makes SYNC.
ConfigurationSignature configurationSignature(const NodeConfig& config,
                                              const Node::Identity& identity, bool external_sync);

}  // namespace cia402::canopen
