// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/bus_trouble.h"
#include "campaign/calls.h"
#include "campaign/drive_trouble.h"
#include "campaign/host_trouble.h"
#include "campaign/proof.h"
#include "campaign/runner.h"
#include "campaign/session.h"
#include "campaign/streams.h"
#include "campaign/trajectories.h"

namespace cia402::campaign {

/// Plays a scene: gives the commands of its history, disturbs what it disturbs, and lets the
/// oracles look at everything.
class Player : private Calls::Line {
 public:
  /// All must outlive it.
  Player(Stage& stage, const Scene& scene, const RunOptions& options);
  ~Player() override = default;

  /// To the end of the scene, or to a finding that ends it.
  /// @throws std::invalid_argument with the action that is none.
  void play();
  std::vector<Finding>& findings() { return session_.findings(); }
  /// Of all frames on the wire with their times.
  std::uint64_t fingerprint() const { return fingerprint_; }
  std::uint64_t frames() const { return frames_; }
  /// What the driver told of motors that run away, which none in a history does.
  const std::vector<std::string>& runaways() const { return runaways_; }
  const Permits& permits() const { return session_.permits; }

 protected:
  /// Gives a call to the driver; where a test can come between the two.
  void post(bus::Command command) override { session_.stage.host().post(std::move(command)); }
  /// The reply of a call on its way back.
  bus::Reply<> replied(bus::Reply<> reply) override { return reply; }

 private:
  void runTo(Time until);
  void stepTo(Time next);
  void look();
  void tellWatched() const;
  void act(const Action& action);
  bool actBy(const Words& words);
  void prove();
  void calm();
  void traceFrame(const can::Frame& frame) const;
  void onFrame(const can::Frame& frame, Time now);
  void onEvent(const bus::Event& event);

  const Scene& scene_;
  const RunOptions& options_;
  Session session_;
  Calls calls_;
  Streams streams_{session_};
  Trajectories trajectories_{session_};
  BusTrouble bus_{session_};
  HostTrouble host_{session_, calls_};
  DriveTrouble drives_{session_};
  Proof proof_;
  std::uint64_t fingerprint_ = 1469598103934665603U, frames_ = 0;
  std::vector<std::string> runaways_;
  Time looked_{};
  Duration taken_{};  ///< by proofs, in which the scene's own time stands still
};

}  // namespace cia402::campaign
