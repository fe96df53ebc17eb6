// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/can/pacer.h"

#include <algorithm>
#include <cmath>

#include "cia402_driver/can/frame_bits.h"

namespace cia402::can {
namespace {

// Bulk frames are sent in batches: up to kMost bits wait, and the next batch comes when less than
// kLeast do, so that a thread that wakes late by as much leaves no gap on the wire.
constexpr unsigned kMost = 4 * 135;   // four frames of eight bytes with all stuff bits
constexpr unsigned kLeast = 2 * 135;  // two

}  // namespace

Pacer::Pacer(Sink& sink, double bitrate)
    : sink_(sink), bit_time_ps_(bitrate > 0.0 ? std::llround(1e12 / bitrate) : 0) {}

void Pacer::occupy(unsigned bits_on_wire) {
  busy_until_ = std::max(busy_until_, now_) + bits(bits_on_wire);
}

bool Pacer::send(const Frame& frame) {
  const bool taken = sink_.send(frame);
  if (taken) occupy(mostBits(frame));
  return taken;
}

bool Pacer::sendBulk(const Frame& frame) {
  const bool taken = sink_.send(frame);
  if (taken) occupy(wireBits(frame));
  return taken;
}

void Pacer::heard(const Frame& frame, Time now) {
  if (busy_until_ > now) busy_until_ += bits(mostBits(frame));
}

void Pacer::syncSent(Time now, Duration period) {
  sync_period_ = period;
  next_sync_ = period > Duration::zero() ? now + period : kNever;
}

Time Pacer::roomFor(const Frame& frame, Time now) {
  const Time free = std::max(busy_until_, now);
  const Duration waiting = free - now;
  const Duration length = bits(mostBits(frame));
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
