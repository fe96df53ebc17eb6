// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/follow_watch.h"

#include <cmath>

namespace cia402::drive {
namespace {

/// Set-points that run while the motor stands are called back after so long; sooner where the drive
/// itself says that it does not follow.
constexpr Duration kLeftBehind{std::chrono::milliseconds(150)},
    kHeld{std::chrono::milliseconds(60)};
/// A drive that goes to a goal by itself, and stands at a limit on the way, gets so long.
constexpr Duration kStuck{std::chrono::milliseconds(300)};
/// One that says nothing of what is in its way gets so long to set off.
constexpr Duration kSetsOff{std::chrono::seconds(1)};

/// The drive says by the bit of its mode that the motor stays behind. It may do no more than that.
bool tellsFollowingError(const AxisState& state) {
  if (state.mode == nullptr || state.mode->kind != ControlKind::position) return false;
  const std::optional<int>& bit = state.mode->following_error_bit;
  return bit && ((static_cast<unsigned>(state.statusword) >> *bit) & 1u) != 0;
}

}  // namespace

void FollowWatch::begin(Time when) {
  began_ = when;
  end();
  follows_ = shown_ = told_ = excused_ = false;
}

void FollowWatch::lookForBit(const Look& look, Time now) {
  if (!look.has_bit) {
    began_ = now;  // another mode may have one, and is waited for then
    follows_ = true;
    return;
  }
  shown_ = look.bit;
  excused_ = excused_ || look.held;
  const bool late = now - began_ >= kFollowPatience;
  if (shown_) {
    never_shown_ = false;
  } else if (late && !excused_) {
    never_shown_ = true;
  }
  follows_ = shown_ || late || never_shown_;
}

bool FollowWatch::watchStanding(const Look& look, Time now) {
  const bool turns = look.sent.kind() == SetPointKind::velocity;
  const double ahead = turns ? 0.0 : look.sent.value() - look.state.position;
  const bool streams = turns || look.sent.kind() == SetPointKind::stream;
  if (staysApart(look, ahead, now)) return true;
  const bool runs = streams && std::fabs(look.sent.velocity()) > clearly_;
  if (!runs) {
    running_since_ = kNever;
    const bool held = look.warned || look.state.internal_limit || tellsFollowingError(look.state);
    return (held && restsAhead(look, ahead, now)) ||
           (look.sent.kind() == SetPointKind::goal && goesNowhere(look, ahead, now));
  }
  if (running_since_ == kNever) running_since_ = now;
  return runsAway(look, ahead, now);
}

bool FollowWatch::runsAway(const Look& look, double ahead, Time now) const {
  const bool limit = look.state.internal_limit;
  // What turns back towards a motor that is held would meet it at speed.
  const bool returns =
      ahead * look.sent.velocity() < 0.0 &&
      std::fabs(ahead) > 2 * std::fabs(look.sent.velocity()) * toSeconds(reaction_);
  if (returns && (limit || told_)) return true;
  const bool dropped = shown_ && look.has_bit && !look.bit;
  const bool stands =
      look.standstill.still() && look.standstill.stillFrom() >= running_since_ + reaction_;
  if (limit || dropped) return stands && now - running_since_ >= kHeld;
  // A velocity winds nothing up: a load that it cannot turn is no reason to give it up.
  const bool position = look.sent.kind() == SetPointKind::stream;
  return position && stands && now - running_since_ >= kLeftBehind;
}

bool FollowWatch::apart(const Look& look, double ahead) const {
  return std::fabs(ahead) > clearly_ * toSeconds(kHeld) && look.standstill.still();
}

/// A stream that pauses, or creeps, goes on from as far ahead of a motor that is held.
bool FollowWatch::staysApart(const Look& look, double ahead, Time now) {
  const bool stream = look.sent.kind() == SetPointKind::stream;
  if (!stream || !look.state.internal_limit || !apart(look, ahead)) {
    apart_since_ = kNever;
    return false;
  }
  if (apart_since_ == kNever) apart_since_ = now;
  return look.standstill.stillFrom() >= apart_since_ + reaction_;
}

/// A drive that goes to its goal by itself, and has no bit to say that it stays behind.
bool FollowWatch::goesNowhere(const Look& look, double ahead, Time now) {
  const ModeSpec* mode = look.state.mode;
  const bool silent = mode != nullptr && mode->target_reached_bit && !mode->following_error_bit;
  const bool rests = silent && !look.handing_over && now >= look.sent.movedAt() + kSetsOff &&
                     restsAhead(look, ahead, now);
  if (!rests) rests_since_ = kNever;
  if (rests && rests_since_ == kNever) rests_since_ = now;
  return rests && now - rests_since_ >= kStuck;
}

bool FollowWatch::restsAhead(const Look& look, double ahead, Time now) const {
  if (!apart(look, ahead)) return false;
  const Time moved = look.sent.movedAt();
  if (look.sent.kind() == SetPointKind::stream) return look.sent.atRest() && now >= moved + kHeld;
  return look.sent.kind() == SetPointKind::goal && look.state.ready_for_motion &&
         (look.warned || !look.state.target_reached) && now >= moved + kStuck;
}

}  // namespace cia402::drive
