// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "cia402_driver/common/time.h"
#include "drive/profile/profile.h"

namespace cia402::drive {

/// Hands set-points to a drive one by one, as its Handover says. The target has left before the
/// first word is sent: a drive that looks at the controlword before the target takes the previous
/// one only where the frame with the target was lost. A newer target waits until the drive has
/// acknowledged, and the latest wins. Where nothing proves that the drive took one it is handed
/// over twice.
class SetPointHandshake {
 public:
  /// What the axis sees in this cycle.
  struct Input {
    std::uint64_t target_frames = 0;       ///< how often the target was sent so far
    std::uint64_t controlword_frames = 0;  ///< how often the controlword was
    bool together = false;                 ///< one frame has both
    bool acknowledged = false;             ///< statusword bit 12
  };

  /// @param handover of the mode, with at least two words; must outlive this.
  explicit SetPointHandshake(const Handover& handover) : handover_(&handover) {}

  /// A set-point that is to be handed over.
  struct Offer {
    std::uint64_t raw = 0;  ///< for the target object
    bool twice = false;     ///< see offer()
    bool command = false;   ///< its words are Handover::ofCommand()
    /// The drive must not take the previous one: the target leaves several times before the words,
    /// where it has a frame of its own, which may be lost.
    bool insist = false;
  };

  /// Wants `raw` to be the set-point. Replaces one that has not been handed over yet.
  /// @param twice once more after the first acknowledge, which proves that the drive has the target
  ///   where one frame holds both: then the second edge cannot take the previous one, whatever is
  ///   lost
  void offer(std::uint64_t raw, bool twice = false) { offer(Offer{raw, twice, false, false}); }
  void offer(const Offer& offer) {
    next_ = offer;
    pending_ = true;
  }
  /// Forgets everything, the controlword rests. `raw` is what the target object shall hold
  /// meanwhile.
  void reset(std::uint64_t raw);
  /// One cycle. @return false if the drive has not answered for `timeout`: the controlword rests
  /// and the set-point is dropped.
  [[nodiscard]] bool advance(const Input& input, Time now, Duration timeout);

  std::uint64_t raw() const { return present_.raw; }  ///< for the target object
  /// For the controlword: one of Handover::words.
  std::uint16_t word() const {
    const bool command = present_.command && word_ > 0;
    return command ? handover_->ofCommand(word_) : handover_->words[word_];
  }
  /// A set-point is on its way: the drive's target-reached bit still speaks of the one before.
  bool busy() const { return pending_ || phase_ != Phase::idle; }
  /// A set-point that is to count at once waits for a drive whose queue is full of commands.
  bool blocked() const {
    return handover_->queued && !handover_->replaces_queue && pending_ && !next_.command &&
           acknowledged_ && (phase_ == Phase::idle || phase_ == Phase::lowered);
  }
  /// One that was offered has not been announced yet.
  bool pending() const { return pending_; }
  /// A target is on its way and its words are to follow: another one would begin anew.
  bool announced() const { return phase_ == Phase::announced && handed_over_ == 0; }
  /// The target is to leave with this cycle, whether it has before or not.
  bool insists() const { return phase_ == Phase::announced && present_.insist; }
  /// The words that hand a set-point over are being sent.
  bool raised() const { return word_ > 0; }
  /// What the drive does not do that is waited for, in words.
  const char* waitingFor() const;

 private:
  enum class Phase : std::uint8_t { idle, announced, raised, lowered };
  void enter(Phase phase, std::uint64_t frames, Time now);
  void announce(const Input& input, Time now);
  void raise(const Input& input, Time now);
  void lower(const Input& input, Time now);
  bool waitsForRoom() const;
  bool replacesQueue() const;
  bool replacesWhileLowering() const;
  bool handedOverOnce() const;
  bool sentLongEnough(const Input& input) const;
  bool targetSent(const Input& input) const;
  bool waitsForAcknowledge() const;

  const Handover* handover_;
  Phase phase_ = Phase::idle;
  std::size_t word_ = 0;
  bool pending_ = false;
  int handed_over_ = 0;            ///< how often the present set-point was
  bool was_acknowledged_ = false;  ///< before the first word
  bool acknowledged_ = false;      ///< in this cycle
  bool timing_ = false;            ///< `since_` is valid while waiting in idle
  Offer present_, next_;
  std::uint64_t frames_ = 0;
  Time since_{};
};

}  // namespace cia402::drive
