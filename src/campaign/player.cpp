// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/player.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "cia402_driver/can/candump_log.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLook = 1ms;
constexpr Duration kRest = 2s;  // after the last action

}  // namespace

double toNumber(const std::string& word) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0') throw std::invalid_argument("not a number: " + word);
  return value;
}

Player::Player(Stage& stage, const Scene& scene, const RunOptions& options)
    : stage_(stage),
      scene_(scene),
      options_(options),
      stop_at_first_(options.stop_at_first),
      random_(scene.seed),
      permits_(stage),
      oracles_(allOracles(stage)),
      held_(stage.axes().size(), Time(-1h)),
      cuts_(stage.axes().size()),
      dead_(stage.axes().size()) {
  conditions_.axes.resize(stage.axes().size());
  for (auto& oracle : oracles_) {
    oracle->reportTo(ignored(oracle->name()) ? ignored_ : findings_);
  }
  // Another master that sends and listens to nothing.
  foreign_ = &stage_.world().bus().attach(deaf_, "foreign");
  foreign_->setAttached(false);
  stage_.world().bus().setMonitor(
      [this](const can::Frame& frame, Time now) { onFrame(frame, now); });
  stage_.host().listen([this](const bus::Event& event) {
    const std::string text = event.text.str();
    say("    " + text);
    for (const config::GroupConfig& group : stage_.loaded().robot.groups) {
      if (text == group.name + ": goal reached") goalReached(group);
    }
  });
}

void Player::play() {
  stage_.world().powerOn();
  runTo(stage_.now() + fromSeconds(random_.between(0.001, 0.011)));
  stage_.host().start();
  for (const Action& action : scene_.actions) {
    runTo(Time(action.at) + taken_);
    if (failed()) return;
    say("> " + toString(action));
    act(action);
    if (failed()) return;
    // A proof takes its time; what follows is counted from its end.
    if (action.verb() == "prove") taken_ = stage_.now() - Time(action.at);
  }
  runTo(stage_.now() + kRest);
}

void Player::runTo(Time until) {
  while (stage_.now() < until && !failed()) {
    Time next = std::min(until, looked_ + kLook);
    for (const Later& item : later_) next = std::min(next, item.at);
    for (const Stream& item : streams_) next = std::min(next, item.next);
    stepTo(std::max(next, stage_.now()));
  }
}

void Player::stepTo(Time next) {
  stage_.host().advance(next);
  if (next >= looked_ + kLook) look();
  for (std::size_t i = 0; i < later_.size();) {
    if (later_[i].at > next) {
      ++i;
      continue;
    }
    const auto what = std::move(later_[i].what);
    later_.erase(later_.begin() + static_cast<std::ptrdiff_t>(i));
    what();
  }
  stepStreams();
}

void Player::look() {
  looked_ = stage_.now();
  stage_.look(truths_);
  permits_.watch(truths_, looked_);
  for (std::size_t i = 0; i < truths_.size(); ++i) {
    if ((truths_[i].statusword & 0x0800) != 0) held_[i] = looked_;
  }
  const View seen = view();
  for (auto& oracle : oracles_) oracle->look(seen);
  watchDeadlines();
  if (const AxisFacts* const watched = stage_.find(options_.watch)) {
    const AxisTruth& truth = truths_[watched->index];
    char line[120];
    std::snprintf(line, sizeof line, "%s at %.6g, %.4g per s, effort %.3g, mode %d, %04X%s",
                  watched->name.c_str(), truth.position, truth.velocity, truth.effort, truth.mode,
                  truth.statusword, truth.power ? "" : ", no power");
    say(line);
  }
}

void Player::act(const Action& action) {
  const Words& words = action.words;
  try {
    if (words[0] == "end") return;
    if (words[0] == "prove") return prove();
    if (actCall(words) || actMotion(words) || actTrouble(words)) return;
  } catch (const std::exception& exception) {
    throw std::invalid_argument("\"" + toString(action) + "\": " + exception.what());
  }
  throw std::invalid_argument("\"" + toString(action) + "\": no such action");
}

void Player::later(Duration delay, std::function<void()> what) {
  later_.push_back({stage_.now() + delay, std::move(what)});
}

void Player::say(const std::string& line) {
  if (!options_.trace) return;
  char time[32];
  std::snprintf(time, sizeof time, "%9.4f ", toSeconds(stage_.now().time_since_epoch()));
  options_.trace(time + line);
}

bool Player::ignored(const std::string& oracle) const {
  return ("," + options_.ignore + ",").find("," + oracle + ",") != std::string::npos;
}

void Player::report(const char* oracle, const std::string& axis, const std::string& text) {
  (ignored(oracle) ? ignored_ : findings_).push_back({oracle, axis, text, stage_.now()});
}

/// SYNC, and what passes between the master and the axis that is watched (CiA 301, 7.3.5: the
/// predefined connection set carries the node-ID in the lowest seven bits).
void Player::traceFrame(const can::Frame& frame) {
  const AxisFacts* const watched = stage_.find(options_.watch);
  if (watched == nullptr || frame.error) return;
  if (frame.id != 0x80 && (frame.id & 0x7F) != watched->node_id) return;
  const std::string line = can::formatLogLine({{}, "can", frame, can::Direction::unknown});
  say(line.substr(line.find("can ")));
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
  if (truths_.empty()) return;
  View seen = view();
  seen.now = now;
  for (auto& oracle : oracles_) oracle->onFrame(frame, seen);
}

}  // namespace cia402::campaign
