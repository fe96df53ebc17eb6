// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/traffic_meter.h"

namespace cia402::can {
namespace {

// Of a frame with an 11-bit identifier, the three bits between frames included; see frame_bits.h.
// With as many stuff bits as there can be: 47 + 8n + (34 + 8n - 1) / 4, rounded down, for n bytes.
constexpr double kBits = 47.0, kBitsOfByte = 8.0;
constexpr double kMostBits = 55.0, kMostBitsOfByte = 10.0;

/// All frames of the bus. A virtual interface counts what is sent on it as received, too, and every
/// frame on it is sent by this machine.
LinkSettings::Traffic onTheBus(const LinkSettings& link) {
  const LinkSettings::Traffic& counted = *link.traffic;
  if (link.kind == "vcan") return {0, counted.frames_sent, 0, counted.bytes_sent};
  return counted;
}

}  // namespace

void TrafficMeter::update(const LinkSettings& link, Time now) {
  if (!link.traffic) return reset();
  const LinkSettings::Traffic traffic = onTheBus(link);
  const Duration elapsed = now - began_;
  if (began_with_ && elapsed < std::chrono::seconds(1)) return;
  const bool counts_on = began_with_ && traffic.frames() >= began_with_->frames() &&
                         traffic.bytes() >= began_with_->bytes();
  load_.reset();
  if (counts_on) {
    const auto frames = static_cast<double>(traffic.frames() - began_with_->frames());
    const auto bytes = static_cast<double>(traffic.bytes() - began_with_->bytes());
    const double possible = bitrate_ * toSeconds(elapsed);
    load_ = Load{(kBits * frames + kBitsOfByte * bytes) / possible,
                 (kMostBits * frames + kMostBitsOfByte * bytes) / possible};
  }
  began_with_ = traffic;
  began_ = now;
}

}  // namespace cia402::can
