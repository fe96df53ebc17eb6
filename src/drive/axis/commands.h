// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cia402_driver/common/result.h"
#include "drive/modes/mode_control.h"

namespace cia402::drive {

/// Whose set-points an axis follows: a stream of commands, or somebody who gives one each cycle, a
/// trajectory. Nobody's command outlives a stop, another mode or another zero.
class Commands {
 public:
  explicit Commands(AxisBasis& axis) : axis_(axis) {}  ///< @param axis must outlive this

  /// Takes a streamed command in joint units for `mode`. @pre the axis takes set-points
  /// @return why not, in words
  Result<void> take(double value, ModeControl& mode, const SetPoint& sent, Time now);
  /// Why take() would refuse that now, in words; empty if it would not.
  std::string refusal(double value, const ModeControl& mode) const;
  /// Why the joint would be led elsewhere than to `value`: it is beyond a limit; empty: it is not.
  /// Of distances nothing is said. @param value finite
  std::string excess(double value, const ModeControl& mode) const;
  /// One cycle of the stream. @return whether it leads the axis, by what lead() gives
  bool leads(const SetPoint& sent) {
    stream_.clock += axis_.config.cycle;
    const bool ready = axis_.state.ready_for_motion && axis_.state.mode != nullptr;
    if (leader_ != nullptr || !ready) forget();
    if (leader_ != nullptr) return false;
    stream_.at_rest = sent.atRest();
    return stream_.command.has_value();
  }
  /// Its set-point of this cycle; nothing: none is given.
  std::optional<double> lead(ModeControl& mode, const SetPoint& sent, Time now);
  /// The stream ends: it was stopped, or its set-point was refused.
  void drop() { stream_.command.reset(); }
  /// The same where the mode or the zero is another: what ran dry is of no interest any more.
  void forget() {
    drop();
    stream_.dried_up = false;
  }

  /// Somebody gives the set-points of every cycle from now on, and streams are refused.
  /// @param who for messages, e.g. the name of a group; it must outlive that. nullptr: nobody
  void follow(const std::string* who) { leader_ = who; }
  const std::string* leader() const { return leader_; }
  const Stream& stream() const { return stream_; }

 private:
  void resume(ModeControl& mode, const SetPoint& sent, Time at);

  AxisBasis& axis_;
  Stream stream_;
  const std::string* leader_ = nullptr;
  std::uint32_t breaks_ = 0, interruptions_ = 0, given_up_ = 0;  ///< of the set-points, at resume()
};

}  // namespace cia402::drive
