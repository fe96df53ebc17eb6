// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "can/candump_log.h"
#include "can/frame.h"
#include "cia402_driver/common/time.h"

namespace cia402::can {

/// A frame as the flight recorder keeps it.
class FrameRecord {
 public:
  /// An empty place of the recorder.
  FrameRecord() = default;
  /// @param stamp when it was on the wire, or handed to the interface. @param sent by this program.
  FrameRecord(const Frame& frame, Time stamp, bool sent)
      : when_(stamp.time_since_epoch().count() * 2 + (sent ? 1 : 0)), frame_(frame) {}

  const Frame& frame() const { return frame_; }
  Time stamp() const { return Time(Duration(when_ >> 1)); }
  Direction direction() const {
    return (when_ & 1) != 0 ? Direction::transmitted : Direction::received;
  }

 private:
  std::int64_t when_ = 0;  // ns, times two, and one more if it was sent
  Frame frame_;
};
static_assert(sizeof(FrameRecord) == 24 && std::is_trivially_copyable<FrameRecord>::value,
              "a frame costs 24 bytes and three moves");

/// The most frames that a classic CAN bus carries in a time: frames without data and stuff bits,
/// 44 bits, and the intermission of 3 (ISO 11898-1).
/// @param bitrate bit/s
inline std::size_t mostFrames(double bitrate, Duration time) {
  constexpr double kShortestFrame = 47.0;
  return static_cast<std::size_t>(std::ceil(bitrate * toSeconds(time) / kShortestFrame));
}

}  // namespace cia402::can
