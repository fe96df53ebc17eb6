// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// An axis moves only while something commands it.
#include <cmath>
#include <optional>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

class CommandedMotion final : public Oracle {
 public:
  explicit CommandedMotion(const Stage& stage) : rests_(stage.axes().size()) {}
  const char* name() const override { return "uncommanded_motion"; }

  void look(const View& view) override {
    for (std::size_t i = 0; i < rests_.size(); ++i) look(view, i);
  }

 private:
  void look(const View& view, std::size_t i) {
    const AxisTruth& truth = view.truths[i];
    const AxisFacts& facts = view.stage.axes()[i];
    // Without power nobody moves it: how it lost that is judged elsewhere.
    const bool judged = truth.power && !view.permits.allowed(i, view.now) &&
                        view.now >= view.conditions.axes[i].blocked;
    if (!judged) {
      rests_[i].reset();
      return;
    }
    if (!rests_[i]) rests_[i] = truth.position;
    const double travel = std::fabs(truth.position - *rests_[i]);
    if (travel <= 0.005 * facts.velocity + 3 * std::fabs(facts.units_per_count) + 1e-4) return;
    report(view, i,
           "has moved by " + number(travel) + " at " + number(truth.velocity) + " per s since " +
               number(toSeconds(view.permits.until(i).time_since_epoch())) +
               " s, when the last command that could move it had ended");
  }

  std::vector<std::optional<double>> rests_;
};

}  // namespace

std::unique_ptr<Oracle> makeCommandedMotion(const Stage& stage) {
  return std::make_unique<CommandedMotion>(stage);
}

}  // namespace cia402::campaign
