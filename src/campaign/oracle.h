// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "campaign/conditions.h"
#include "campaign/permits.h"
#include "campaign/runner.h"
#include "campaign/stage.h"

namespace cia402::campaign {

/// A call of a service, as it was made.
struct Call {
  std::string verb, who, argument;  ///< mode of a set_mode, command of an nmt
  std::vector<std::size_t> axes;
  Time at{};
  Duration stalled{};        ///< Conditions::stalled at that time
  std::vector<int> modes{};  ///< of all axes at that time, as their drives show them
};

/// What an oracle may look at: motors, wire, what was commanded and answered, and what is wrong
/// with the world. Not the driver.
struct View {
  const Stage& stage;
  const std::vector<AxisTruth>& truths;
  const Permits& permits;
  const Conditions& conditions;
  Time now;
};

/// Judges one thing.
class Oracle {
 public:
  virtual ~Oracle() = default;
  /// Of the kind of its findings.
  virtual const char* name() const = 0;
  /// Every millisecond.
  virtual void look(const View&) {}
  virtual void onFrame(const can::Frame&, const View&) {}
  virtual void onCall(const Call&, const View&) {}
  virtual void onAnswer(const Call&, const bus::Answer&, const View&) {}

  void reportTo(std::vector<Finding>& findings) { findings_ = &findings; }

 protected:
  void report(const View& view, std::size_t axis, std::string text) {
    findings_->push_back({name(), view.stage.axes()[axis].name, std::move(text), view.now});
  }

 private:
  std::vector<Finding>* findings_ = nullptr;
};

/// "0.28 rad/s" and the like.
std::string number(double value);

// One of each kind; docs/campaign.md says what it judges.
std::unique_ptr<Oracle> makeCommandedMotion(const Stage& stage);
std::unique_ptr<Oracle> makeSlowStops(const Stage& stage);
std::unique_ptr<Oracle> makePowerOracle(const Stage& stage);
std::unique_ptr<Oracle> makeTargetSteps(const Stage& stage);
std::unique_ptr<Oracle> makeMotorLimits(const Stage& stage);
std::unique_ptr<Oracle> makeEffortLimits(const Stage& stage);
std::unique_ptr<Oracle> makeSnapshots(const Stage& stage);
std::unique_ptr<Oracle> makeFloats(const Stage& stage);
std::unique_ptr<Oracle> makeAnswers(const Stage& stage);
std::unique_ptr<Oracle> makeVainRequests(const Stage& stage);
std::unique_ptr<Oracle> makeTakenDrives(const Stage& stage);
/// All of them.
std::vector<std::unique_ptr<Oracle>> allOracles(const Stage& stage);

}  // namespace cia402::campaign
