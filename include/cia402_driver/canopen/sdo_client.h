// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/can/bus.h"
#include "cia402_driver/canopen/object.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

using Bytes = std::vector<std::uint8_t>;

/// How long to wait for each answer of the server and how often to start a transfer again after a
/// time-out. Aborts by the server are answers: they are never retried.
struct SdoOptions {
  Duration timeout = std::chrono::milliseconds(500);
  int retries = 1;
};

/// One transfer, shared by the client and whoever asked for it. Whoever asked polls `done()`; a
/// dropped ticket only means that nobody wants the result.
class SdoTransfer {
 public:
  enum class Direction { upload, download };
  enum class Failure { none, aborted_by_server, timed_out, protocol_error, cancelled };

  bool done() const { return done_; }
  /// Valid once done() and ok: what was read; for a download what was written.
  const Bytes& data() const { return data_; }
  bool ok() const { return done_ && failure_ == Failure::none; }
  Failure failure() const { return failure_; }
  /// The server's or our own abort code; 0 if there was none.
  std::uint32_t abortCode() const { return abort_code_; }
  /// In words: "node 3, object 6060:00 mode_of_operation, write 08: the drive refused:
  /// 0x06090030 (invalid value)". Empty while running or when ok.
  const std::string& message() const { return message_; }
  /// The last part of message() alone: "the drive refused: 0x06090030 (invalid value)".
  const std::string& reason() const { return reason_; }
  const std::string& name() const { return name_; }
  ObjectId object() const { return object_; }
  Direction direction() const { return direction_; }

 private:
  friend class SdoClient;
  ObjectId object_;
  std::string name_;
  Direction direction_ = Direction::upload;
  SdoOptions options_;
  Bytes data_;
  bool done_ = false;
  Failure failure_ = Failure::none;
  std::uint32_t abort_code_ = 0;
  std::string message_, reason_;
};
using SdoTicket = std::shared_ptr<const SdoTransfer>;

/// SDO client for one node (CiA 301, 7.2.4): a queue of transfers, one on the wire at a time,
/// expedited or segmented of any length. Sans-IO: all nodes' clients run at once in one thread.
class SdoClient {
 public:
  /// @param sink where requests go; must outlive the client.
  SdoClient(NodeId node, can::Sink& sink, SdoOptions defaults = {});

  /// Queues a read. @param name object name for messages, may be empty.
  SdoTicket upload(ObjectId object, std::string name = {}, std::optional<SdoOptions> = {});
  /// Queues a write of `data` in wire order (little-endian).
  SdoTicket download(ObjectId object, Bytes data, std::string name = {},
                     std::optional<SdoOptions> = {});

  /// Takes a frame with COB-ID 580h + node-ID; others and answers to nothing are ignored (counted).
  void receive(const can::Frame& frame, Time now);
  /// Starts queued transfers and handles time-outs.
  void tick(Time now);
  /// When tick() must be called at the latest.
  Time nextDeadline() const;
  /// Queued transfers do not start before `when`, for requests that take turns on the bus; a
  /// transfer on its way goes on.
  void holdUntil(Time when) { held_until_ = when; }
  /// Ends all transfers, running and queued, with `reason` (e.g. "the node rebooted").
  void cancelAll(const std::string& reason);

  bool idle() const;
  struct Counters {
    std::uint64_t completed = 0, aborted = 0, timeouts = 0, retries = 0, stray_frames = 0;
  };
  const Counters& counters() const { return counters_; }
  NodeId node() const { return node_; }

 private:
  /// What the server is expected to answer at the moment.
  enum class Phase { idle, upload_initiate, upload_segment, download_initiate, download_segment };
  enum class Outcome { taken, stray };
  using Transfer = std::shared_ptr<SdoTransfer>;

  SdoTicket enqueue(Transfer transfer, const std::optional<SdoOptions>& options);
  void startNext(Time now);
  void initiate(Time now);
  void await(Phase phase, Time now);
  void sendInitiate(std::uint8_t command, std::uint32_t data);
  void sendAbort(std::uint32_t code);
  bool namesCurrentObject(const can::Frame& frame) const;

  Outcome dispatch(const can::Frame& frame, Time now);
  Outcome onServerAbort(const can::Frame& frame, Time now);
  Outcome onUploadInitiated(const can::Frame& frame, Time now);
  Outcome onUploadSegment(const can::Frame& frame, Time now);
  Outcome onDownloadInitiated(const can::Frame& frame, Time now);
  Outcome onDownloadSegment(const can::Frame& frame, Time now);
  void requestSegment(Time now);
  void sendSegment(Time now);

  void onTimeout(Time now);
  void succeed(Time now);
  void fail(SdoTransfer::Failure failure, std::uint32_t code, std::string reason, Time now);
  /// Tells the server, too.
  void abortTransfer(std::uint32_t code, const std::string& why, Time now);
  void finish(SdoTransfer& transfer, SdoTransfer::Failure failure, std::uint32_t code,
              std::string reason);

  NodeId node_;
  can::Sink& sink_;
  SdoOptions defaults_;
  std::deque<Transfer> queue_;  ///< the front one is on the wire unless phase_ is idle
  Counters counters_;
  Phase phase_ = Phase::idle;
  Time deadline_ = kNever, held_until_{};
  int attempt_ = 0;
  bool toggle_ = false;
  std::size_t offset_ = 0;                  ///< bytes of a download already sent
  std::optional<std::uint32_t> announced_;  ///< size the server announced for an upload
  Bytes received_;                          ///< of the upload on the wire
};

/// A little-endian unsigned number from up to eight bytes. @pre bytes.size() <= 8
std::uint64_t toUnsigned(const Bytes& bytes);
/// `size` little-endian bytes of `value`. @pre size <= 8
Bytes toBytes(std::uint64_t value, unsigned size);

}  // namespace cia402::canopen
