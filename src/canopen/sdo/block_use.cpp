// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/block_use.h"

#include "fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

/// Whether a server says by this code that it has no block transfer. Real ones use general codes,
/// too; those that speak of the object would not be other ones for segments.
bool refusesBlocks(std::uint32_t code) {
  switch (code) {
    case abort_code::kTimeout:
    case abort_code::kInvalidCommand:
    case abort_code::kInvalidBlockSize:
    case abort_code::kInvalidSequence:
    case abort_code::kUnsupportedAccess:
    case abort_code::kNoConnection:
    case abort_code::kGeneral:
    case 0:
      return true;
    default:
      return false;
  }
}

}  // namespace

bool SdoBlockUse::wanted(const SdoTransfer& transfer) const {
  if (fell_back_ || refused_) return false;
  switch (transfer.options().block) {
    case SdoOptions::Block::never:
      return false;
    case SdoOptions::Block::automatic:
      return !transfer.isUpload() && transfer.data().size() > transfer.options().block_threshold;
    case SdoOptions::Block::always:
      return transfer.isUpload() || !transfer.data().empty();
  }
  return false;
}

bool SdoBlockUse::refused(std::uint32_t code) {
  if (!refusesBlocks(code)) return false;
  fell_back_ = true;
  refused_ = refused_ || code == abort_code::kInvalidCommand;
  return true;
}

}  // namespace cia402::canopen
