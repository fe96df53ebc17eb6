// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "can/bus.h"
#include "cia402_driver/common/time.h"

namespace cia402::can {

/// A sink in front of an interface that knows about how long what it passed on still waits for the
/// wire. The kernel's queue is first in, first out: whatever is put into it delays the SYNC behind
/// it, however low its priority. Whoever has much to send therefore asks roomFor() before each
/// frame: a few frames are let ahead, none that would still be waiting when the next SYNC is due.
///
/// An estimate from the bit rate, from what was sent and from what was heard meanwhile; it needs no
/// report by the controller. Sans-IO, does not allocate.
class Pacer final : public Sink {
 public:
  /// @param sink must outlive the pacer. @param bitrate in bit/s; 0: nothing
  /// is held back.
  Pacer(Sink& sink, double bitrate);

  /// The time of what is sent from here on. Going back is harmless.
  void setTime(Time now) { now_ = now; }
  /// Passes a frame on at once, whatever waits.
  bool send(const Frame& frame) override;
  /// The same for a frame that roomFor() has let pass: it is measured bit by bit.
  bool sendBulk(const Frame& frame);
  /// Somebody else's frame was on the wire, ending at about `now`: what waits here was held up.
  void heard(const Frame& frame, Time now) {
    if (busy_until_ > now) busy_until_ += longest(frame);
  }
  /// A SYNC was sent; the next will be after `period`, which zero leaves open.
  void syncSent(Time now, Duration period);

  /// When `frame` may be sent: a time not after `now` if at once, otherwise when to ask again.
  Time roomFor(const Frame& frame, Time now);
  /// When everything that was sent has left, about.
  Time busyUntil() const { return busy_until_; }

 private:
  Duration bits(unsigned count) const {
    return Duration(static_cast<std::int64_t>(count) * bit_time_ps_ / 1000);
  }
  /// How long a frame can take on the wire at most.
  Duration longest(const Frame& frame) const;
  void occupy(Duration time_on_wire);

  Sink& sink_;
  std::int64_t bit_time_ps_;
  std::array<Duration, 9> longest_{};  ///< of data frames with 11-bit identifier, by their size
  Time now_{};
  Time busy_until_{};
  Time next_sync_ = kNever;
  Duration sync_period_{};
  bool filling_ = true;
};

}  // namespace cia402::can
