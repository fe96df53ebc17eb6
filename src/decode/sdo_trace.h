// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "can/frame.h"
#include "fieldbus/bytes.h"
#include "fieldbus/object.h"

namespace cia402::decode {

/// What the frames of one SDO channel so far have told of the transfer under way, for segments do
/// not name their object (CiA 301, 7.2.4.3).
class SdoTrace {
 public:
  /// The kinds of transfer whose later frames have to be told apart.
  enum class Transfer : std::uint8_t { none, upload, download, block_upload, block_download };

  /// A transfer of `object` begins.
  void begin(fieldbus::ObjectId object, Transfer transfer);
  /// Its last frame was seen; what it brought is remembered until another one begins.
  void end() { transfer_ = Transfer::none; }
  /// Somebody has given it up: frames that still come belong to nothing that is known.
  void abort();
  Transfer transfer() const { return transfer_; }

  /// Did the beginning of the transfer come, so that its object is known?
  bool known() const { return known_; }
  /// @pre known()
  fieldbus::ObjectId object() const { return object_; }
  /// The first bytes of the data, at most kKept.
  const fieldbus::Bytes& data() const { return data_; }
  /// Bytes of data that came or went so far.
  std::size_t received() const { return received_; }
  static constexpr std::size_t kKept = 64;  ///< bytes of a transfer that are remembered

  /// A segment carries `count` bytes behind its first one, at most 7.
  void collect(const can::Frame& frame, std::size_t count);

  /// Are the next frames of the sender segments of a block, which have no command?
  bool inBlock() const { return in_block_; }
  /// The receiver of a block transfer is ready, if one of that kind is under way.
  void startBlocks(Transfer transfer) { in_block_ = transfer_ == transfer; }
  /// A segment of a block: of the last one the end of the transfer tells how many bytes count.
  void collectBlockSegment(const can::Frame& frame, bool last);
  /// The receiver has taken the segments of a block up to a number; the others come again, and
  /// without the last one of all the next block follows.
  void acknowledge(std::uint8_t segments);
  /// All blocks have come. @param unused bytes of the last segment that do not count
  void endBlocks(std::size_t unused);

 private:
  void cut(std::size_t size);

  Transfer transfer_ = Transfer::none;
  bool in_block_ = false;
  bool known_ = false;  ///< object_ is that of the transfer under way
  fieldbus::ObjectId object_;
  fieldbus::Bytes data_;
  std::size_t received_ = 0;
  std::size_t block_began_ = 0;  ///< received_ at the beginning of the block
  bool last_segment_seen_ = false;
};

}  // namespace cia402::decode
