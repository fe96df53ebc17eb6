// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/device/context.h"

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
  void tick();
  Time deadline() const { return waiting_ > 0 ? queue_[head_].due : kNever; }

 private:
  enum class Transfer { none, download, upload, block_download, block_upload };
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
  void answerUpload();
  void uploadSegment(const can::Frame& request);
  bool toggleFits(const can::Frame& request);
  void answer(std::uint8_t command, std::uint32_t value = 0);
  void abort(std::uint32_t code);
  std::uint32_t answerId() const { return answer_id_; }
  static ObjectId objectOf(const can::Frame& frame);

  // Block transfer, sdo_server_block.cpp.
  void blockDownload(const can::Frame& request);
  bool takesAtOnce(const can::Frame& frame) const;
  void blockSegment(const can::Frame& frame);
  void endBlockDownload(const can::Frame& request);
  void blockUpload(const can::Frame& request);
  void initiateBlockUpload(const can::Frame& request);
  void sendSubBlock();
  void acknowledged(const can::Frame& request);
  unsigned nextBlockSize();
  std::uint16_t blockCrc() const;

  SlaveContext& context_;
  std::uint16_t parameter_;
  std::uint32_t request_id_, answer_id_;
  std::array<Request, kQueueSize> queue_;
  std::size_t head_ = 0;
  std::size_t waiting_ = 0;

  Transfer transfer_ = Transfer::none;
  ObjectId object_;
  bool toggle_ = false;
  std::vector<std::uint8_t> data_;
  std::size_t sent_ = 0;                       // of an upload
  std::optional<std::size_t> announced_size_;  // of a download
  bool block_crc_ = false;
  bool block_ended_ = false;  // the last segment was taken, or acknowledged
  unsigned block_size_ = 0;
  unsigned block_turn_ = 0;
  unsigned segment_ = 0;     // last one of the sub-block that was taken, or sent
  can::Frame last_segment_;  // of a download
};

}  // namespace cia402::sim
