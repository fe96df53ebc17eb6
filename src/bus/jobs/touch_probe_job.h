// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "bus/jobs/bit_change.h"
#include "bus/jobs/job.h"
#include "bus/jobs/object_claims.h"
#include "bus/reply.h"

namespace cia402::bus {

class AxisCycle;

/// What a touch probe has stored: rad or m, NaN where nothing was.
struct TouchProbeAnswer : Answer {
  double rising = std::numeric_limits<double>::quiet_NaN();
  double falling = std::numeric_limits<double>::quiet_NaN();
};

/// Arms a touch probe of a drive and waits until it has stored a position.
struct ArmTouchProbeCommand {
  using Answer = TouchProbeAnswer;
  std::string axis;
  unsigned probe = 1;        ///< 1 or 2
  std::string edge;          ///< "rising", "falling", "both": it waits for each
  bool index_pulse = false;  ///< of the encoder, instead of the probe's input
  bool continuous = false;   ///< it stays armed after that
  double timeout = 0.0;      ///< s, above 0, at most 600

  void begin(AxisCycle& cycle, const Reply<TouchProbeAnswer>& reply, Time now) const;
};

/// An edge that is waited for, and what is known of it.
struct ProbeEdge {
  bool wanted = false;
  bool old = false;  ///< was stored before it was armed, and is shown ever since
  bool stored = false;
  const drive::ObjectSpec* position = nullptr;
  const drive::ObjectSpec* counter = nullptr;  ///< nullptr: there is none
  std::uint64_t count = 0;                     ///< of `counter`, before it was armed
  double joint = std::numeric_limits<double>::quiet_NaN();
};

/// Has a touch probe store positions (CiA 402-2, 60B8h to 60BDh): disarms it, so that it forgets
/// what it has stored before, arms it, waits for its edges, reads the positions and disarms it. An
/// edge that is still shown as stored when it is armed counts once it was shown otherwise, or once
/// its counter has gone on. Moves nothing.
class TouchProbeJob final : public Job {
 public:
  using Edges = std::array<ProbeEdge, 2>;  // rising, falling

  /// @param axis, @param claims must outlive it. @param claim of the probe. @param edges of the
  /// profile, those that are wanted. @pre the profile has touch probes
  TouchProbeJob(drive::Axis& axis, ObjectClaims& claims, const ArmTouchProbeCommand& command,
                ObjectClaims::Claim claim, const Edges& edges, Reply<TouchProbeAnswer> reply,
                Time now);

  bool step(Time now) override;
  void abandon(const std::string& why) override;

 private:
  enum class Stage : std::uint8_t {
    disarming,   ///< its bits of 60B8h become 0
    clearing,    ///< waits until 60B9h shows nothing any more
    counting,    ///< where it goes on to: how many edges there were
    arming,      ///< its bits of 60B8h
    watching,    ///< waits for 60B9h
    recounting,  ///< of edges that were shown before
    reading,     ///< 60BAh to 60BDh
    releasing,   ///< disarms at the end
    ended,
  };

  void watch(Time now);
  void change(Stage stage, std::uint64_t bits);
  void stepChange(Time now);
  void afterChange(const std::string& problem, Time now);
  void ask(Stage stage, const drive::ObjectSpec& object, Time due);
  bool askOfEdge(Stage stage, std::size_t first, Time now);
  void stepTransfer(Time now);
  void take(std::uint64_t raw, Time now);
  void takeCleared(std::uint64_t status, Time now);
  void takeStatus(std::uint64_t status);
  void judge(Time now);
  void endRead();
  bool shown(std::uint64_t status, std::size_t edge) const;
  void end(bool success, const std::string& why);
  std::string lateText() const;
  TouchProbeAnswer answer() const;

  drive::Axis* axis_;
  ObjectClaims* claims_;
  ObjectClaims::Claim probe_, bits_claim_;
  Reply<TouchProbeAnswer> reply_;
  const drive::ObjectSpec *function_, *status_;
  Edges edges_;
  std::size_t edge_ = 0;     ///< the one that is asked for
  unsigned number_ = 1;      ///< of the probe
  std::uint64_t armed_for_;  ///< its bits of 60B8h, as those of probe 1
  bool armed_ = false, late_ = false, success_ = false;
  Stage stage_ = Stage::disarming;
  std::uint64_t bits_ = 0, seen_status_ = 0;
  std::optional<BitChange> change_;
  const drive::ObjectSpec* object_ = nullptr;  ///< that is asked for, at `due_`
  fieldbus::Ticket ticket_;
  Time due_{}, clear_until_{}, deadline_;
  double timeout_;
  std::uint32_t boot_ups_, zero_changes_;
  std::string why_, remark_;
};

}  // namespace cia402::bus
