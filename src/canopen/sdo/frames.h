// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "can/frame.h"
#include "canopen/object.h"
#include "canopen/sdo/reaction.h"

/// What the kinds of transfer have in common on the wire (CiA 301, 7.2.4.3).
namespace cia402::canopen::sdo {

constexpr std::uint8_t kRequestUpload = 0x40;
constexpr std::uint8_t kAbort = 0x80;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kNoMoreSegments = 0x01;
constexpr std::size_t kSegmentBytes = 7;  ///< of a segment, but for the last one

/// Server command specifiers: the upper three bits of the first byte.
enum ServerCommand : unsigned {
  kUploadSegment = 0,
  kDownloadSegment = 1,
  kUploadInitiated = 2,
  kDownloadInitiated = 3,
  kAborted = 4,
  kBlockDownload = 5,
  kBlockUpload = 6,
};

// Of block upload and download.
constexpr unsigned kMostSegments = 127;  ///< of a sub-block
constexpr std::uint8_t kCrcSupported = 0x04;
constexpr std::uint8_t kLastSegment = 0x80;
constexpr unsigned kMostVain = 10;  ///< sub-blocks in a row that bring nothing, then it ends

inline unsigned commandOf(const can::Frame& frame) { return frame.data[0] >> 5U; }
inline bool toggleOf(const can::Frame& frame) { return (frame.data[0] & kToggle) != 0; }

/// Bytes 4 to 7.
inline std::uint32_t dataOf(const can::Frame& frame) {
  return static_cast<std::uint32_t>(frame.data[4]) |
         static_cast<std::uint32_t>(frame.data[5]) << 8 |
         static_cast<std::uint32_t>(frame.data[6]) << 16 |
         static_cast<std::uint32_t>(frame.data[7]) << 24;
}

/// Is `object` what bytes 1 to 3 name?
inline bool names(const can::Frame& frame, ObjectId object) {
  return frame.data[1] == (object.index & 0xFFU) && frame.data[2] == object.index >> 8 &&
         frame.data[3] == object.subindex;
}

/// The server aborts, if it means the transfer of `object`.
inline SdoReaction serverAbort(const can::Frame& frame, ObjectId object) {
  return names(frame, object) ? SdoReaction::refused(dataOf(frame)) : SdoReaction::stray();
}

/// An answer to an ordinary upload or download that is none: an abort, or bits of block transfer or
/// undefined ones, by which nothing that was asked for can be answered.
SdoReaction noOrdinaryAnswer(const can::Frame& frame, ObjectId object);

/// A segment whose toggle bit is that of the one before (CiA 301, 7.2.4.2.4 and 7.2.4.2.7).
/// @param excused it is the last answer once more
SdoReaction wrongToggle(bool excused);

/// "the announced 70 bytes are more than the 64 allowed"; answered by an abort.
SdoReaction tooMuchAnnounced(std::uint32_t size, std::size_t allowed);

}  // namespace cia402::canopen::sdo
