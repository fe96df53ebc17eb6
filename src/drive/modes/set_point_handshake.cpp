// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/set_point_handshake.h"

#include <utility>

namespace cia402::drive {
namespace {
constexpr std::uint64_t kPulseFrames = 2;  // a pulse without acknowledge is at least this long
}  // namespace

void SetPointHandshake::offer(std::uint64_t raw, bool twice) {
  next_ = raw;
  next_twice_ = twice;
  pending_ = true;
}

void SetPointHandshake::reset(std::uint64_t raw) {
  *this = SetPointHandshake();
  raw_ = raw;
}

void SetPointHandshake::enter(Phase phase, std::uint64_t frames, Time now) {
  phase_ = phase;
  frames_ = frames;
  since_ = now;
  timing_ = true;
}

/// The target leaves, the edge follows.
void SetPointHandshake::announce(const Input& input, Time now) {
  raw_ = next_;
  again_ = next_twice_;
  pending_ = false;
  enter(Phase::announced, input.target_frames, now);
}

bool SetPointHandshake::advance(const Input& input, Time now, Duration timeout) {
  switch (phase_) {
    case Phase::idle:
      if (!pending_) {
        timing_ = false;
        return true;
      }
      if (!timing_) enter(Phase::idle, 0, now);
      if (!input.has_acknowledge || !input.acknowledged) announce(input, now);
      break;
    case Phase::announced:
      if (pending_) {  // nothing has been handed over yet: the latest target wins
        announce(input, now);
      } else if (input.target_frames > frames_) {
        enter(Phase::raised, input.controlword_frames, now);
      }
      break;
    case Phase::raised:
      if (input.has_acknowledge ? input.acknowledged
                                : input.controlword_frames >= frames_ + kPulseFrames) {
        enter(Phase::lowered, input.controlword_frames, now);
      }
      break;
    case Phase::lowered:
      if (input.has_acknowledge ? !input.acknowledged && input.controlword_frames > frames_
                                : input.controlword_frames >= frames_ + kPulseFrames) {
        phase_ = Phase::idle;
        timing_ = false;
        if (std::exchange(again_, false)) enter(Phase::announced, 0, now);
      }
      break;
  }
  if (!timing_ || now - since_ < timeout) return true;
  reset(raw_);
  return false;
}

const char* SetPointHandshake::waitingFor() const {
  switch (phase_) {
    case Phase::idle:
      return "statusword bit 12 (set-point acknowledge) to be 0";
    case Phase::announced:
      return "the target to be sent";
    case Phase::raised:
      return "statusword bit 12 (set-point acknowledge) to rise after the edge of controlword bit "
             "4";
    case Phase::lowered:
      return "statusword bit 12 (set-point acknowledge) to fall after controlword bit 4";
  }
  return "";
}

}  // namespace cia402::drive
