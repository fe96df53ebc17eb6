// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the driver shows of an axis agrees with its drive.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMemory = 60;  // ms: two of the longest cycles, their frames, and a filter
constexpr int kEvery = 10;           // looks
/// Looks. Drives smooth the velocity that they show: of those that are simulated NiMotion's does it
/// by the longest time, 2008:04 from power-on.
constexpr double kDisplayFilter = 25.0;

class Snapshots final : public Oracle {
 public:
  explicit Snapshots(const Stage& stage) : axes_(stage.axes().size()) {}
  const char* name() const override { return "untrue_snapshot"; }

  void onCall(const Call& call, const View& view) override { count(call, 1, view); }
  void onAnswer(const Call& call, const bus::Answer&, const View& view) override {
    count(call, -1, view);
  }
  /// A drive may be enabled, or in a fault, for less than the time from look to look, and tell it.
  void onFrame(const can::Frame& frame, const View& view) override {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const PdoPlace* const place = view.stage.statusword(i);
      if (place == nullptr || !place->isIn(frame, 2)) continue;
      AxisTruth told;
      told.statusword =
          static_cast<std::uint16_t>(frame.data[place->byte] | frame.data[place->byte + 1] << 8);
      rememberState(axes_[i], told, view.now);
    }
  }
  void look(const View& view) override {
    for (std::size_t i = 0; i < axes_.size(); ++i) remember(view, i);
    if (++looks_ % kEvery != 0) return;
    for (std::size_t i = 0; i < axes_.size(); ++i) judge(view, i);
  }

 private:
  struct Axis {
    std::array<double, kMemory> speeds{}, smoothed{};
    double smooth = 0.0;  // as a drive shows it that smooths what it shows
    std::size_t next = 0, count = 0;
    Time enabled{-1h}, not_enabled{-1h}, faulted{-1h}, sound{-1h}, moved{-1h};
    int calls = 0;               // under way that may set a new zero
    Time called{-1h};            // the last of them began or ended: the drive's news is on its way
    std::optional<double> zero;  // what is shown minus what the drive tells
  };

  void count(const Call& call, int step, const View& view) {
    static const char* const kHarmless[] = {"halt",       "enable",       "disable",
                                            "quick_stop", "clear_faults", "read"};
    const auto* const end = std::end(kHarmless);
    if (std::find(std::begin(kHarmless), end, call.verb) != end) return;
    for (std::size_t i : concerned(view.stage, call)) {
      axes_[i].calls += step;
      axes_[i].called = view.now;
      axes_[i].zero.reset();
    }
  }
  /// What is done to a drive may set a zero of all its axes.
  static std::set<std::size_t> concerned(const Stage& stage, const Call& call) {
    static const std::set<std::string> kOfDrive{"recover", "save", "restore", "nmt"};
    std::set<std::size_t> concerned(call.axes.begin(), call.axes.end());
    if (kOfDrive.count(call.verb) == 0) return concerned;
    for (std::size_t i : call.axes) {
      concerned.insert(stage.inDriveOf(i).begin(), stage.inDriveOf(i).end());
    }
    return concerned;
  }
  static void rememberState(Axis& axis, const AxisTruth& truth, Time now) {
    (truth.enabled() ? axis.enabled : axis.not_enabled) = now;
    (truth.faulted() ? axis.faulted : axis.sound) = now;
  }
  void remember(const View& view, std::size_t i) {
    const AxisTruth& truth = view.truths[i];
    Axis& axis = axes_[i];
    axis.smooth += (truth.velocity - axis.smooth) / kDisplayFilter;
    axis.speeds[axis.next] = truth.velocity;
    axis.smoothed[axis.next] = axis.smooth;
    axis.next = (axis.next + 1) % kMemory;
    axis.count = std::min(axis.count + 1, kMemory);
    rememberState(axis, truth, view.now);
    if (std::fabs(truth.velocity) > 1e-4) axis.moved = view.now;
    const bool sound = view.conditions.quiet(i, view.now) && view.now >= view.conditions.ended &&
                       truth.nmt == canopen::NmtState::operational &&
                       view.stage.driver() != nullptr;
    if (view.stage.driver() == nullptr) axis.calls = 0;
    if (!sound) {
      axis.count = 0;
      axis.zero.reset();
    }
  }
  void judge(const View& view, std::size_t i) {
    Axis& axis = axes_[i];
    if (axis.count < kMemory) return;
    const drive::AxisState& shown = view.stage.driver()->axis(i).state();
    const bool enabled = shown.state == drive::State::operation_enabled;
    const bool fault = shown.state == drive::State::fault;
    if (enabled && !lately(view, axis.enabled)) report(view, i, "is shown enabled, and is not");
    if (fault && !lately(view, axis.faulted)) report(view, i, "is shown in a fault, and has none");
    const bool known = shown.state != drive::State::unknown;
    if (known && !enabled && !lately(view, axis.not_enabled)) {
      report(view, i, "is enabled, and is not shown so");
    }
    if (known && !drive::isFault(shown.state) && !lately(view, axis.sound)) {
      report(view, i, "is in a fault, and is not shown so");
    }
    judgeSpeed(view, i, shown);
    judgePlace(view, i, shown);
  }
  void judgeSpeed(const View& view, std::size_t i, const drive::AxisState& shown) {
    const Axis& axis = axes_[i];
    const AxisFacts& facts = view.stage.axes()[i];
    const auto [slowest, fastest] = std::minmax_element(axis.speeds.begin(), axis.speeds.end());
    const auto [low, high] = std::minmax_element(axis.smoothed.begin(), axis.smoothed.end());
    const double least = std::min(*slowest, *low), most = std::max(*fastest, *high);
    const double margin = 0.1 * facts.velocity + 0.05 * (most - least);
    if (shown.velocity < least - margin || shown.velocity > most + margin) {
      report(view, i,
             "is shown at " + number(shown.velocity) + " per s, and has turned at " +
                 number(*slowest) + " to " + number(*fastest) + " of late");
    }
  }
  /// While it stands, what is shown differs from 6064h by the same zero, until that is set anew.
  void judgePlace(const View& view, std::size_t i, const drive::AxisState& shown) {
    Axis& axis = axes_[i];
    if (lately(view, axis.moved) || lately(view, axis.called)) return;
    if (axis.calls > 0 || !shown.feedback_valid) return;
    const AxisFacts& facts = view.stage.axes()[i];
    const double zero = shown.position - view.truths[i].told;
    const double margin = 2 * std::fabs(facts.units_per_count) + 1e-5;
    // A joint that turns on and on goes beyond the 32 bits of its drive.
    const double range = 4294967296.0 * std::fabs(facts.units_per_count);
    const double moved = axis.zero ? zero - *axis.zero : 0.0;
    const double off = range > 0.0 ? std::remainder(moved, range) : moved;
    if (std::fabs(off) > margin) {
      report(view, i,
             "is shown at " + number(shown.position) + ", which is " + number(off) +
                 " off what its drive tells, and nobody has set a new zero");
    }
    if (!axis.zero) axis.zero = zero;
  }
  static bool lately(const View& view, Time time) { return view.now - time <= 60ms; }

  std::vector<Axis> axes_;
  int looks_ = 0;
};

}  // namespace

std::unique_ptr<Oracle> makeSnapshots(const Stage& stage) {
  return std::make_unique<Snapshots>(stage);
}

}  // namespace cia402::campaign
