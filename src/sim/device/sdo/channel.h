// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/device/context.h"

namespace cia402::sim {

/// The most that a download may bring.
inline constexpr std::size_t kSdoMemory = 1U << 20U;
/// Data bytes of a segment.
inline constexpr std::size_t kSdoSegment = 7;

/// What an SDO server is doing.
enum class SdoTransfer : std::uint8_t { none, download, upload, block_download, block_upload };

/// One SDO server's transfer in progress, and its way to answer. All kinds of transfers share it,
/// for there is one at a time.
class SdoChannel {
 public:
  explicit SdoChannel(SlaveContext& slave_context) : context(slave_context) { data.reserve(64); }
  SdoChannel(const SdoChannel&) = delete;
  SdoChannel& operator=(const SdoChannel&) = delete;

  /// A request names its object: what was in progress is over.
  void begin(const can::Frame& request);
  /// Sends eight bytes: command, the object, a value.
  void answer(std::uint8_t command, std::uint32_t value = 0);
  /// Ends the transfer; some devices say nothing of it, or another code.
  void abort(std::uint32_t code);
  /// Abort for a request that means nothing now.
  void abortInvalid();

  SlaveContext& context;
  std::uint32_t answer_id = 0;
  SdoTransfer transfer = SdoTransfer::none;
  ObjectId object;
  std::vector<std::uint8_t> data;             ///< taken so far, or to be sent
  std::size_t sent = 0;                       ///< bytes of an upload
  std::optional<std::size_t> announced_size;  ///< of a download
};

/// Index and sub-index of a request.
ObjectId sdoObjectOf(const can::Frame& request);

}  // namespace cia402::sim
