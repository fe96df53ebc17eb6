// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// No drive is taken out of operation while one of its motors has power: neither for the axis that
// is asked for, nor for another one in the same drive.
#include <optional>
#include <string>
#include <vector>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

class TakenDrives final : public Oracle {
 public:
  explicit TakenDrives(const Stage& stage) : operates_(stage.drives().size()) {
    powered_.resize(operates_.size());
  }
  const char* name() const override { return "drive_taken"; }

  void look(const View& view) override {
    for (std::size_t i = 0; i < operates_.size(); ++i) look(view, i);
  }

 private:
  void look(const View& view, std::size_t drive) {
    const std::vector<std::size_t>& axes = view.stage.drives()[drive].axes;
    const canopen::NmtState state = view.truths[axes.front()].nmt;
    const bool operates = state == canopen::NmtState::operational;
    const bool left = operates_[drive] && !operates;
    if (left && powered_[drive] && judged(view, *powered_[drive])) {
      report(view, *powered_[drive],
             std::string("has power when its drive is taken out of operation: it is ") +
                 canopen::toString(state));
    }
    operates_[drive] = operates;
    powered_[drive].reset();
    for (const std::size_t axis : axes) {
      if (view.truths[axis].power) powered_[drive] = axis;
    }
  }
  static bool judged(const View& view, std::size_t axis) {
    const Conditions::Axis& own = view.conditions.axes[axis];
    // An answer to guarding that was lost makes the next one void, whose toggle bit does not
    // alternate then (CiA 301, node guarding): what is lost of them counts for their life time.
    const Loaded& loaded = view.stage.loaded();
    const auto kind = loaded.robot.deviceOf(*view.stage.axes()[axis].config).error_control.kind;
    const bool guarded = kind == canopen::ErrorControl::guarding;
    const Duration life = guarded ? 3 * loaded.master.heartbeat : Duration();
    return view.now >= view.conditions.lossy + life && view.conditions.quiet(axis, view.now) &&
           view.now >= own.unheard && view.now >= own.may_coast &&
           view.now >= view.conditions.ended;
  }

  std::vector<bool> operates_;                       // of each drive, at the last look
  std::vector<std::optional<std::size_t>> powered_;  // an axis of it, likewise
};

}  // namespace

std::unique_ptr<Oracle> makeTakenDrives(const Stage& stage) {
  return std::make_unique<TakenDrives>(stage);
}

}  // namespace cia402::campaign
