// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "slave_context.h"

namespace cia402::sim {

/// SDO server (CiA 301, 7.2.4): expedited and segmented transfers of any length, one at a time.
/// Requests wait `sdo_latency` each, in the order they came. Block transfer is refused.
class SdoServer {
 public:
  explicit SdoServer(SlaveContext& context) : context_(context) { data_.reserve(64); }

  /// Forgets waiting requests and the transfer in progress.
  void reset();
  /// A frame with the server's request identifier 0x600 + node.
  void receive(const can::Frame& frame);
  void tick();
  Time deadline() const { return waiting_ > 0 ? queue_[head_].due : kNever; }

 private:
  enum class Transfer { none, download, upload };
  struct Request {
    can::Frame frame;
    Time due;
  };
  static constexpr std::size_t kQueueSize = 8;

  void process(const can::Frame& request);
  void initiateDownload(const can::Frame& request);
  void downloadExpedited(const can::Frame& request);
  void downloadSegment(const can::Frame& request);
  void finishDownload();
  void confirmSegment();
  void initiateUpload(const can::Frame& request);
  void uploadSegment(const can::Frame& request);
  bool toggleFits(const can::Frame& request);
  void answer(std::uint8_t command, std::uint32_t value = 0);
  void abort(std::uint32_t code);

  SlaveContext& context_;
  std::array<Request, kQueueSize> queue_;
  std::size_t head_ = 0;
  std::size_t waiting_ = 0;

  Transfer transfer_ = Transfer::none;
  ObjectId object_;
  bool toggle_ = false;
  std::vector<std::uint8_t> data_;
  std::size_t sent_ = 0;                       // of an upload
  std::optional<std::size_t> announced_size_;  // of a download
};

}  // namespace cia402::sim
