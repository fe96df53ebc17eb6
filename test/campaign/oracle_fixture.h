// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "campaign/oracle.h"
#include "folders.h"

namespace cia402::campaign {

/// a1 has all limits: 1 rad/s, 4 rad/s², 10 N m. A count is 2 pi / (50 * 4096) = 3.068e-5 rad, a
/// thousandth of its rated torque 0.05 N m. a2 has no limits. a3 takes floats and has the limits of
/// a1, but 5 N m; its direction is the other one.
inline constexpr char kJudgedRobot[] = R"(
bus: {interface: can0, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}
axes:
  a1: {node_id: 1, drive: generic_cia402, mode: cyclic_position, modes: [cyclic_position, cyclic_torque],
    counts_per_turn: 4096, gear_ratio: 50.0, rated_torque: 1.0,
    limits: {lower: -3, upper: 3, velocity: 1, acceleration: 4, effort: 10}}
  a2: {node_id: 2, drive: generic_cia402, mode: cyclic_position, counts_per_turn: 4096, gear_ratio: 50.0}
  a3: {node_id: 3, drive: damiao_dm, mode: cyclic_position, direction: -1,
    limits: {lower: -3, upper: 3, velocity: 1, acceleration: 4, effort: 5}}
)";

/// Each is read once: that takes longer than a test.
inline Loaded loadedRobot(const std::string& yaml) {
  static std::map<std::string, Loaded> robots;
  const auto known = robots.find(yaml);
  if (known != robots.end()) return known->second;
  Result<Loaded> loaded = loadRobot(yaml, cia402::test::configFolder());
  if (!loaded) throw std::invalid_argument(loaded.error().message);
  return robots.emplace(yaml, std::move(loaded).value()).first->second;
}

/// One oracle, and what it looks at, made by hand. The world of the stage only tells the time: no
/// drive has power, and no driver runs.
class OracleTest : public testing::Test {
 protected:
  using Make = std::unique_ptr<Oracle> (*)(const Stage&);

  explicit OracleTest(Make make, const std::string& robot = kJudgedRobot)
      : stage_(loadedRobot(robot), 1),
        permits_(stage_),
        truths_(stage_.axes().size()),
        oracle_(make(stage_)) {
    for (AxisTruth& truth : truths_) {
      truth.statusword = 0x0027;
      truth.power = true;
      truth.nmt = canopen::NmtState::operational;
    }
    conditions_.axes.resize(truths_.size());
    oracle_->reportTo(findings_);
    wait(std::chrono::seconds(1));  // away from Time(), which says "not yet" here and there
    mark();
  }

  Time now() const { return stage_.now(); }
  View view() const { return {stage_, truths_, permits_, conditions_, now()}; }
  void wait(Duration duration) { stage_.host().advance(now() + duration); }
  /// Looks as the player does: every millisecond.
  virtual void look() {
    wait(std::chrono::milliseconds(1));
    oracle_->look(view());
  }
  void lookFor(Duration duration) {
    for (const Time end = now() + duration; now() < end;) look();
  }

  /// The bytes of a frame with the COB-ID from the drive or to it.
  void frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    oracle_->onFrame(can::Frame(id, bytes), view());
  }
  /// All RPDOs of an axis in which one of these objects is; what is not named is zero.
  void rpdos(std::size_t axis, const std::map<std::uint16_t, std::uint32_t>& values) {
    std::map<std::uint32_t, can::Frame> frames;
    for (const PdoPlace& place : stage_.rpdos()) {
      const auto value = values.find(place.object.index);
      if (place.axis != axis || value == values.end()) continue;
      can::Frame& frame = frames[place.cob_id];
      frame.id = place.cob_id;
      frame.size = 8;
      for (unsigned i = 0; i < 4 && place.byte + i < 8; ++i) {
        frame.data[place.byte + i] |= static_cast<std::uint8_t>(value->second >> 8 * i);
      }
    }
    ASSERT_FALSE(frames.empty()) << "no such object in an RPDO";
    for (const auto& [id, frame] : frames) oracle_->onFrame(frame, view());
  }

  Call callOf(const std::string& verb, const std::string& who, const std::string& mode = "") const {
    return {verb, who, mode, stage_.named(who), now()};
  }
  void call(const std::string& verb, const std::string& who, const std::string& mode = "") {
    oracle_->onCall(callOf(verb, who, mode), view());
  }
  void answer(const std::string& verb, const std::string& who, bool success = true,
              const std::string& message = "done") {
    oracle_->onAnswer(callOf(verb, who), bus::answerOf(success, message), view());
  }

  /// Findings are told by their time after this moment.
  void mark() { marked_ = now(); }
  /// The first finding, as "power_at_speed a1 +3 ms"; "" if there is none.
  std::string found() const { return findings_.empty() ? "" : told(findings_.front()); }
  /// All findings, one after the other.
  std::string allFound() const {
    std::string text;
    for (const Finding& finding : findings_) text += (text.empty() ? "" : ", ") + told(finding);
    return text;
  }
  /// The first finding came after so long; a day: there is none.
  Duration foundAfter() const {
    return findings_.empty() ? std::chrono::hours(24) : findings_.front().at - marked_;
  }

  Stage stage_;
  Permits permits_;
  std::vector<AxisTruth> truths_;
  Conditions conditions_;
  std::unique_ptr<Oracle> oracle_;
  std::vector<Finding> findings_;

 private:
  std::string told(const Finding& finding) const {
    return finding.oracle + " " + finding.axis + " +" +
           std::to_string((finding.at - marked_) / std::chrono::milliseconds(1)) + " ms";
  }

  Time marked_{};
};

}  // namespace cia402::campaign
