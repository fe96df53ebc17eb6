// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "canopen/lss/task.h"

namespace cia402::canopen {

/// Finds all devices without a node-ID by fastscan (CiA 305), one after the other, and asks each of
/// them afterwards whether it is who it seems to be. Nothing is configured.
///
/// An answer to fastscan says nothing but "somebody": silence may as well be a lost frame. So each
/// bit, 0 or 1, is only believed once a device has answered to it, and an identity only once the
/// device that it selects has told the same four numbers. Some slaves answer fastscan although they
/// have a node-ID (lely-core, src/co/lss.c): each is asked for it, and those are left out.
///
/// What is known already is not scanned again: the next device is first looked for beside the last
/// one, and one that fell silent where it did. So a slave that mishandles fastscan costs little
/// more than one run over its bits: at most 5 s with the usual window.
class LssScanTask final : public LssTask {
 public:
  /// Confirmed identities of devices that have no node-ID, in the order in which they were found.
  const std::vector<lss::Identity>& found() const { return found_; }
  /// Something went wrong: there may be more devices than found() has; error() or result() says
  /// why.
  bool incomplete() const { return !trouble_.empty(); }

 private:
  enum class Phase { begin, starting, following, bits, moving, confirming, leaving };
  Status proceed(LssMaster& master, Time now) override;
  Status start(LssMaster& master, Time now);
  Status beginDevice(LssMaster& master, Time now);
  Status follow(LssMaster& master, Time now);
  Status judgeFollowing(LssMaster& master, Time now);
  Status askBit(LssMaster& master, Time now);
  Status judgeBit(LssMaster& master, Time now);
  Status move(LssMaster& master, Time now);
  Status judgeMove(LssMaster& master, Time now);
  Status candidateFound(LssMaster& master, Time now);
  Status foundAgain(LssMaster& master, Time now);
  Status lostTrack(LssMaster& master, Time now);
  Status beginConfirming(LssMaster& master, Time now);
  Status confirm(LssMaster& master, Time now);
  Status leave(LssMaster& master, Time now);
  Status finish();
  Status question(LssMaster& master, Time now, std::string step, const can::Frame& frame);

  Phase phase_ = Phase::begin;
  int tries_ = 0, restarts_ = 0, lost_here_ = 0;
  std::uint8_t part_ = 0, bit_ = 31;
  std::uint8_t follow_ = 0;  ///< parts of scanned_ that the next device is asked for as a whole
  std::uint8_t resume_bit_ = 31;               ///< of the part after them
  std::uint8_t lost_part_ = 0, lost_bit_ = 0;  ///< where it fell silent last
  bool asked_one_ = false;                     ///< the question was for bit value 1
  lss::Identity scanned_;                      ///< as far as the bits are known
  std::vector<lss::Identity> candidates_, found_;
  std::string configured_;  ///< those that have a node-ID all the same, in words
  std::optional<LssSelection> selection_;
  std::size_t confirming_ = 0;
  std::string trouble_;
};

}  // namespace cia402::canopen
