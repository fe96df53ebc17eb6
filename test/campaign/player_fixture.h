// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "campaign/oracle_fixture.h"
#include "campaign/player.h"

namespace cia402::campaign {

/// One axis a1 in one group g1.
inline std::string playedRobot(const std::string& mode, const std::string& more = "") {
  return "bus: {interface: can0, bitrate: 1000000, sync_period: 0.004, heartbeat: 0.1}\n"
         "recorder: {duration: 1, keep: 0}\naxes:\n"
         "  a1: {node_id: 1, drive: generic_cia402, mode: " +
         mode +
         ", command_timeout: 0.2, counts_per_turn: 4096, gear_ratio: 50.0, rated_torque: 1.0,\n"
         "    limits: {lower: -3, upper: 3, velocity: 1, acceleration: 4, effort: 100}" +
         more + "}\ngroups:\n  g1: {joints: [a1]}\n";
}

inline Scene sceneOf(const std::vector<std::string>& actions, const std::string& robot,
                     std::uint64_t seed = 1) {
  Scene scene;
  scene.seed = seed;
  scene.robot = robot;
  for (const std::string& action : actions) scene.actions.push_back(parseAction(action).value());
  return scene;
}

/// A player whose calls go through a test.
class Tapped : public Player {
 public:
  using Player::Player;
  std::function<void()> tap;  ///< called with every command
  bus::Reply<> reply;         ///< of the last command
  bool loses = false;         ///< the driver gets none
  bool doubles = false;       ///< every reply comes twice

 protected:
  void post(bus::Command command) override {
    if (tap) tap();
    if (!loses) Player::post(std::move(command));
  }
  bus::Reply<> replied(bus::Reply<> given) override {
    reply = std::move(given);
    if (!doubles) return reply;
    return [once = reply](const bus::Answer& answer) {
      once(answer);
      once(answer);
    };
  }
};

struct Told {
  Time at{};
  std::string line;
  Time until{};  ///< the permit of the first axis then
};

class PlayerTest : public testing::Test {
 protected:
  using Prepare = std::function<void(Tapped&, Stage&)>;

  /// Plays a scene to its end. @return the findings, as "late_answer a1 at 6.0 s".
  std::string play(const std::vector<std::string>& actions,
                   const std::string& robot = playedRobot("cyclic_position"),
                   const Prepare& prepare = {}, const std::function<void()>& at_end = {}) {
    const Scene scene = sceneOf(actions, robot);
    Stage stage(loadedRobot(robot), scene.seed);
    RunOptions options;
    options.stop_at_first = false;
    const Permits* permits = nullptr;
    options.trace = [&](const std::string& line) {
      told_.push_back({stage.now(), line, permits->until(0)});
    };
    Tapped player(stage, scene, options);
    permits = &player.permits();
    if (prepare) prepare(player, stage);
    player.play();
    if (at_end) at_end();
    std::string text;
    for (const Finding& finding : player.findings()) {
      text += (text.empty() ? "" : ", ") + finding.oracle + " " + finding.axis + " at " +
              number(toSeconds(finding.at.time_since_epoch())) + " s";
    }
    return text;
  }
  /// The first line with these words; each scene has them.
  const Told& told(const std::string& words) const {
    for (const Told& line : told_) {
      if (line.line.find(words) != std::string::npos) return line;
    }
    throw std::out_of_range("nothing told of " + words);
  }
  /// So many seconds after the beginning of the scene the axis may move until then, as is told at
  /// the last action, "end".
  double permitAtEnd() const {
    const auto ends = [](const Told& line) {
      const std::string last = " end";
      return line.line.size() > last.size() &&
             line.line.compare(line.line.size() - last.size(), last.size(), last) == 0;
    };
    return seconds(std::find_if(told_.begin(), told_.end(), ends)->until);
  }
  static double seconds(Time time) { return toSeconds(time.time_since_epoch()); }

  std::vector<Told> told_;
};

}  // namespace cia402::campaign
