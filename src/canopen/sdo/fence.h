// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "can/frame.h"
#include "canopen/object.h"

namespace cia402::canopen {

/// Keeps late answers out. An SDO answer carries nothing that tells which request it belongs to,
/// only the object, and a segment not even that. After a transfer was given up (time-out,
/// cancellation, broken protocol) its answer may still come; so before the next one an object that
/// never changes is read, the device type or identity. A server answers in order: once that answer
/// is there, nothing older can follow.
class SdoFence {
 public:
  /// A transfer was given up, but its answer may still be under way. @param looks_like_anything its
  /// frames carry data behind a first byte that can be any: one of them could look like the answer
  /// to a read, hardly like that to one and later like that to another, so two are read
  void abandon(ObjectId object, bool looks_like_anything);
  /// Something was sent whose answer nobody waits for. What is abandoned already covers it.
  void expectNothingOf(ObjectId object);
  /// The same while the read is under way, whose answer proves nothing any more, for it comes
  /// first.
  /// @return true: object() is another one now, to be read at once; false: one read more will
  /// follow
  /// @pre isUp()
  bool expectMore();
  /// Nothing older can follow any more.
  void clear() { abandoned_.reset(); }

  /// Must the fence be passed before the next transfer?
  bool isUp() const { return abandoned_.has_value(); }
  /// The object whose answer may still come. @pre isUp()
  ObjectId abandoned() const { return *abandoned_; }
  /// The object to read. @pre isUp()
  ObjectId object() const;
  /// Is that the answer to the read? A refusal is one, too. @pre isUp()
  bool isAnswer(const can::Frame& frame) const;
  /// That answer came. @return true: the fence is passed; false: object() is to be read once more
  bool pass();

 private:
  std::optional<ObjectId> abandoned_;
  unsigned reads_left_ = 0;
  bool other_ = false;  ///< of the objects to read
};

}  // namespace cia402::canopen
