// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Plays one case of the matrix of stops in virtual time.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stops/stop_matrix.h"
#include "tools/virtual_host.h"

namespace cia402::stops {

/// What the motor did from the stop on, a sample a millisecond; rad, rad/s.
struct Trace {
  struct Sample {
    double position, velocity;
    bool power;
  };
  struct Answered {
    std::string call;
    std::size_t at;  ///< sample
    bool success, power;
    std::string message;
  };
  std::vector<Sample> samples;  ///< the first is that of the stop
  std::vector<Answered> answers;
  /// A set-point that was taken after the stop: position, or NaN.
  std::optional<double> taken;
  bool unanswered = false;  ///< a call was, by a process that lives
  std::string problem;      ///< why the case could not be played
};

/// A robot of one axis, its computer and their time.
class Play {
 public:
  Play(const LoadedRobot& loaded, const Case& tested)
      : loaded_(loaded),
        case_(tested),
        world_(loaded.robot.bus.bitrate, 1),
        host_(world_, loaded.robot, loaded.master) {
    const sim::SimulatedDrive& axis = loaded.drives.front();
    world_.addDrive(axis.name, axis.definition, axis.node, axis.mechanics[0], axis.identity);
    const drive::AxisConfig& config = loaded.robot.axes.front();
    const double ratio = config.profile->output_shaft ? 1.0 : config.geometry.gear_ratio;
    units_per_turn_ = 6.283185307179586 / ratio;
    host_.listen([this](const bus::Event& event) { told_ += event.text.str() + "\n"; });
  }

  Trace play() {
    if (!begin() || !speedUp()) {
      trace_.problem += "\n" + told_;
      return std::move(trace_);
    }
    begun_ = host_.now();
    look();
    stop();
    while (!over()) step();
    trace_.unanswered = asked_ > 0 && host_.running();
    return std::move(trace_);
  }
  const std::string& told() const { return told_; }

 private:
  static constexpr double kAtRest = 0.01;  // rad/s
  static constexpr Duration kQuiet{std::chrono::milliseconds(250)};
  static constexpr Duration kLongest{std::chrono::milliseconds(5000)};

  Duration since() const { return host_.now() - begun_; }

  bool begin() {
    world_.powerOn();
    host_.start();
    const bool ready = until([this] { return booted(); }, 12s);
    if (!ready) return fail("does not boot");
    const auto enabled = call(drive::ProcedureKind::enable, {});
    if (!until([&] { return enabled->has_value(); }, 4s)) return fail("enable is not answered");
    if (!(*enabled)->success) return fail((*enabled)->message);
    host_.advance(host_.now() + 60ms);
    trace_.answers.clear();
    return true;
  }
  bool fail(std::string why) {
    trace_.problem = std::move(why);
    return false;
  }
  bool booted() {
    return host_.running() && host_.network().axis(0).state().health == fieldbus::Health::ready;
  }

  /// Brings the axis to its speed, and to one moment of the cycle.
  bool speedUp() {
    const Mover& mover = *case_.mover;
    const Time from = host_.now();
    std::optional<Time> fast;
    // Near the limit of speed an effort gets less (AxisCore::guardSpeed).
    const double share = mover.motion == Motion::effort ? 0.85 : 0.97;
    begun_ = from;
    for (;;) {
      const Duration passed = host_.now() - from;
      if (passed > 4s) return fail("does not come to speed");
      if (mover.motion != Motion::goal || passed == 0ms) {
        if (!giveSetPoint(toSeconds(passed))) return false;
      }
      host_.advance(host_.now() + kCycle);
      if (case_.young > 0ms && host_.now() - from >= case_.young) return true;
      const bool effort = mover.motion == Motion::effort;  // gets faster on
      if (!fast && velocity() >= share * mover.speed) fast = host_.now();
      const Duration settling = effort ? 0ms : 24ms;
      if (fast && host_.now() - *fast >= settling) return true;
    }
  }
  bool giveSetPoint(double t) {
    const Mover& mover = *case_.mover;
    double value = mover.set_point;
    if (mover.motion == Motion::stream) {
      const double rate = 0.8 * mechanicsOf(mover.drive).acceleration;
      const double begin = mover.set_point / rate;
      value = t < begin ? 0.5 * rate * t * t : mover.set_point * (t - 0.5 * begin);
    }
    std::string refusal;
    setPoint(value, [&refusal](const std::string& why) { refusal = why; });
    host_.advance(host_.now());
    return refusal.empty() || fail(refusal);
  }
  template <class OnRefusal>
  void setPoint(double value, OnRefusal refused) {
    const auto reply = [refused](const bus::Answer& answer) { refused(answer.message); };
    host_.post(bus::Command(bus::SetpointCommand{0, value}, reply));
  }

  void stop() {
    switch (case_.stop) {
      case Stop::halt:
        (void)call(drive::ProcedureKind::halt, {});
        break;
      case Stop::quick_stop:
        (void)call(drive::ProcedureKind::quick_stop, {});
        break;
      case Stop::disable:
        (void)call(drive::ProcedureKind::disable, {});
        break;
      case Stop::empty_trajectory:
        stopGroup();
        break;
      case Stop::end_of_stream:
        break;
      case Stop::set_mode:
        (void)call(drive::ProcedureKind::set_mode, case_.mover->other_mode);
        break;
      case Stop::fault:
        inject(drive().braked_fault);
        break;
      case Stop::coasting_fault:
        inject(drive().coasting_fault);
        break;
      case Stop::shutdown:
        host_.stop();
        break;
      case Stop::host_death:
        host_.kill();
        break;
    }
  }

