// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/common/time.h"
#include "motion/diff_drive.h"

namespace cia402::ros_node {

struct DiffDriveOptions {
  std::vector<std::string> left, right;  ///< joints of the wheels, at least one on each side
  motion::DiffDriveGeometry geometry;
  motion::PlanarLimits limits;
  Duration command_timeout{std::chrono::milliseconds(500)};
  Duration joints_timeout{std::chrono::milliseconds(200)};
};

/// Drives a base and keeps account of where it is: commands in, speeds of wheels and odometry out.
/// It commands nothing but rest where no command comes any more, or it does not know what the
/// wheels do. No ROS in here, and time is an argument.
class DiffDriveBase {
 public:
  explicit DiffDriveBase(const DiffDriveOptions& options);

  /// A command. @return why it is refused, which leaves the one before to its time-out; empty if
  /// not
  std::string command(const motion::PlanarTwist& twist, Time now);
  /// Where the wheels stand, rad, left ones then right ones in the order of the options; NaN:
  /// unknown. @return the odometry goes on by it
  bool measured(const std::vector<double>& positions, Time now);
  /// What the wheels of each side are to do now, rad/s; nothing: nobody wants them to move, and the
  /// driver is left alone.
  std::optional<motion::WheelSpeeds> step(Time now);

  const motion::WheelOdometry& odometry() const { return odometry_; }
  /// How it moved between the last two positions.
  const motion::PlanarTwist& velocity() const { return velocity_; }
  /// What is to be said since the last call, a sentence each.
  std::vector<std::string> takeNews();

 private:
  bool wheelsKnown(Time now);
  std::string jump(const std::vector<double>& positions, double dt) const;
  const std::string& nameOf(std::size_t wheel) const;
  double meanOf(const std::vector<double>& positions, bool left) const;

  DiffDriveOptions options_;
  motion::TwistLimiter limiter_;
  motion::WheelOdometry odometry_;
  motion::PlanarTwist velocity_;
  std::optional<motion::PlanarTwist> command_;
  std::vector<double> positions_;  ///< the last ones
  std::vector<std::string> news_;
  std::string unknown_ = "they have not come yet";  ///< why; empty: they are known
  Time commanded_{}, measured_{}, stepped_{}, moved_{};
  bool heard_ = false, stale_ = false, told_ = false;
};

}  // namespace cia402::ros_node
