// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// After a stop was asked for, the motor stands within its bound, whenever the call is answered.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr Duration kStands = 30ms;  // so long, for it is slow as well where it turns round

class SlowStops final : public Oracle {
 public:
  explicit SlowStops(const Stage& stage) : axes_(stage.axes().size()) {}
  const char* name() const override { return "slow_stop"; }

  void onCall(const Call& call, const View& view) override {
    static const std::set<std::string> kStops{"halt", "disable", "quick_stop", "shutdown"};
    for (std::size_t i : call.axes) {
      Axis& axis = axes_[i];
      if (call.verb == "home") axis.stop.reset();  // it may move again
      if (kStops.count(call.verb) == 0 || view.truths.empty()) continue;
      if (axis.stop && !axis.stop->disturbed) continue;  // the first one counts
      axis.stop = {call.verb, view.now, due(view, i), view.truths[i].velocity, false};
      axis.turned = view.now;
    }
  }

  void look(const View& view) override {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      if (axes_[i].stop) look(view, i);
    }
  }

 private:
  struct Stop {
    std::string verb;
    Time called{}, due{};
    double speed = 0.0;
    bool disturbed = false;
  };
  struct Axis {
    std::optional<Stop> stop;  // that was asked for and has not ended
    Time turned{};             // when it last did
  };

  /// By when it has to stand: what it may do before the stop has reached it, the time to stop, and
  /// the drives' own brakes.
  static Time due(const View& view, std::size_t i) {
    const AxisFacts& facts = view.stage.axes()[i];
    const AxisTruth& truth = view.truths[i];
    const Duration reached = 4 * view.stage.loaded().robot.bus.sync_period;
    const bool effort = facts.kind(truth.mode) == drive::ControlKind::torque;
    const double speed = std::fabs(truth.velocity) + facts.acceleration * toSeconds(reached);
    return view.now + reached + facts.stopTime(effort ? facts.velocity : speed);
  }

  void look(const View& view, std::size_t i) {
    const AxisFacts& facts = view.stage.axes()[i];
    const AxisTruth& truth = view.truths[i];
    Axis& axis = axes_[i];
    Stop& stop = *axis.stop;
    if (std::fabs(truth.velocity) > facts.creep()) axis.turned = view.now;
    const bool over = view.now - axis.turned >= kStands || !truth.power || truth.faulted() ||
                      view.permits.given(i) > stop.called + 2 * facts.config->cycle ||
                      !facts.config->limits.acceleration;
    if (over) {
      axis.stop.reset();
      return;
    }
    // What hinders the stop gives it its whole time anew.
    const bool heard = view.now >= view.conditions.axes[i].unheard;
    if (!view.conditions.quiet(i, view.now) || !heard) {
      stop.due = due(view, i);
      stop.disturbed = true;
    }
    if (view.now <= stop.due) return;
    report(view, i,
           "turns at " + number(truth.velocity) + " per s, though " + stop.verb +
               " was called at " + number(toSeconds(stop.called.time_since_epoch())) +
               " s, when it turned at " + number(stop.speed) + " per s");
    axis.stop.reset();
  }

  std::vector<Axis> axes_;
};

}  // namespace

std::unique_ptr<Oracle> makeSlowStops(const Stage& stage) {
  return std::make_unique<SlowStops>(stage);
}

}  // namespace cia402::campaign
