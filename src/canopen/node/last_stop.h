// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "can/bus.h"
#include "can/frame.h"
#include "canopen/config.h"
#include "canopen/nmt/nmt.h"
#include "canopen/pdo/image.h"
#include "canopen/sdo/client.h"

namespace cia402::canopen {

/// Stops a node that was lost. It may hear though it is not heard, and go on with its homing or its
/// last set-point; and each frame may be lost. So it is told more than once: first to stop the
/// motor (the writes of StartupWrite::always, by SDO, no answer is waited for), as a stopped node
/// takes no SDO any more and not every drive stops its motor on NMT stop; then NMT stop, quickly at
/// first, for three seconds in all. Where that stop would only let the motor go (BootBrake), the
/// mode that brakes comes first, by PDO as well where it is mapped.
class LastStop {
 public:
  /// All must outlive it.
  LastStop(const NodeConfig& config, SdoClient& sdo, can::Sink& sink)
      : config_(config), sdo_(sdo), sink_(sink) {}

  /// The node is about to be forgotten. @param image what it has told, and was sent, last; of the
  /// outputs those that stop the motor are set.
  void remember(PdoImage& image);
  /// It has rebooted: its PDOs need not be those of its last set-points any more.
  void forgetSetPoints() {
    takes_over_.clear();
    set_points_.clear();
  }
  /// No axis was told to be in a mode whose stop only lets its motor go, or may be in one untold.
  bool ramps() const { return ramps_; }
  /// The node was lost just now; its SDO transfers have ended.
  void begin(Time now);
  /// It is there again, or somebody else decides.
  void end() {
    next_ = kNever;
    besides_ = 0;
    taken_over_ = false;
    asked_since_.reset();
  }
  void tick(Time now);
  Time deadline() const { return next_; }
  /// When it is told to stop for the last time at the latest: what wakes it must wait so long.
  Time over() const { return next_ == kNever ? Time() : end_; }
  /// A heartbeat tells the node's state. @return true: it has not stopped yet, it is told again at
  /// once, and shall not be booted before it has or its time is up (0.5 s after the loss).
  bool insists(NmtState state, Time now);
  /// Tells it once to stop its motor; no answer is waited for. @return false if there is nothing
  /// that could be written.
  bool stopMotor();
  /// The same as often as its heartbeat comes while it is asked whether its motor turns; seldom
  /// after a few times, for each makes the question wait for one more answer of the drive. One that
  /// answers no SDO hears PDOs: after 50 ms it gets its last set-points once more, with what stops
  /// the motor among them. Where that would only let the motor go it is told nothing for 50 ms,
  /// then the mode that brakes, and with the next heartbeat to stop; in a mode that is not known,
  /// nothing at all. @param heard by that heartbeat: one that has left operational by itself has to
  /// be started (NMT) for PDOs.
  void stopBesides(NmtState heard, Time now);

 private:
  void restart(Time now);
  bool brake();
  void rememberSetPoints(PdoImage& image, const std::vector<const BootBrake*>& pushing);
  /// @return false: it has no PDOs that would stop it
  bool startForPdos(NmtState heard);

  struct ModeWrite {
    ObjectId object;
    Bytes data;
  };
  const NodeConfig& config_;
  SdoClient& sdo_;
  can::Sink& sink_;
  std::vector<ModeWrite> brakes_;  ///< of what turned as it was told last
  bool ramps_ = false;             ///< the stop does; see ramps()
  bool known_ = false;             ///< the modes of all axes are
  unsigned braked_ = 0;            ///< since it began, or began again; said_ likewise
  unsigned said_ = 0;
  std::vector<can::Frame> takes_over_;  ///< its last set-points, but with the mode that brakes, ...
  std::vector<can::Frame> set_points_;  ///< ... and these with its motor stopped
  unsigned besides_ = 0;
  bool taken_over_ = false;  ///< by that mode, besides the questions
  std::optional<Time> asked_since_;
  Time besides_at_{};
  Time next_ = kNever, last_{}, patience_end_{}, end_{};
};

}  // namespace cia402::canopen
