// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "can/bus.h"
#include "can/pacer.h"
#include "canopen/object.h"
#include "canopen/sdo/counters.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// The client's end of an SDO channel (CiA 301, 7.2.4): puts requests on the wire, one after the
/// other, and knows until when the server has to answer, how long it took, and what it said last.
class SdoExchange {
 public:
  /// @param sink, pacer where frames go, see SdoClient. @param request_id COB-ID of requests
  SdoExchange(can::Sink& sink, can::Pacer* pacer, std::uint32_t request_id)
      : sink_(sink), pacer_(pacer), request_id_(request_id) {}

  /// Sends eight bytes: command specifier, two bytes, zeros. What the sink refuses is lost; the
  /// time-out finds out.
  void send(std::uint8_t command, std::uint8_t byte1 = 0, std::uint8_t byte2 = 0);
  /// Sends a segment: command specifier, at most seven bytes of data, zeros.
  void sendSegment(std::uint8_t command, const std::uint8_t* data, std::size_t size);
  /// A request that names its object and carries 32 bits: initiate or abort.
  void sendRequest(std::uint8_t command, ObjectId object, std::uint32_t data);
  /// Sends a segment of a sub-block if the queue of the interface has room for it.
  /// @return when to try again, if it has not
  std::optional<Time> sendBulk(const can::Frame& frame, Time now);
  /// Such a segment, for sendBulk().
  can::Frame segment(std::uint8_t command, const std::uint8_t* data, std::size_t size) const;

  /// An answer is due within `timeout`.
  void await(Duration timeout, Time now);
  /// It came: its latency counts.
  void answered(Time now);
  Time deadline() const { return deadline_; }

  /// `frame` was taken as an answer.
  void remember(const can::Frame& frame) { last_answer_ = frame; }
  /// Is it the last answer once more?
  bool isRepetition(const can::Frame& frame) const { return frame == last_answer_; }
  /// The same, but for one repetition of each answer only: a frame that came twice is no server
  /// that forgets to toggle; one that comes thrice is.
  bool excuseRepetition(const can::Frame& frame);

  SdoCounters& counters() { return counters_; }
  const SdoCounters& counters() const { return counters_; }
  std::uint32_t requestId() const { return request_id_; }

 private:
  can::Sink& sink_;
  can::Pacer* pacer_;
  std::uint32_t request_id_;
  SdoCounters counters_;
  Time asked_at_{}, deadline_ = kNever;
  can::Frame last_answer_;        ///< the last one that was taken
  bool repetition_seen_ = false;  ///< of the last answer, since that came
};

}  // namespace cia402::canopen