  void follow() {
    using drive::ProcedureKind;
    followed_ = true;
    switch (case_.follower) {
      case Follower::nothing:
        break;
      case Follower::halt:
        (void)call(ProcedureKind::halt, {});
        break;
      case Follower::quick_stop:
        (void)call(ProcedureKind::quick_stop, {});
        break;
      case Follower::disable:
        (void)call(ProcedureKind::disable, {});
        break;
      case Follower::set_mode:
        (void)call(ProcedureKind::set_mode, case_.mover->other_mode);
        break;
      case Follower::set_position:
        (void)call(ProcedureKind::set_position, {});
        break;
      case Follower::home:
        (void)call(ProcedureKind::home, {});
        break;
      case Follower::recover:
        (void)call(ProcedureKind::recover, {});
        break;
      case Follower::enable:
        (void)call(ProcedureKind::enable, {});
        break;
      case Follower::clear_faults:
        (void)call(ProcedureKind::clear_faults, {});
        break;
      case Follower::set_point:
        giveAnother();
        break;
      case Follower::fault:
        inject(drive().braked_fault != nullptr ? drive().braked_fault : drive().coasting_fault);
        break;
      case Follower::shutdown:
        if (host_.running()) host_.stop();
        break;
      case Follower::host_death:
        host_.kill();
        break;
      case Follower::restart:
        host_.start();
        break;
    }
  }
  /// The same velocity or effort again, or a position well ahead.
  void giveAnother() {
    const Mover& mover = *case_.mover;
    const bool position = mover.motion == Motion::stream || mover.motion == Motion::goal;
    const double value = position ? this->position() + 0.7 : mover.set_point;
    trace_.taken = value;
    setPoint(value, [this](const std::string&) { trace_.taken.reset(); });
  }

  std::shared_ptr<std::optional<bus::Answer>> call(drive::ProcedureKind kind,
                                                   const std::string& mode) {
    auto answer = std::make_shared<std::optional<bus::Answer>>();
    drive::ProcedureRequest request;
    request.kind = kind;
    request.mode = mode;
    request.position = 0.4;
    ++asked_;
    const auto reply = [this, answer, kind](const bus::Answer& given) {
      *answer = given;
      noteAnswer(drive::toString(kind), given.success, given.message);
    };
    host_.post(bus::Command(bus::ProcedureCommand{"joint", request}, reply));
    return answer;
  }
  /// Success is to say that the joint stands.
  void stopGroup() {
    const auto told = [this](bool stands, const std::string& message) {
      noteAnswer("empty_trajectory", stands, message);
    };
    bus::TrajectoryCommand command;
    command.group = "arm";
    command.ended = [told](const bus::TrajectoryOutcome& outcome) {
      told(outcome.message == "arm: stands", outcome.message);
    };
    ++asked_;
    host_.post(bus::Command(command, [this, told](const bus::TrajectoryAnswer& given) {
      if (given.success) return;
      told(false, given.message);
      trace_.problem = given.message;
    }));
  }
  void noteAnswer(const std::string& call, bool success, const std::string& message) {
    const std::size_t at = trace_.samples.empty() ? 0 : trace_.samples.size() - 1;
    const bool power = world_.drive(0).truth(host_.now()).power_stage_on;
    trace_.answers.push_back({call, at, success, power, message});
    --asked_;
  }
  const StopDrive& drive() const { return stopDrive(case_.mover->drive); }
  void inject(const char* fault) {
    const auto done = world_.drive(0).inject(fault, host_.now());
    if (!done) trace_.problem = done.error().message;
  }

  bool until(const std::function<bool()>& condition, Duration limit) {
    const Time end = host_.now() + limit;
    while (!condition()) {
      if (host_.now() >= end) return false;
      host_.advance(host_.now() + kCycle);
    }
    return true;
  }
  void step() {
    if (!followed_ && since() >= case_.after) follow();
    if (!stalled_ && case_.late > 0ms && since() >= case_.late_from) {
      stalled_ = true;
      host_.stall(case_.late);
    }
    host_.advance(host_.now() + 1ms);
    look();
  }
  void look() {
    trace_.samples.push_back(
        {position(), velocity(), world_.drive(0).truth(host_.now()).power_stage_on});
    if (std::fabs(velocity()) > kAtRest) moved_ = host_.now();
  }
  /// At rest for a while, and everything is answered.
  bool over() {
    if (since() > kLongest) return true;
    const bool answered = asked_ == 0 || !host_.running();
    const bool back = case_.follower != Follower::restart || booted();
    if (!answered || !back) quiet_from_ = host_.now();
    return since() > case_.late_from + case_.late + 50ms &&
           host_.now() - std::max(moved_, quiet_from_) > kQuiet;
  }
  double position() { return world_.drive(0).truth(host_.now()).position_turns * units_per_turn_; }
  double velocity() { return world_.drive(0).truth(host_.now()).velocity_turns * units_per_turn_; }

  const LoadedRobot& loaded_;
  Case case_;
  sim::World world_;
  tools::VirtualHost host_;
  double units_per_turn_ = 1.0;
  std::string told_;
  Trace trace_;
  Time begun_{}, moved_{}, quiet_from_{};
  int asked_ = 0;
  bool followed_ = false, stalled_ = false;
};

}  // namespace cia402::stops
