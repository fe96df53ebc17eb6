// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/diff_drive_base.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/text.h"

namespace cia402::ros_node {
namespace {

constexpr Duration kLongestStep = std::chrono::milliseconds(100);  // after a pause of this program
constexpr Duration kLastZeros = std::chrono::milliseconds(300);    // said for so long after rest
/// Wheels are never seen to turn so much faster than they may; what is beyond is another zero.
constexpr double kExcess = 2.0, kLeast = 0.2;  // times; rad

}  // namespace

DiffDriveBase::DiffDriveBase(const DiffDriveOptions& options)
    : options_(options), limiter_(options.limits, options.geometry), odometry_(options.geometry) {}

const std::string& DiffDriveBase::nameOf(std::size_t wheel) const {
  const std::size_t left = options_.left.size();
  return wheel < left ? options_.left[wheel] : options_.right[wheel - left];
}

double DiffDriveBase::meanOf(const std::vector<double>& positions, bool left) const {
  const std::size_t first = left ? 0 : options_.left.size();
  const std::size_t count = left ? options_.left.size() : options_.right.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += positions[first + i];
  return sum / static_cast<double>(count);
}

std::string DiffDriveBase::command(const motion::PlanarTwist& twist, Time now) {
  if (!std::isfinite(twist.linear) || !std::isfinite(twist.angular)) {
    return "cmd_vel refused: linear.x " + numberText(twist.linear) + ", angular.z " +
           numberText(twist.angular) + " are not finite numbers";
  }
  command_ = twist;
  commanded_ = now;
  return {};
}

bool DiffDriveBase::measured(const std::vector<double>& positions, Time now) {
  const double dt = toSeconds(now - std::exchange(measured_, now));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (std::isfinite(positions[i])) continue;
    const std::string why = "the position of " + nameOf(i) + " is not known";
    if (unknown_.empty()) news_.emplace_back(why + ": the base stops, odometry stands still");
    unknown_ = why;
    odometry_.lose();
    velocity_ = {};
    return false;
  }
  if (!unknown_.empty() && heard_) {
    news_.emplace_back(
        "the wheels are known again; what they turned meanwhile is not in the odometry");
  }
  heard_ = true;
  stale_ = false;
  unknown_.clear();
  const std::string jumped = odometry_.following() ? jump(positions, dt) : std::string();
  if (!jumped.empty()) {
    news_.emplace_back(jumped +
                       ": it has got another zero, and what it turned meanwhile is not in the "
                       "odometry");
    odometry_.lose();
  }
  const bool follows = odometry_.following();
  const double left = meanOf(positions, true), right = meanOf(positions, false);
  velocity_ = {};
  if (follows && dt > 0.0) {
    velocity_ = motion::twistOf(options_.geometry, {(left - meanOf(positions_, true)) / dt,
                                                    (right - meanOf(positions_, false)) / dt});
  }
  odometry_.update(left, right);
  positions_ = positions;
  return true;
}

std::string DiffDriveBase::jump(const std::vector<double>& positions, double dt) const {
  const double most = kLeast + kExcess * options_.limits.wheel_velocity * dt;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double turned = positions[i] - positions_[i];
    if (std::fabs(turned) <= most) continue;
    return nameOf(i) + " would have turned by " + numberText(turned) + " rad in " +
           numberText(dt, 3) + " s";
  }
  return {};
}

bool DiffDriveBase::wheelsKnown(Time now) {
  if (!unknown_.empty()) return false;
  if (now - measured_ <= options_.joints_timeout) return true;
  if (!std::exchange(stale_, true)) {
    news_.emplace_back("joint_states of the wheels have not come for " +
                       secondsText(options_.joints_timeout) +
                       " (joint_states_timeout): the base stops");
  }
  return false;
}

std::optional<motion::WheelSpeeds> DiffDriveBase::step(Time now) {
  const Time before = std::exchange(stepped_, now);
  const Duration since = before == Time{} ? Duration::zero() : std::min(now - before, kLongestStep);
  if (command_ && now - commanded_ > options_.command_timeout) {
    if (!motion::atRest(*command_)) {
      news_.emplace_back("cmd_vel has not come for " + secondsText(options_.command_timeout) +
                         " (cmd_vel_timeout): the base stops");
    }
    command_.reset();
  }
  if (command_ && !heard_ && !std::exchange(told_, true)) {
    news_.emplace_back("cmd_vel is not followed: no joint_states with the wheels have come yet");
  }
  motion::PlanarTwist wanted;
  if (wheelsKnown(now) && command_) wanted = *command_;
  const motion::PlanarTwist& twist = limiter_.step(wanted, toSeconds(since));
  if (command_ || !motion::atRest(twist)) moved_ = now;
  if (moved_ == Time{} || now - moved_ > kLastZeros) return std::nullopt;
  return motion::wheelSpeeds(options_.geometry, twist);
}

std::vector<std::string> DiffDriveBase::takeNews() { return std::exchange(news_, {}); }

}  // namespace cia402::ros_node
