// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/modes/cyclic_position.h"
#include "drive/modes/set_point_handshake.h"
#include "drive/profile/set_point_stream.h"

namespace cia402::drive {

/// Positions, a new one each cycle, along which the host leads the drive by set-points of its
/// profile position mode (SetPointStream): for drives that have no mode of operation for a stream
/// of positions.
///
/// Each set-point that the drive gets is where the stream comes to rest, by the ramp of a stop, if
/// nothing more is given. There such a drive stands when it hears nothing more; so a late cycle
/// ends a motion at that place. A stream at rest hands its place over twice and then nothing.
class PositionBySetPoints : public CyclicPosition {
 public:
  PositionBySetPoints(const ModeChannel& channel, const Context& context);
  void place() override;
  void reset(std::uint64_t raw) override;
  void offer(std::uint64_t raw, bool twice) override;
  const char* handOver(std::uint64_t& raw, Time now) override;
  bool handingOver() const override { return handshake_.busy(); }
  unsigned bits() const override { return CyclicPosition::bits() | handshake_.word(); }
  bool late(Time now) override;
  void rest() override { send({kUnknown, usual(), ramp_}); }  // counts in other modes, too

  /// It may set off once it has the set-point.
  bool goalAhead() const override { return handshake_.busy(); }
  bool mayTurnBack(Time now, Time seen_moving) const override {
    return handshake_.busy() || comesBack(now, seen_moving);
  }

 private:
  /// A set-point: rad or m, per s, and per s^2.
  struct Way {
    double target = kUnknown, speed = 0.0, deceleration = 0.0;
  };
  struct Taken {
    double position, velocity;
  };
  void watchStream();
  double velocityNow() const;
  Way ahead() const;
  Way wayToRest() const;
  bool yields() const;
  double awayFromDue() const;
  Taken taken() const;
  void limit(Way& way) const;
  double surelyStops(double speed) const;
  double fastest() const;
  double slowest() const;
  double usual() const;
  void stopWhereItGoes();
  void offerNext(Time now);
  void announced(Time now);
  void send(const ModeChannel::Offset& object, double value);
  void send(const Way& way);

  SetPointStream stream_;
  SetPointHandshake handshake_;
  double cycle_s_, ramp_;   ///< of a stop, rad/s^2 or m/s^2
  double period_s_;         ///< between set-points
  double reaction_s_;       ///< a motor that follows has moved on for so long when it acts
  double lead_s_;           ///< what a set-point has to last for
  Way offered_, coming_;    ///< to be announced to the drive; announced
  double held_ = kUnknown;  ///< the one that the drive has, or takes with the word that was sent
  double velocity_ = 0.0, acceleration_ = 0.0;  ///< of the stream, in the last cycle
  std::uint64_t rest_raw_ = 0;                  ///< where it rests, as the drive was told
  bool rests_ = true;                           ///< that was the last thing it was told
  bool called_back_ = false;                    ///< from wherever the drive has led it
  Time stops_after_ = kNever;  ///< feedback newer than this tells where it can stop
  Time next_ = Time::min();    ///< no set-point under way before
};

}  // namespace cia402::drive
