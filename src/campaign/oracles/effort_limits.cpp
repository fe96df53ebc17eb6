// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// No motor is driven harder than its limit of effort, in whatever mode and however it stops.
#include <cmath>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

class EffortLimits final : public Oracle {
 public:
  explicit EffortLimits(const Stage&) {}
  const char* name() const override { return "effort_limit"; }

  void look(const View& view) override {
    for (std::size_t i = 0; i < view.truths.size(); ++i) {
      const AxisTruth& truth = view.truths[i];
      const AxisFacts& facts = view.stage.axes()[i];
      const std::optional<double>& limit = facts.config->limits.effort;
      if (!limit || !truth.power) continue;
      if (std::fabs(truth.effort) <= 1.02 * *limit + 2 * facts.effort_per_count) continue;
      report(view, i,
             "is driven with an effort of " + number(truth.effort) + ", its limit is " +
                 number(*limit));
    }
  }
};

}  // namespace

std::unique_ptr<Oracle> makeEffortLimits(const Stage& stage) {
  return std::make_unique<EffortLimits>(stage);
}

}  // namespace cia402::campaign
