// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Streamed position targets on the wire step by no more than velocity limit times cycle. A frame
// that itself ends operation is no set-point: the drive does not follow the target in it. A target
// that is called back to where the motor stands, or stood when the drive last told of it, moves
// nothing either.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "campaign/oracle.h"
#include "sim/dictionary/axis_objects.h"

namespace cia402::campaign {
namespace {

constexpr const char* kMode = "cyclic_position";
constexpr fieldbus::ObjectId kTargetPosition{0x607A, 0}, kControlword{0x6040, 0};

class TargetSteps final : public Oracle {
 public:
  explicit TargetSteps(const Stage& stage) {
    for (const PdoPlace& place : stage.rpdos()) {
      const unsigned axis = stage.axes()[place.axis].place.axis;
      if (place.object == sim::ofAxis(kTargetPosition, axis)) targets_[place.cob_id] = place;
      if (place.object == sim::ofAxis(kControlword, axis)) controls_[place.cob_id] = place;
    }
    last_.resize(stage.axes().size());
    controlwords_.resize(stage.axes().size());
    stood_.resize(stage.axes().size());
    for (const AxisFacts& facts : stage.axes()) unsure_.push_back(facts.config->mode != kMode);
  }
  const char* name() const override { return "target_step"; }

  void onFrame(const can::Frame& frame, const View& view) override {
    if (frame.error || frame.remote) return;
    const auto control = controls_.find(frame.id);
    if (control != controls_.end() && frame.size >= control->second.byte + 2) {
      const unsigned byte = control->second.byte;
      controlwords_[control->second.axis] = frame.data[byte] | frame.data[byte + 1] << 8;
    }
    const auto found = targets_.find(frame.id);
    if (found == targets_.end()) return;
    const PdoPlace& place = found->second;
    if (frame.size < place.byte + 4) return;
    judge(view, place.axis, valueIn(frame, place, view.stage.axes()[place.axis]));
  }
  void onCall(const Call& call, const View&) override {
    if (call.verb != "set_mode" || call.argument == kMode) return;
    for (std::size_t i : call.axes) unsure_[i] = true;
  }
  void look(const View& view) override {
    for (std::size_t i = 0; i < last_.size(); ++i) {
      if (!streams(view, i)) last_[i].reset();
      const AxisTruth& truth = view.truths[i];
      if (std::fabs(truth.velocity) <= view.stage.axes()[i].creep()) {
        stood_[i] = {view.now, truth.told};
      }
    }
  }

 private:
  struct Stood {  ///< the last time that it did
    Time at{};
    double told = 0.0;
  };
  /// In joint units.
  static double valueIn(const can::Frame& frame, const PdoPlace& place, const AxisFacts& facts) {
    std::uint32_t raw = 0;
    for (unsigned i = 0; i < 4; ++i) {
      raw |= static_cast<std::uint32_t>(frame.data[place.byte + i]) << 8 * i;
    }
    if (facts.units_per_count != 0.0) {
      return facts.units_per_count * static_cast<double>(static_cast<std::int32_t>(raw));
    }
    float value = 0.0F;
    std::memcpy(&value, &raw, sizeof value);
    return static_cast<double>(value) * facts.config->geometry.direction;
  }
  /// Is it enabled in a mode in which a target counts at once?
  bool streams(const View& view, std::size_t i) const {
    const AxisFacts& facts = view.stage.axes()[i];
    const AxisTruth& truth = view.truths[i];
    const drive::DriveProfile& profile = *facts.config->profile;
    const drive::ModeSpec* mode = profile.mode(kMode);
    if (!facts.config->limits.velocity || !truth.enabled() || mode == nullptr ||
        truth.mode != mode->value)
      return false;
    // Where another mode has the same number, nobody may ever have asked for one.
    const auto same = [&](const drive::ModeSpec& other) { return other.value == mode->value; };
    return !unsure_[i] || std::count_if(profile.modes.begin(), profile.modes.end(), same) == 1;
  }
  /// Integers of 32 bits count on from their lowest number where they end.
  static double distance(double a, double b, const AxisFacts& facts) {
    constexpr double kNumbers = 4294967296.0;
    if (facts.units_per_count == 0.0) return std::fabs(a - b);
    return std::fabs(std::remainder(a - b, kNumbers * facts.units_per_count));
  }
  bool operates(std::size_t i) const { return (controlwords_[i] & 0x8F) == 0x0F; }
  void judge(const View& view, std::size_t i, double value) {
    if (!streams(view, i) || !operates(i)) {
      last_[i].reset();
      return;
    }
    const AxisFacts& facts = view.stage.axes()[i];
    const double step = last_[i] ? distance(value, *last_[i], facts) : 0.0;
    const double allowed = 1.02 * facts.velocity * toSeconds(facts.config->cycle) +
                           2 * std::fabs(facts.units_per_count) + 1e-6 * std::fabs(value);
    // It is told of in one cycle, and called back in the next.
    const bool stands_as_told = view.now - stood_[i].at <= 2 * facts.config->cycle;
    const double told = view.truths[i].told;
    const bool called_back = stands_as_told && std::min(std::fabs(value - stood_[i].told),
                                                        std::fabs(value - told)) <= allowed;
    if (last_[i] && !(step <= allowed) && !called_back) {
      report(view, i,
             "is sent a target that steps by " + number(step) + " in one cycle, " +
                 number(step / allowed) + " times what its velocity limit allows");
    }
    last_[i] = value;
  }

  std::map<std::uint32_t, PdoPlace> targets_, controls_;  // by COB-ID
  std::vector<int> controlwords_;
  std::vector<Stood> stood_;
  std::vector<bool> unsure_;  // another mode than kMode was asked for at some time
  std::vector<std::optional<double>> last_;
};

}  // namespace

std::unique_ptr<Oracle> makeTargetSteps(const Stage& stage) {
  return std::make_unique<TargetSteps>(stage);
}

}  // namespace cia402::campaign
