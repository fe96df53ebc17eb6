// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cia402_driver/common/time.h"
#include "fieldbus/bytes.h"
#include "fieldbus/object.h"

namespace cia402::fieldbus {

/// How one object is read or written. Refusals by the device are answers: they are never retried.
struct AccessOptions {
  Duration timeout = std::chrono::milliseconds(500);  ///< for each answer of the device
  int retries = 1;                                    ///< how often to start again after a time-out
  /// Some devices answer nothing where they should refuse, as they do not have the object. Where
  /// the device answers for another object between two such requests, the transfer ends as if it
  /// had refused it with 0x06020000. Needs `retries` of at least 1.
  bool silence_is_missing = false;
};

/// One transfer of an object's value, shared by who does it and who asked for it. Whoever asked
/// polls `done()`; a dropped ticket only means that nobody wants the result.
class Transfer {
 public:
  /// As the device sees it (CiA 301): an upload reads from it, a download writes to it.
  enum class Direction : std::uint8_t { upload, download };
  /// Why a transfer came to nothing.
  enum class Failure : std::uint8_t {
    none,
    aborted_by_server,  ///< the device refused it: abortCode()
    timed_out,
    protocol_error,
    cancelled,
  };

  bool done() const { return done_; }
  /// Valid once done() and ok: what was read; for a download what was written.
  const Bytes& data() const { return data_; }
  bool ok() const { return done_ && failure_ == Failure::none; }
  Failure failure() const { return failure_; }
  /// The device's or our own abort code (CiA 301, table 22); 0 if there was none.
  std::uint32_t abortCode() const { return abort_code_; }
  /// In words: "node 3, object 6060:00 mode_of_operation, write 08: the drive refused:
  /// 0x06090030 (invalid value)". Empty while running or when ok.
  const std::string& message() const { return message_; }
  /// The last part of message() alone: "the drive refused: 0x06090030 (invalid value)".
  const std::string& reason() const { return reason_; }
  const std::string& name() const { return name_; }
  ObjectId object() const { return object_; }
  Direction direction() const { return direction_; }

 protected:
  Transfer() = default;
  ~Transfer() = default;

  ObjectId object_;
  std::string name_;
  Direction direction_ = Direction::upload;
  Bytes data_;
  bool done_ = false;
  Failure failure_ = Failure::none;
  std::uint32_t abort_code_ = 0;
  std::string message_, reason_;
};
using Ticket = std::shared_ptr<const Transfer>;

/// Reads and writes the objects of one device beside the cycle: a queue of transfers, done in the
/// order in which they were asked for. Never blocks.
class ObjectAccess {
 public:
  virtual ~ObjectAccess() = default;

  /// Queues a read. @param name object name for messages, may be empty. @param options absent: the
  /// device's own, DeviceTimes::access
  Ticket upload(ObjectId object, std::string name = {},
                const std::optional<AccessOptions>& options = {}) {
    return queueUpload(object, std::move(name), options);
  }
  /// Queues a write of `data` in wire order (little-endian).
  Ticket download(ObjectId object, Bytes data, std::string name = {},
                  const std::optional<AccessOptions>& options = {}) {
    return queueDownload(object, std::move(data), std::move(name), options);
  }
  /// A write that waits for nothing, e.g. a stop: it is the first of the queue, and the transfer
  /// that is under way is abandoned, whose ticket fails (`cancelled`, with the urgent object in the
  /// reason). The other queued transfers follow. Urgent writes do not abandon each other.
  virtual Ticket downloadUrgent(ObjectId object, Bytes data, const std::string& name) = 0;
  /// Nothing is queued or under way.
  virtual bool idle() const = 0;

 private:
  virtual Ticket queueUpload(ObjectId object, std::string name,
                             const std::optional<AccessOptions>& options) = 0;
  virtual Ticket queueDownload(ObjectId object, Bytes data, std::string name,
                               const std::optional<AccessOptions>& options) = 0;
};

}  // namespace cia402::fieldbus
