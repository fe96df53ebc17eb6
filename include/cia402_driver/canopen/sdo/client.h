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
#include "cia402_driver/can/pacer.h"
#include "cia402_driver/canopen/object.h"
#include "cia402_driver/common/time.h"
#include "cia402_driver/fieldbus/object_access.h"

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

/// One transfer by SDO.
class SdoTransfer final : public fieldbus::Transfer {
  friend class SdoClient;
  SdoOptions options_;
  bool urgent_ = false;
};
using SdoTicket = fieldbus::Ticket;

/// SDO client for one node (CiA 301, 7.2.4): a queue of transfers, one on the wire at a time,
/// expedited, segmented or in blocks. Sans-IO: all nodes' clients run at once in one thread.
///
/// An SDO answer carries nothing that tells which request it belongs to, only the object, and a
/// segment not even that. After a transfer was given up (time-out, cancellation, broken protocol)
/// its answer may still come; so before the next one an object that never changes is read, the
/// device type or identity. A server answers in order: once that answer is there, nothing older
/// can follow. A transfer without trouble costs no frame more for it.
class SdoClient final : public fieldbus::ObjectAccess {
 public:
  struct Counters {
    std::uint64_t completed = 0;  ///< transfers
    std::uint64_t aborted = 0;    ///< transfers ended by the server, or by us for broken protocol
    std::uint64_t timeouts = 0;
    std::uint64_t retries = 0;       ///< transfers begun again, sub-blocks asked for again
    std::uint64_t stray_frames = 0;  ///< answers to nothing, repeated or late ones
    std::uint64_t fences = 0;        ///< reads to have done with an abandoned transfer
    std::uint64_t bytes = 0;         ///< of completed transfers
    Duration busy{};                 ///< time that completed transfers took, queueing not included
    std::uint64_t answers = 0;       ///< to single requests, the base of the latencies
    Duration last_latency{}, longest_latency{}, total_latency{};

    /// From request to answer; zero before the first one.
    Duration meanLatency() const {
      return answers == 0 ? Duration::zero() : total_latency / static_cast<std::int64_t>(answers);
    }
    /// Bytes per second over all completed transfers; 0 before the first one.
    double throughput() const {
      return busy <= Duration::zero() ? 0.0 : static_cast<double>(bytes) / toSeconds(busy);
    }
  };

  /// @param sink where requests go; must outlive the client.
  /// @param pacer the same sink where it can tell how much waits in it, for block downloads; must
  /// outlive the client. Without it the segments of a sub-block are sent all at once.
  SdoClient(NodeId node, can::Sink& sink, SdoOptions defaults = {}, SdoChannel channel = {},
            can::Pacer* pacer = nullptr);

  /// Queues a read. @param name object name for messages, may be empty.
  SdoTicket upload(ObjectId object, std::string name = {}, std::optional<SdoOptions> = {});
  /// Queues a write of `data` in wire order (little-endian).
  SdoTicket download(ObjectId object, Bytes data, std::string name = {},
                     std::optional<SdoOptions> = {});
  /// holdUntil() does not hold it. As the answer of what is abandoned may still come, one read of
  /// an object that never changes precedes the write then.
  SdoTicket downloadUrgent(ObjectId object, Bytes data, const std::string& name) override;

  /// Writes 1 to 4 bytes at once and waits for no answer: a last word to a server that may be gone.
  /// The answer, should it come, is taken for none to a later request.
  /// @return false if that cannot be done: a transfer is on the wire, or the data are longer.
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
  void holdUntil(Time when) { held_until_ = when; }
  /// `*queued` becomes true with every transfer that is queued, for nextDeadline() may be another
  /// one then. It must outlive the client; nullptr: nobody is told.
  void tellWhenQueued(bool* queued) { queued_ = queued; }
  /// Ends all transfers, running and queued, with `reason` (e.g. "the node rebooted").
  void cancelAll(const std::string& reason);
  /// A boot-up message came: no answer to an older request can follow, and whether the server takes
  /// block transfers is open again. To be called after cancelAll().
  void serverRestarted();

  bool idle() const override;
  const Counters& counters() const { return counters_; }
  NodeId node() const { return node_; }
  /// Default options of transfers that are queued without their own.
  const SdoOptions& defaults() const { return defaults_; }
  std::uint32_t requestId() const { return request_id_; }
  std::uint32_t answerId() const { return answer_id_; }

 private:
  /// What the server is expected to answer at the moment.
  enum class Phase {
    idle,
    fence,
    upload_initiate,
    upload_segment,
    download_initiate,
    download_segment,
    block_upload_initiate,
    block_upload_segments,
    block_upload_end,
    block_download_initiate,
    block_download_segments,  ///< we send; an answer is not due before the last one
    block_download_acknowledge,
    block_download_end,
  };
  enum class Outcome { taken, stray };
  using Transfer = std::shared_ptr<SdoTransfer>;

