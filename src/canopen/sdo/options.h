// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "fieldbus/object_access.h"

namespace cia402::canopen {

/// How a transfer is done.
struct SdoOptions : fieldbus::AccessOptions {
  /// Where block transfer (CiA 301, 7.2.4.2.9 and on) is used. A server that refuses it gets the
  /// same transfer in segments, and all later ones until it boots again.
  enum class Block {
    never,
    automatic,  ///< downloads of more than `block_threshold` bytes
    always,     ///< uploads, too: the object may be large
  };
  Block block = Block::automatic;
  std::size_t block_threshold = 256;                   ///< bytes
  std::size_t longest_upload = std::size_t{16} << 20;  ///< bytes; more are refused (0x05040005)
};

/// The two COB-IDs of an SDO channel (1200h and on), 11 bits; 0: that of the predefined connection
/// set, 600h and 580h + node-ID.
struct SdoChannel {
  std::uint16_t request = 0;  ///< client to server, sub-index 1
  std::uint16_t answer = 0;   ///< server to client, sub-index 2
};

}  // namespace cia402::canopen
