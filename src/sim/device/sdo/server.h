// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/device/context.h"
#include "sim/device/sdo/block_download.h"
#include "sim/device/sdo/block_upload.h"
#include "sim/device/sdo/segments.h"

namespace cia402::sim {

/// SDO server (CiA 301, 7.2.4): expedited, segmented and block transfers of any length, one at a
/// time. Requests wait `sdo_latency` each, in the order they came; segments of a sub-block do not.
class SdoServer {
 public:
  /// @param parameter the object with the COB-IDs (1201h); 0: those of the default server.
  explicit SdoServer(SlaveContext& context, std::uint16_t parameter = 0);

  /// Takes writes of the parameter object.
  void serveObjects();
  /// Takes the COB-IDs from the parameter object, or from the node-ID.
  void configure();
  /// Whether the identifier is that of the server's requests.
  bool concerns(std::uint32_t id) const { return id == request_id_; }

  /// Forgets waiting requests and the transfer in progress.
  void reset();
  /// A frame with the server's request identifier.
  void receive(const can::Frame& frame);
  /// Answers what is due.
  void tick();
  /// When tick() must be called next.
  Time deadline() const { return waiting_ > 0 ? queue_[head_].due : kNever; }

 private:
  struct Request {
    can::Frame frame;
    Time due;
  };
  static constexpr std::size_t kQueueSize = 8;

  void process(const can::Frame& request);

  SlaveContext& context_;
  std::uint16_t parameter_;
  std::uint32_t request_id_;
  std::array<Request, kQueueSize> queue_;
  std::size_t head_ = 0;
  std::size_t waiting_ = 0;

  SdoChannel channel_;
  SdoSegments segments_{channel_};
  SdoBlockDownload block_download_{channel_};
  SdoBlockUpload block_upload_{channel_, segments_};
};

}  // namespace cia402::sim