  /// A block transfer on the wire.
  struct Block {
    bool crc = false;            ///< both sides compute it
    std::uint16_t checksum = 0;  ///< of the first `checked` bytes
    std::size_t checked = 0;
    unsigned size = 0;      ///< segments of this sub-block
    unsigned sequence = 0;  ///< last one sent (download) or received in order (upload)
    std::optional<unsigned> acknowledged;  ///< upload: told the server last
    bool last = false;                     ///< the segment `sequence` is the last of all
    bool gap = false;                      ///< upload: a segment of this sub-block is missing
    std::size_t begin = 0;                 ///< download: bytes before this sub-block
    unsigned vain = 0;  ///< sub-blocks or time-outs in a row that brought nothing
  };

  SdoTicket queueUpload(ObjectId object, std::string name,
                        const std::optional<fieldbus::AccessOptions>& options) override;
  SdoTicket queueDownload(ObjectId object, Bytes data, std::string name,
                          const std::optional<fieldbus::AccessOptions>& options) override;
  std::optional<SdoOptions> completed(const std::optional<fieldbus::AccessOptions>& options) const;
  SdoTicket enqueue(Transfer transfer, const std::optional<SdoOptions>& options);
  void makeWay(const std::string& urgent);
  void startNext(Time now);
  void attempt(Time now);
  void initiate(Time now);
  void initiateUpload(Time now);
  void initiateDownload(Time now);
  bool wantsBlock() const;
  void await(Phase phase, Time now);
  void answered(Time now);
  void sendInitiate(std::uint8_t command, std::uint32_t data);
  void sendRequest(std::uint8_t command, ObjectId object, std::uint32_t data);
  void sendAbort(std::uint32_t code);
  void sendFence(Time now);
  void abandon();
  ObjectId fenceObject() const;
  static bool names(const can::Frame& frame, ObjectId object);
  bool namesCurrentObject(const can::Frame& frame) const;
  bool inBlockTransfer() const;

  Outcome dispatch(const can::Frame& frame, Time now);
  Outcome dispatchSegmented(const can::Frame& frame, Time now);
  Outcome dispatchBlock(const can::Frame& frame, Time now);
  Outcome onFenceAnswer(const can::Frame& frame, Time now);
  Outcome onServerAbort(const can::Frame& frame, Time now);
  Outcome onUploadInitiated(const can::Frame& frame, Time now);
  Outcome onUploadSegment(const can::Frame& frame, Time now);
  Outcome onDownloadInitiated(const can::Frame& frame, Time now);
  Outcome onDownloadSegment(const can::Frame& frame, Time now);
  bool acceptAnnounced(std::uint32_t size, Time now);
  Outcome onWrongToggle(const can::Frame& frame, Time now);
  void requestSegment(Time now);
  void sendSegment(Time now);

  Outcome onBlockUploadInitiated(const can::Frame& frame, Time now);
  Outcome onBlockUploadSegment(const can::Frame& frame, Time now);
  Outcome onBlockUploadEnd(const can::Frame& frame, Time now);
  bool appendBlockSegment(const can::Frame& frame, Time now);
  void endSubBlock(Time now);
  void sendBlockAcknowledge(unsigned sequence, Time now);
  void checkBlock(std::size_t until);
  bool mayRepeatSegments() const;
  bool resumeBlockUpload(Time now);

  Outcome onBlockDownloadInitiated(const can::Frame& frame, Time now);
  Outcome onBlockAcknowledged(const can::Frame& frame, Time now);
  Outcome onBlockDownloadEnd(const can::Frame& frame, Time now);
  void beginSubBlock(unsigned size, Time now);
  void feedBlock(Time now);
  can::Frame nextBlockSegment();
  void sendBlockEnd(Time now);
  bool fallsBack(std::uint32_t code, Time now);

  void onTimeout(Time now);
  void succeed(Time now);
  void fail(SdoTransfer::Failure failure, std::uint32_t code, std::string reason, Time now);
  /// Tells the server, too.
  void abortTransfer(std::uint32_t code, const std::string& why, Time now);
  void finish(SdoTransfer& transfer, SdoTransfer::Failure failure, std::uint32_t code,
              std::string reason);

  NodeId node_;
  can::Sink& sink_;
  can::Pacer* pacer_;
  SdoOptions defaults_;
  std::uint32_t request_id_, answer_id_;
  std::deque<Transfer> queue_;  ///< the front one is on the wire unless phase_ is idle
  bool* queued_ = nullptr;
  Counters counters_;
  Phase phase_ = Phase::idle;
  Time deadline_ = kNever, held_until_{};
  Time feed_at_ = kNever;  ///< when more of a sub-block may be sent, in that phase
  Time started_at_{}, asked_at_{};
  int attempt_ = 0;
  bool toggle_ = false;
  bool repetition_seen_ = false;            ///< of the last answer, since that came
  can::Frame last_answer_;                  ///< the last one that was taken
  std::size_t offset_ = 0;                  ///< bytes of a download already sent
  std::optional<std::uint32_t> announced_;  ///< size the server announced for an upload
  Bytes received_;                          ///< of the upload on the wire
  Block block_;
  bool block_refused_ = false;         ///< by this server
  bool fell_back_ = false;             ///< the present transfer from blocks to segments
  std::optional<ObjectId> abandoned_;  ///< its answer may still come
  unsigned fences_left_ = 0;           ///< answers that prove that it cannot
};

}  // namespace cia402::canopen
