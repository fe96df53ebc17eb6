// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/player.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "can/candump_log.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLook = 1ms;
constexpr Duration kRest = 2s;  // after the last action
constexpr std::uint16_t kInternalLimit = 0x0800;

}  // namespace

Player::Player(Stage& stage, const Scene& scene, const RunOptions& options)
    : scene_(scene),
      options_(options),
      session_(stage, scene.seed, options),
      calls_(session_, *this),
      proof_(session_, calls_, streams_, trajectories_, [this](Time until) { runTo(until); }) {
  stage.world().bus().setMonitor(
      [this](const can::Frame& frame, Time now) { onFrame(frame, now); });
  stage.host().listen([this](const bus::Event& event) { onEvent(event); });
}

void Player::play() {
  session_.stage.world().powerOn();
  runTo(session_.now() + fromSeconds(session_.random.between(0.001, 0.011)));
  session_.stage.host().start();
  for (const Action& action : scene_.actions) {
    runTo(Time(action.at) + taken_);
    if (session_.failed()) return;
    session_.say("> " + toString(action));
    act(action);
    if (session_.failed()) return;
    // A proof takes its time; what follows is counted from its end.
    if (action.verb() == "prove") taken_ = session_.now() - Time(action.at);
  }
  runTo(session_.now() + kRest);
}

void Player::runTo(Time until) {
  while (session_.now() < until && !session_.failed()) {
    const Time next = std::min({until, looked_ + kLook, session_.nextLater(), streams_.next()});
    stepTo(std::max(next, session_.now()));
  }
}

void Player::stepTo(Time next) {
  session_.stage.host().advance(next);
  if (next >= looked_ + kLook) look();
  session_.doLater(next);
  streams_.step();
}

void Player::look() {
  looked_ = session_.now();
  session_.look();
  for (std::size_t i = 0; i < session_.truths.size(); ++i) {
    const bool limited = (session_.truths[i].statusword & kInternalLimit) != 0;
    if (limited) session_.limited_at[i] = looked_;
  }
  session_.lookAsOracles();
  calls_.watchDeadlines();
  tellWatched();
}

void Player::tellWatched() const {
  const AxisFacts* const watched = session_.stage.find(options_.watch);
  if (watched == nullptr) return;
  const AxisTruth& truth = session_.truths[watched->index];
  char line[120];
  std::snprintf(line, sizeof line, "%s at %.6g, %.4g per s, effort %.3g, mode %d, %04X%s",
                watched->name.c_str(), truth.position, truth.velocity, truth.effort, truth.mode,
                truth.statusword, truth.power ? "" : ", no power");
  session_.say(line);
}

void Player::act(const Action& action) {
  bool known = false;
  try {
    known = actBy(action.words);
  } catch (const std::exception& exception) {
    throw std::invalid_argument("\"" + toString(action) + "\": " + exception.what());
  }
  if (!known) throw std::invalid_argument("\"" + toString(action) + "\": no such action");
}

bool Player::actBy(const Words& words) {
  if (words[0] == "end") return true;
  if (words[0] == "prove") {
    prove();
    return true;
  }
  return calls_.act(words) || streams_.act(words) || trajectories_.act(words) || bus_.act(words) ||
         host_.act(words) || drives_.act(words);
}

void Player::prove() {
  calm();
  proof_.run();
}

/// The world is well again.
void Player::calm() {
  streams_.clear();
  session_.endLater();
  trajectories_.stopAll();
  bus_.calm();
  host_.calm();
  drives_.calm();
}

/// SYNC, NMT, and what passes between the master and the drive of the axis that is watched (CiA
/// 301, 7.3.5: the predefined connection set carries the node-ID in the lowest seven bits). The
/// PDOs of a further axis may have other COB-IDs.
void Player::traceFrame(const can::Frame& frame) const {
  const AxisFacts* const watched = session_.stage.find(options_.watch);
  if (watched == nullptr || frame.error) return;
  const auto holds = [&](const std::vector<PdoPlace>& places) {
    return std::any_of(places.begin(), places.end(), [&](const PdoPlace& place) {
      return place.axis == watched->index && place.cob_id == frame.id;
    });
  };
  const bool told = frame.id == 0 && (frame.data[1] == 0 || frame.data[1] == watched->node_id);
  const bool of_node = told || frame.id == 0x80 || (frame.id & 0x7F) == watched->node_id;
  if (!of_node && !holds(session_.stage.rpdos()) && !holds(session_.stage.tpdos())) return;
  const std::string line = can::formatLogLine({{}, "can", frame, can::Direction::unknown});
  session_.say(line.substr(line.find("can ")));
}

void Player::onEvent(const bus::Event& event) {
  const std::string text = event.text.str();
  if (text.find(": the motor runs away:") != std::string::npos) runaways_.push_back(text);
  session_.say("    " + text);
}

void Player::onFrame(const can::Frame& frame, Time now) {
  const auto mix = [this](std::uint64_t value) {
    fingerprint_ = (fingerprint_ ^ value) * 1099511628211U;
  };
  ++frames_;
  mix(static_cast<std::uint64_t>(now.time_since_epoch().count()));
  mix(frame.id | std::uint64_t{frame.size} << 32 | std::uint64_t{frame.remote} << 40 |
      std::uint64_t{frame.error} << 41);
  for (std::size_t i = 0; i < frame.size && i < 8; ++i) mix(frame.data[i]);
  traceFrame(frame);
  session_.onFrame(frame, now);
}

}  // namespace cia402::campaign
