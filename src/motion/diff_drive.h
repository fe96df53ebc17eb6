// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A base on two driven wheels, or several on each side that turn alike: x ahead, y to the left,
// headings count to the left.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace cia402::motion {

/// All in m, > 0.
struct DiffDriveGeometry {
  double separation = 0.0;  ///< between the tracks of the left and the right wheels
  double radius = 0.0;      ///< of the wheels
};

/// How the base moves.
struct PlanarTwist {
  double linear = 0.0;   ///< m/s, ahead
  double angular = 0.0;  ///< rad/s, to the left
};
inline bool atRest(const PlanarTwist& twist) { return twist.linear == 0.0 && twist.angular == 0.0; }

/// Of the wheels of each side, rad/s.
struct WheelSpeeds {
  double left = 0.0, right = 0.0;
};

WheelSpeeds wheelSpeeds(const DiffDriveGeometry& base, const PlanarTwist& twist);
PlanarTwist twistOf(const DiffDriveGeometry& base, const WheelSpeeds& wheels);

/// Largest magnitudes, > 0.
struct PlanarLimits {
  double linear_velocity = 0.0, angular_velocity = 0.0;          ///< m/s, rad/s
  double linear_acceleration = 0.0, angular_acceleration = 0.0;  ///< m/s^2, rad/s^2
  double wheel_velocity = 0.0;                                   ///< rad/s
};

/// Leads a base to the twists that it is told, within its limits: what is beyond a limit of
/// velocity is slowed down on the same curve, and both parts of a twist arrive together.
class TwistLimiter {
 public:
  /// @param limits, @param base valid
  TwistLimiter(const PlanarLimits& limits, const DiffDriveGeometry& base)
      : limits_(limits), base_(base) {}

  /// What to command now. @param wanted finite. @param dt s since the step before, >= 0
  const PlanarTwist& step(const PlanarTwist& wanted, double dt);
  const PlanarTwist& twist() const { return twist_; }
  /// `wanted` within the limits of velocity.
  PlanarTwist within(const PlanarTwist& wanted) const;

 private:
  PlanarLimits limits_;
  DiffDriveGeometry base_;
  PlanarTwist twist_;
};

/// Where a base is by what its wheels have turned, each piece of the way taken as the arc that it
/// is where they turned evenly. Wheels that slip are believed.
class WheelOdometry {
 public:
  struct Pose {
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< m, from where it began
    double heading = 0.0;                                ///< rad, without end
  };

  explicit WheelOdometry(const DiffDriveGeometry& base) : base_(base) {}

  /// The wheels of each side stand at these positions now, rad, without end; finite. The first ones
  /// move nothing.
  void update(double left, double right);
  /// What the wheels did is not known: the next positions move nothing.
  void lose() { last_.reset(); }
  bool following() const { return last_.has_value(); }
  const Pose& pose() const { return pose_; }

 private:
  struct Wheels {
    double left, right;
  };

  DiffDriveGeometry base_;
  std::optional<Wheels> last_;
  Pose pose_;
};

}  // namespace cia402::motion
