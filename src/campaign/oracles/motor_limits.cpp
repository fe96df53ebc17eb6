// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The motors keep the limits of velocity and acceleration.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kWindow = 20;  // ms over which acceleration is measured
constexpr Duration kSyncMemory = 30ms;
constexpr Duration kLate = 200us;  // a drive has come to its last set-point, and stops, for so long
constexpr Duration kLongestLag = 500ms;
constexpr Duration kUnseen = 200ms;  // a limit switch is seen within it, and set-points called back
constexpr Duration kLetGo = 60ms;    // a motor gets to where it was led against its limit switch
constexpr std::uint32_t kSync = 0x80;

class MotorLimits final : public Oracle {
 public:
  explicit MotorLimits(const Stage& stage) : axes_(stage.axes().size()) {
    for (const PdoPlace& place : stage.rpdos()) rpdos_.emplace(place.cob_id, place);
  }
  const char* name() const override { return "motor_limits"; }

  void onFrame(const can::Frame& frame, const View& view) override {
    if (frame.error) return;
    const auto [first, last] = rpdos_.equal_range(frame.id);
    for (auto rpdo = first; rpdo != last; ++rpdo) {
      if (isTarget(rpdo->second, view)) axes_[rpdo->second.axis].fed = true;
    }
    if (frame.id != kSync) return;
    // Without a set-point a drive stops where the last one was, as hard as it can.
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      Axis& axis = axes_[i];
      if (!axis.fed && needsTargets(view, i))
        axis.starved = view.now + view.stage.loaded().robot.bus.sync_period + kSyncMemory;
      axis.fed = false;
    }
    const Duration period = view.stage.loaded().robot.bus.sync_period;
    const Duration since = view.now - last_sync_;
    last_sync_ = view.now;
    if (since > period + kLate) starved_ = view.now + kSyncMemory;
    const double shorter = 1.0 - toSeconds(since) / toSeconds(period);
    if (shorter > 0.02) {
      squeeze_ = std::max(view.now < squeezed_ ? squeeze_ : 0.0, shorter);
      squeezed_ = view.now + kSyncMemory;
      if (shorter > 0.05) starved_ = squeezed_;
    }
  }
  void look(const View& view) override {
    for (std::size_t i = 0; i < axes_.size(); ++i) look(view, i);
  }

 private:
  struct Axis {
    std::array<double, kWindow> speeds{};
    std::size_t next = 0, count = 0;
    bool fed = false;     // with a target, since the last SYNC
    Time starved{};       // until then it lacks set-points
    Time last{};          // it may take no longer than that
    Time catches_up{};    // until then it makes good what that cost it
    Time held{};          // by a limit switch, since then; Time(): it is not
    Time pushed{};        // by an effort, until then
    Time let_go{};        // until then it goes to where it was led against the switch
    bool behind = false;  // its set-points, for some were lost; the drive cannot catch up
  };

  /// It follows a target from an RPDO; one that homes does not.
  bool needsTargets(const View& view, std::size_t i) const {
    return std::any_of(rpdos_.begin(), rpdos_.end(), [&](const auto& rpdo) {
      return rpdo.second.axis == i && isTarget(rpdo.second, view);
    });
  }

  /// The object is the target of the mode that its axis is in.
  static bool isTarget(const PdoPlace& place, const View& view) {
    const drive::DriveProfile& profile = *view.stage.axes()[place.axis].config->profile;
    const int mode = view.truths[place.axis].mode;
    for (const drive::ModeSpec& spec : profile.modes) {
      const drive::ObjectSpec* target = spec.value == mode ? profile.find(spec.target) : nullptr;
      if (target != nullptr && target->id == place.object) return true;
    }
    return false;
  }

  void look(const View& view, std::size_t i) {
    const AxisFacts& facts = view.stage.axes()[i];
    const AxisTruth& truth = view.truths[i];
    Axis& axis = axes_[i];
    const motion::JointLimits& limits = facts.config->limits;
    const bool judged = limits.velocity && limits.acceleration && truth.power &&
                        view.now >= view.conditions.axes[i].blocked &&
                        view.now >= view.conditions.lossy && view.now >= view.conditions.foreign &&
                        view.now >= view.conditions.axes[i].cut_off;
    const Duration period = view.stage.loaded().robot.bus.sync_period;
    if (view.now - last_sync_ > period + kLate || !judged) axis.starved = view.now + kSyncMemory;
    const bool by_float = facts.units_per_count == 0.0;  // it knows no limit switch
    const bool at_limit = !by_float && (truth.statusword & 0x0800) != 0;
    if (!at_limit) {
      if (axis.held != Time()) axis.let_go = view.now + kLetGo;
      axis.held = Time();
    } else if (axis.held == Time()) {
      axis.held = view.now;
    }
    const bool lags = catchesUp(view, axis, facts, truth);
    axis.behind =
        by_float && (!judged || lags || (axis.behind && std::fabs(truth.velocity) > facts.creep()));
    if (!judged) {
      axis.count = 0;
      return;
    }
    // SYNCs that follow each other too quickly make a drive do two steps in the time of one.
    const double squeeze = view.now < squeezed_ ? squeeze_ : 0.0;
    const double fastest = facts.velocity * (1.1 + squeeze) + 0.002;
    if (std::fabs(truth.velocity) > fastest && !lags) {
      report(
          view, i,
          "turns at " + number(truth.velocity) + " per s, its limit is " + number(facts.velocity));
    }
    // Nor is it limited where an effort is commanded: it follows from the load.
    // Another mode takes the motor over at a velocity that is up to two cycles old.
    if (facts.kind(truth.mode) == drive::ControlKind::torque) axis.pushed = view.now + 2 * period;
    const bool effort = view.now <= axis.pushed;
    // A limit switch stops a motor as hard as its drive can.
    if (lags || effort || at_limit || axis.behind) axis.count = 0;
    if (axis.count == kWindow && squeeze == 0.0) {
      const double rate = (truth.velocity - axis.speeds[axis.next]) / (kWindow * 0.001);
      // A quick stop may take twice the limit.
      if (std::fabs(rate) > 2.0 * facts.acceleration * 1.3 + 0.05 * facts.velocity / 0.02) {
        report(view, i,
               "changes its speed by " + number(rate) + " per s^2, its limit is " +
                   number(facts.acceleration));
      }
    }
    axis.speeds[axis.next] = truth.velocity;
    axis.next = (axis.next + 1) % kWindow;
    axis.count = std::min(axis.count + 1, kWindow);
  }

  /// A drive that lacked a set-point stops as hard as it can, and makes it good with all its
  /// effort; so does one that its limit switch lets go. One that has a fault meanwhile brakes.
  bool catchesUp(const View& view, Axis& axis, const AxisFacts& facts,
                 const AxisTruth& truth) const {
    const bool held = axis.held != Time() && view.now - axis.held < kUnseen;
    if (view.now < std::max({starved_, axis.starved, axis.let_go}) || held) {
      axis.catches_up = view.now + 20ms;
      axis.last = view.now + kLongestLag;
    }
    const double effort = facts.config->limits.effort.value_or(1e300);
    const bool brakes = (truth.statusword & 0x4F) == 0x0F;  // in a fault reaction, by its ramp
    if (view.now < axis.catches_up && (brakes || std::fabs(truth.effort) > 0.5 * effort)) {
      axis.catches_up = std::min(view.now + 50ms, axis.last);
    }
    return view.now < axis.catches_up;
  }

  std::vector<Axis> axes_;
  std::multimap<std::uint32_t, PdoPlace> rpdos_;  // by COB-ID
  Time last_sync_{}, squeezed_{}, starved_{};
  double squeeze_ = 0.0;
};

}  // namespace

std::unique_ptr<Oracle> makeMotorLimits(const Stage& stage) {
  return std::make_unique<MotorLimits>(stage);
}

}  // namespace cia402::campaign
