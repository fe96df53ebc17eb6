// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "can/bus.h"
#include "can/pacer.h"
#include "canopen/half_floats.h"
#include "canopen/object.h"
#include "canopen/sdo/block_download.h"
#include "canopen/sdo/block_upload.h"
#include "canopen/sdo/block_use.h"
#include "canopen/sdo/counters.h"
#include "canopen/sdo/download.h"
#include "canopen/sdo/exchange.h"
#include "canopen/sdo/fence.h"
#include "canopen/sdo/options.h"
#include "canopen/sdo/queue.h"
#include "canopen/sdo/transfer.h"
#include "canopen/sdo/upload.h"
#include "canopen/sdo/widths.h"
#include "cia402_driver/common/time.h"
#include "fieldbus/object_access.h"

namespace cia402::canopen {

/// SDO client for one node (CiA 301, 7.2.4): a queue of transfers, one on the wire at a time,
/// expedited, segmented or in blocks. Sans-IO: all nodes' clients run at once in one thread. After
/// a transfer was given up, the fence goes first (SdoFence); a transfer without trouble costs no
/// frame more for it.
class SdoClient final : public fieldbus::ObjectAccess {
 public:
  using Counters = SdoCounters;

  /// @param sink where requests go; must outlive the client.
  /// @param pacer the same sink where it can tell how much waits in it, for block downloads; must
  /// outlive the client. Without it the segments of a sub-block are sent all at once.
  /// @param lock what else may be why the device forbids a download, for messages
  SdoClient(NodeId node, can::Sink& sink, SdoOptions defaults = {}, SdoChannel channel = {},
            can::Pacer* pacer = nullptr, std::string lock = {});

  SdoClient(const SdoClient&) = delete;  ///< what is on the wire knows where it is
  SdoClient& operator=(const SdoClient&) = delete;

  /// Queues a read. @param name object name for messages, may be empty.
  SdoTicket upload(ObjectId object, std::string name = {}, std::optional<SdoOptions> = {});
  /// Queues a write of `data` in wire order (little-endian).
  SdoTicket download(ObjectId object, Bytes data, std::string name = {},
                     std::optional<SdoOptions> = {});
  /// holdUntil() does not hold it. As the answer of what is abandoned may still come, one read of
  /// an object that never changes precedes the write then.
  SdoTicket downloadUrgent(ObjectId object, Bytes data, const std::string& name) override;

  /// Writes 1 to 4 bytes at once and waits for no answer: a last word to a server that may be gone,
  /// also in front of the first answer to a read, which a server that takes one request at a time
  /// may then owe for good. The answer, should it come, is taken for none to a later request.
  /// @return false if that cannot be done: something else is on the wire, or the data are longer.
  bool post(ObjectId object, const Bytes& data);

  /// Takes a frame of the channel's answer COB-ID; others and answers to nothing are ignored
  /// (counted).
  void receive(const can::Frame& frame, Time now);
  /// Starts queued transfers, sends what block transfers may send, and handles time-outs.
  void tick(Time now);
  /// When tick() must be called at the latest.
  Time nextDeadline() const;
  /// Queued transfers do not start before `when`, for requests that take turns on the bus; a
  /// transfer on its way goes on.
  void holdUntil(Time when) { queue_.holdUntil(when); }
  /// `*queued` becomes true with every transfer that is queued, for nextDeadline() may be another
  /// one then. It must outlive the client; nullptr: nobody is told.
  void tellWhenQueued(bool* queued) { queue_.tellWhenQueued(queued); }
  /// Who is told of each write that the drive has confirmed, in the bytes that it was asked for in.
  void tellWritten(std::function<void(ObjectId, const Bytes&)> written) {
    written_ = std::move(written);
  }
  /// Ends all transfers, running and queued, with `reason` (e.g. "the node rebooted").
  void cancelAll(const std::string& reason);
  /// A boot-up message came: no answer to an older request can follow, and whether the server takes
  /// block transfers is open again. To be called after cancelAll().
  void serverRestarted();

  /// Floats that the device has in 16 bits: whoever asks reads and writes them in 32.
  HalfFloats& halfFloats() { return half_floats_; }
  const HalfFloats& halfFloats() const { return half_floats_; }
  /// Nothing is queued or on the wire.
  bool idle() const override;
  /// What it has done since it exists.
  const Counters& counters() const { return exchange_.counters(); }
  NodeId node() const { return node_; }
  /// What this drive holds in more bytes than others of its family; unknown at first.
  ObjectWidths& widths() { return widths_; }
  /// Default options of transfers that are queued without their own.
  const SdoOptions& defaults() const { return defaults_; }
  /// COB-ID of the frames that it sends.
  std::uint32_t requestId() const { return exchange_.requestId(); }
  /// COB-ID of the frames that it takes.
  std::uint32_t answerId() const { return answer_id_; }

 private:
  struct Idle {};     ///< nothing is on the wire
  struct AtFence {};  ///< the read before the front transfer is

  SdoTicket queueUpload(ObjectId object, std::string name,
                        const std::optional<fieldbus::AccessOptions>& options) override;
  SdoTicket queueDownload(ObjectId object, Bytes data, std::string name,
                          const std::optional<fieldbus::AccessOptions>& options) override;
  std::optional<SdoOptions> completed(const std::optional<fieldbus::AccessOptions>& options) const;
  void makeWay(const std::string& urgent);

  void startNext(Time now);
  void attempt(Time now);
  void initiate(Time now);
  void sendFence(Time now);
  void askFence();

  SdoReaction dispatch(const can::Frame& frame, Time now);
  SdoReaction onFenceAnswer(const can::Frame& frame, Time now);
  void act(const SdoReaction& reaction, Time now);
  void onTimeout(Time now);
  void giveUp(Time now);
  bool resumes(Time now);

  bool isIdle() const { return std::holds_alternative<Idle>(wire_); }
  bool isAtFence() const { return std::holds_alternative<AtFence>(wire_); }
  bool initiatesBlocks() const;
  std::string refusalText(std::uint32_t abort_code) const;
  void abandon(std::uint32_t abort_code);
  void succeed(Time now);
  void fail(SdoTransfer::Failure failure, std::uint32_t code, std::string reason, Time now);

  NodeId node_;
  SdoOptions defaults_;
  std::string lock_;
  std::uint32_t answer_id_;
  SdoQueue queue_;
  SdoExchange exchange_;
  SdoFence fence_;
  HalfFloats half_floats_;
  SdoBlockUse blocks_;
  ObjectWidths widths_;
  std::function<void(ObjectId, const Bytes&)> written_;
  /// What is on the wire, for the front one of the queue.
  std::variant<Idle, AtFence, SdoUpload, SdoDownload, SdoBlockUpload, SdoBlockDownload> wire_;
  Time started_at_{};  ///< of the front transfer, all attempts and fences included
  int attempt_ = 0;
};

}  // namespace cia402::canopen
