// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/frames.h"

#include <string>

#include "fieldbus/abort_code.h"

namespace cia402::canopen::sdo {

SdoReaction noOrdinaryAnswer(const can::Frame& frame, ObjectId object) {
  if (commandOf(frame) == kAborted) return serverAbort(frame, object);
  if (!names(frame, object)) return SdoReaction::stray();
  return SdoReaction::broken(abort_code::kInvalidCommand, "unknown command specifier");
}

SdoReaction wrongToggle(bool excused) {
  if (excused) return SdoReaction::stray();
  return SdoReaction::broken(abort_code::kToggleBit, "toggle bit not alternated");
}

SdoReaction tooMuchAnnounced(std::uint32_t size, std::size_t allowed) {
  return SdoReaction::broken(abort_code::kOutOfMemory, "the announced " + std::to_string(size) +
                                                           " bytes are more than the " +
                                                           std::to_string(allowed) + " allowed");
}

}  // namespace cia402::canopen::sdo
