// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/set_point_handshake.h"

namespace cia402::drive {
namespace {

using Acknowledge = Handover::Acknowledge;

constexpr std::uint64_t kInsisting = 3;  // frames

}  // namespace

void SetPointHandshake::reset(std::uint64_t raw) {
  *this = SetPointHandshake(*handover_);
  present_.raw = raw;
}

void SetPointHandshake::enter(Phase phase, std::uint64_t frames, Time now) {
  phase_ = phase;
  frames_ = frames;
  since_ = now;
  timing_ = true;
}

/// The target leaves, the words follow.
void SetPointHandshake::announce(const Input& input, Time now) {
  present_ = next_;
  handed_over_ = 0;
  pending_ = false;
  enter(Phase::announced, input.target_frames, now);
}

bool SetPointHandshake::sentLongEnough(const Input& input) const {
  return input.controlword_frames >= frames_ + static_cast<std::uint64_t>(handover_->each_for);
}

bool SetPointHandshake::targetSent(const Input& input) const {
  const bool several = present_.insist && !input.together;
  return input.target_frames >= frames_ + (several ? kInsisting : 1);
}

bool SetPointHandshake::waitsForAcknowledge() const {
  return handover_->acknowledge != Acknowledge::none && !was_acknowledged_;
}

/// The next word, or the end of the last one.
void SetPointHandshake::raise(const Input& input, Time now) {
  if (word_ + 1 < handover_->words.size()) {
    if (word_ > 0 && !sentLongEnough(input)) return;
    if (word_ == 0) was_acknowledged_ = input.acknowledged;
    ++word_;
    enter(Phase::raised, input.controlword_frames, now);
  } else if (waitsForAcknowledge() ? input.acknowledged : sentLongEnough(input)) {
    word_ = 0;
    enter(Phase::lowered, input.controlword_frames, now);
    if (pending_ && replacesWhileLowering()) announce(input, now);
  }
}

/// The words rest for as long as the next target takes to leave: both may travel together.
bool SetPointHandshake::replacesWhileLowering() const {
  return handover_->each_for == 1 && handover_->acknowledge != Acknowledge::level;
}

void SetPointHandshake::lower(const Input& input, Time now) {
  const bool level = handover_->acknowledge == Acknowledge::level;
  if (level ? input.acknowledged || input.controlword_frames == frames_ : !sentLongEnough(input)) {
    return;
  }
  phase_ = Phase::idle;
  timing_ = false;
  if (++handed_over_ == 1 && !handedOverOnce()) {
    enter(Phase::announced, present_.insist ? input.target_frames : 0, now);
  }
}

/// A distance would be gone twice.
bool SetPointHandshake::handedOverOnce() const {
  if (present_.command && handover_->relative()) return true;
  const bool unproved = handover_->acknowledge == Acknowledge::rise && was_acknowledged_;
  return !present_.twice && !unproved;
}

/// A set-point that is to count at once, with a drive that takes it whatever waits in its queue.
bool SetPointHandshake::replacesQueue() const {
  return handover_->queued && handover_->replaces_queue && pending_ && !next_.command;
}

/// The drive has taken a command, and takes the next one once there is room for it.
bool SetPointHandshake::waitsForRoom() const {
  return handover_->queued && present_.command && phase_ == Phase::lowered && !pending_;
}

bool SetPointHandshake::advance(const Input& input, Time now, Duration timeout) {
  acknowledged_ = input.acknowledged;
  const bool level = handover_->acknowledge == Acknowledge::level;
  switch (phase_) {
    case Phase::idle:
      if (!pending_) {
        timing_ = false;
        return true;
      }
      if (!timing_) enter(Phase::idle, 0, now);
      if (!level || !input.acknowledged || replacesQueue()) announce(input, now);
      break;
    case Phase::announced:
      if (pending_) {  // nothing has been handed over yet: the latest target wins
        announce(input, now);
      } else if (targetSent(input)) {
        raise(input, now);
      }
      break;
    case Phase::raised:
      raise(input, now);
      break;
    case Phase::lowered:
      if (replacesQueue() && input.acknowledged && sentLongEnough(input)) {
        announce(input, now);
      } else {
        lower(input, now);
      }
      break;
  }
  if (waitsForRoom()) since_ = now;
  if (!timing_ || now - since_ < timeout) return true;
  reset(present_.raw);
  return false;
}

const char* SetPointHandshake::waitingFor() const {
  switch (phase_) {
    case Phase::idle:
      return "statusword bit 12 (set-point acknowledge) to be 0";
    case Phase::announced:
      return "the target to be sent";
    case Phase::raised:
      return "statusword bit 12 (set-point acknowledge) to rise after the controlword that hands a "
             "set-point over";
    case Phase::lowered:
      return "statusword bit 12 (set-point acknowledge) to fall after that controlword";
  }
  return "";
}

}  // namespace cia402::drive
