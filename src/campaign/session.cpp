// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr int kLongestChain = 50;  // of what ends and lets something else begin

}  // namespace

double toNumber(const std::string& word) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0') throw std::invalid_argument("not a number: " + word);
  return value;
}

Words listed(const std::string& word) {
  Words items;
  std::istringstream words(word);
  for (std::string item; std::getline(words, item, ',');) items.push_back(item);
  return items;
}

Duration toDuration(const std::string& word) { return fromSeconds(toNumber(word)); }

Session::Session(Stage& on, std::uint64_t seed, const RunOptions& options)
    : stage(on),
      random(seed),
      permits(on),
      limited_at(on.axes().size(), Time(-1h)),
      options_(options),
      oracles_(allOracles(on)) {
  conditions.axes.resize(stage.axes().size());
  for (auto& oracle : oracles_) {
    oracle->reportTo(ignored(oracle->name()) ? ignored_ : findings_);
  }
}

void Session::look() {
  stage.look(truths);
  permits.watch(truths, now());
}

void Session::lookAsOracles() {
  const View seen = view();
  for (auto& oracle : oracles_) oracle->look(seen);
}

void Session::onFrame(const can::Frame& frame, Time now) {
  if (truths.empty()) return;
  const View seen{stage, truths, permits, conditions, now};
  for (auto& oracle : oracles_) oracle->onFrame(frame, seen);
}

void Session::onCall(const Call& call) {
  for (auto& oracle : oracles_) oracle->onCall(call, view());
}

void Session::onAnswer(const Call& call, const bus::Answer& answer) {
  const View seen = view();
  for (auto& oracle : oracles_) {
    oracle->look(seen);
    oracle->onAnswer(call, answer, seen);
  }
}

void Session::later(Duration delay, std::function<void()> what) {
  later_.push_back({now() + delay, std::move(what)});
}

Time Session::nextLater() const {
  Time next = kNever;
  for (const Later& item : later_) next = std::min(next, item.at);
  return next;
}

void Session::doLater(Time due) {
  for (std::size_t i = 0; i < later_.size();) {
    if (later_[i].at > due) {
      ++i;
      continue;
    }
    const auto what = std::move(later_[i].what);
    later_.erase(later_.begin() + static_cast<std::ptrdiff_t>(i));
    what();
  }
}

void Session::endLater() {
  for (int i = 0; i < kLongestChain && !later_.empty(); ++i) {
    std::vector<Later> ending;
    ending.swap(later_);
    for (Later& item : ending) item.what();
  }
}

void Session::say(const std::string& line) const {
  if (!options_.trace) return;
  char time[32];
  std::snprintf(time, sizeof time, "%9.4f ", toSeconds(now().time_since_epoch()));
  options_.trace(time + line);
}

bool Session::ignored(const std::string& oracle) const {
  return ("," + options_.ignore + ",").find("," + oracle + ",") != std::string::npos;
}

void Session::report(const char* oracle, const std::string& axis, const std::string& text) {
  (ignored(oracle) ? ignored_ : findings_).push_back({oracle, axis, text, now()});
}

void Session::breakLink(std::size_t axis, Duration duration) {
  mayBeUnheard(axis, duration);
  loseCommands(axis, duration);
}

void Session::mayBeUnheard(std::size_t axis, Duration duration) {
  for (std::size_t i : stage.inDriveOf(axis)) {
    Conditions::extend(conditions.axes[i].unheard, now() + duration + 500ms);
  }
}

void Session::mayCoast(std::size_t axis) {
  Conditions::extend(conditions.axes[axis].may_coast, now() + 20ms);
}

void Session::mayCoastInDriveOf(std::size_t axis) {
  for (std::size_t i : stage.inDriveOf(axis)) mayCoast(i);
}

void Session::loseCommands(std::size_t axis, Duration duration) {
  for (std::size_t i : stage.inDriveOf(axis)) loseCommandsOfOne(i, duration);
}

/// A loop in the driver holds it, by small velocities of which the last one goes on.
bool Session::heldByVelocity(std::size_t axis) const {
  const AxisFacts& facts = stage.axes()[axis];
  const AxisTruth& truth = truths[axis];
  const auto& modes = facts.config->profile->modes;
  const bool looped = std::any_of(modes.begin(), modes.end(), [&](const drive::ModeSpec& mode) {
    return mode.value == truth.mode && mode.position_loop;
  });
  return looped && !facts.watches_master && truth.power &&
         std::fabs(truth.velocity) <= facts.creep();
}

void Session::loseCommandsOfOne(std::size_t axis, Duration duration) {
  const AxisFacts& facts = stage.axes()[axis];
  Conditions::extend(conditions.axes[axis].cut_off, now() + duration + 500ms);
  if (truths.empty()) return;
  // A drive that does not watch its master goes on until the driver has found it again.
  const Duration goes_on = std::min(facts.master_timeout, duration + facts.retaken());
  const Time end = now() + goes_on + facts.stopTime(facts.velocity) + 100ms;
  if (permits.allowed(axis, now()) || heldByVelocity(axis))
    permits.allow(axis, Permits::Source::stream, end);
  if (duration > facts.master_timeout) permits.cut(axis, end);
}

double Session::shown(const JointFacts& joint) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < joint.axes.size(); ++k) sum += joint.shares[k] * shown(joint.axes[k]);
  return sum;
}

double Session::shown(std::size_t axis) const {
  return stage.host().running() ? stage.host().network().axis(axis).state().position : 0.0;
}

}  // namespace cia402::campaign
