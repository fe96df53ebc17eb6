// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The power stage is neither switched off nor on while the motor turns.
#include <algorithm>
#include <cmath>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

class Power final : public Oracle {
 public:
  explicit Power(const Stage& stage) : before_(stage.axes().size()) {}
  const char* name() const override { return "power_at_speed"; }

  void look(const View& view) override {
    for (std::size_t i = 0; i < before_.size(); ++i) {
      const AxisTruth& truth = view.truths[i];
      const AxisFacts& facts = view.stage.axes()[i];
      const bool fast = std::fabs(truth.velocity) > 0.05 * facts.velocity + 0.005;
      if (fast && before_[i] && !truth.power && !mayCoast(view, i)) {
        report(view, i, "lost its power at " + number(truth.velocity) + " per s and coasts");
      }
      if (fast && !before_[i] && truth.power) {
        report(view, i, "was switched on while it coasted at " + number(truth.velocity) + " per s");
      }
      before_[i] = truth.power;
    }
  }

 private:
  /// Some drives let the motor go where they miss their master or SYNC, or at a limit switch.
  static bool mayCoast(const View& view, std::size_t i) {
    const AxisTruth& truth = view.truths[i];
    const AxisFacts& facts = view.stage.axes()[i];
    if (view.now < view.conditions.axes[i].may_coast) return true;
    const Conditions& world = view.conditions;
    // Held fast in a stop and let go, a rotor leaps, faster than it was: no stop seems to brake it.
    if (view.now < world.axes[i].blocked) return true;
    const bool misses_master =
        view.now < world.foreign || view.now < world.host_late || view.now < world.axes[i].cut_off;
    if (misses_master && facts.watches_master && fades(truth, facts)) return true;
    if (!truth.faulted()) return false;
    return (facts.loss_coasts && !world.quiet(i, view.now)) ||
           (facts.limit_coasts && truth.at_switch);
  }

  /// In a mode in which the drive's own stop, as it misses its master, only lets the torque go.
  static bool fades(const AxisTruth& truth, const AxisFacts& facts) {
    const auto& modes = facts.config->profile->modes;
    return std::any_of(modes.begin(), modes.end(), [&](const drive::ModeSpec& mode) {
      return mode.value == truth.mode && mode.stop == drive::StopBy::mode;
    });
  }

  std::vector<bool> before_;
};

}  // namespace

std::unique_ptr<Oracle> makePowerOracle(const Stage& stage) {
  return std::make_unique<Power>(stage);
}

}  // namespace cia402::campaign
