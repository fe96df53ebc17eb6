// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/pacer.h"

#include <algorithm>
#include <cmath>

#include "can/frame_bits.h"

namespace cia402::can {
namespace {

// Bulk frames are sent in batches: up to kMost bits wait, and the next batch comes when less than
// kLeast do, so that a thread that wakes late by as much leaves no gap on the wire.
constexpr unsigned kMost = 4 * 135;   // four frames of eight bytes with all stuff bits
constexpr unsigned kLeast = 2 * 135;  // two

}  // namespace

Pacer::Pacer(Sink& sink, double bitrate)
    : sink_(sink), bit_time_ps_(bitrate > 0.0 ? std::llround(1e12 / bitrate) : 0) {
  Frame frame;
  for (Duration& longest : longest_) {
    longest = bits(mostBits(frame));
    ++frame.size;
  }
}

Duration Pacer::longest(const Frame& frame) const {
  const bool common = !frame.extended && !frame.remote && frame.size < longest_.size();
  return common ? longest_[frame.size] : bits(mostBits(frame));
}

void Pacer::occupy(Duration time_on_wire) {
  busy_until_ = std::max(busy_until_, now_) + time_on_wire;
}

/// Not inlined: a compiler that sees one implementation of Sink takes `sink_` for it and puts this
/// function into itself, eight times over.
[[gnu::noinline]] bool Pacer::send(const Frame& frame) {
  const bool taken = sink_.send(frame);
  if (taken) occupy(longest(frame));
  return taken;
}

bool Pacer::sendBulk(const Frame& frame) {
  const bool taken = sink_.send(frame);
  if (taken) occupy(bits(wireBits(frame)));
  return taken;
}

void Pacer::syncSent(Time now, Duration period) {
  sync_period_ = period;
  next_sync_ = period > Duration::zero() ? now + period : kNever;
}

Time Pacer::roomFor(const Frame& frame, Time now) {
  const Time free = std::max(busy_until_, now);
  const Duration waiting = free - now;
  const Duration length = longest(frame);
  const bool sync_known = next_sync_ != kNever && now < next_sync_ + 2 * sync_period_;
  if (sync_known && 2 * length <= sync_period_) {
    if (now >= next_sync_) return free;  // overdue, so it may be sent any moment
    if (free + length > next_sync_) return next_sync_;
  }
  if (waiting <= bits(kLeast)) {
    filling_ = true;
  } else if (waiting + length > bits(kMost)) {
    filling_ = false;
  }
  return filling_ ? now : free - bits(kLeast);
}

}  // namespace cia402::can
