// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "cia402_driver/common/time.h"

namespace cia402::sim {

/// The grid on which everything inside a simulated drive moves. Inputs take effect at the next
/// multiple of it, so that the outcome does not depend on how often the drive is asked.
inline constexpr Duration kDriveStep = std::chrono::microseconds(500);
inline constexpr double kDriveStepS = 0.0005;

/// What a rotor with its power stage can do. Turns and seconds; torque in multiples of the rated
/// torque.
struct MotorParameters {
  double position_time_constant = 0.004;  ///< s; at speed v the position lags by v times this
  double rated_acceleration = 300.0;      ///< turns/s^2 that the rated torque gives the rotor
  double max_torque = 3.0;                ///< peak, in rated torques
  double max_speed = 100.0;               ///< turns/s that the position loop may ask for
  double friction = 0.02;                 ///< Coulomb friction, in rated torques
  double viscous_friction = 0.5;          ///< 1/s, deceleration per speed when coasting
  double dynamic_brake = 0.0;             ///< of shorted windings, in rated torques; 0: none
};

/// Rotor, position loop and velocity loop, stepped by kDriveStep. The position loop is
/// proportional, the velocity loop a lag of a quarter of its time constant: critically damped, and
/// following error = velocity * position_time_constant in steady motion.
class Motor {
 public:
  /// @param position turns, where the rotor stands.
  Motor(const MotorParameters& parameters, double position);

  double maxSpeed() const { return parameters_.max_speed; }  ///< turns/s

  /// Torque the controller may use, in rated torques (6072h; 60E0h, 60E1h); capped by max_torque.
  void limitTorque(double forward, double reverse);
  void limitTorque(double both) { limitTorque(both, both); }
  /// A blocked rotor does not move; the loops push as hard as they may.
  void block(bool blocked) { blocked_ = blocked; }
  /// Its phases are swapped: it pushes against what its loops ask for, and runs away from a demand.
  void reverse(bool reversed) { reversed_ = reversed; }
  /// Its windings are shorted while it has no power.
  void shortWindings(bool shorted) { shorted_ = shorted; }
  /// The drive calls the other direction forward: what it has counted changes its sign.
  void mirror(bool mirrored);
  bool mirrored() const { return mirrored_; }
  /// Hard stops: it turns neither further back than `low` nor further on than `high`, turns of a
  /// motor that is not mirrored.
  void setStops(double low, double high);
  /// The position loop's lag, where the world changes it while running; s, > 0.
  void setPositionTimeConstant(double seconds);

  /// What the loops are told beside their demand: 60B1h, turns/s, and 60B2h, in rated torques.
  struct Offsets {
    double velocity = 0.0, torque = 0.0;
  };
  /// One step; turns. Its velocity offset is of the velocity loop, which the position loop leads.
  void followPosition(double demand, const Offsets& offsets);
  void followPosition(double demand) { followPosition(demand, {}); }
  void followVelocity(double demand, double torque_offset = 0.0);  ///< one step; turns/s
  void applyTorque(double rated_torques, double max_speed);  ///< one step; speed limit in turns/s
  void coast();                                              ///< one step without power

  double position() const { return position_; }                               ///< turns
  double truePosition() const { return mirrored_ ? -position_ : position_; }  ///< as not mirrored
  double trueVelocity() const { return mirrored_ ? -velocity_ : velocity_; }
  double velocity() const { return velocity_; }  ///< turns/s
  double torque() const { return torque_; }      ///< in rated torques
  bool atRest() const { return velocity_ == 0.0; }

 private:
  double allowed(double torque) const;
  void accelerate(double wanted);
  void runAway();
  double brakingSpeed(double distance) const;
  void turn();

  MotorParameters parameters_;
  double velocity_gain_ = 0.0;            ///< share of a speed difference made up in one step
  double forward_limit_, reverse_limit_;  ///< of the torque
  double position_;
  double lowest_ = -1e9, highest_ = 1e9;
  double velocity_ = 0.0;
  double torque_ = 0.0;
  std::optional<double> last_demand_;  ///< of the position loop, to know how fast it moves
  bool blocked_ = false, reversed_ = false, mirrored_ = false, shorted_ = false;
};

}  // namespace cia402::sim
