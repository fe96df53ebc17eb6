// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "can/bus.h"
#include "cia402_driver/common/result.h"
#include "sim/device/device.h"

namespace cia402::sim {

/// The mechanical side of one simulated axis, in motor turns seen from a drive that calls forward
/// what it does from the factory (independent of the drive's units).
struct AxisMechanics {
  double initial_position = 0.0;         ///< turns, where the rotor stands at power-on
  double inertia_time_constant = 0.004;  ///< s, lag of the position loop (following error)
  double negative_limit_switch = -1e9;   ///< turns; active at or below
  double positive_limit_switch = 1e9;    ///< turns; active at or above
  double negative_stop = -1e9;           ///< turns; the rotor cannot turn further back, ...
  double positive_stop = 1e9;            ///< ... nor further on
  double home_switch_low = 0.0;          ///< turns; the home switch is active from low ...
  double home_switch_high = 0.0;         ///< ... to high (low == high: no switch)
  double index_offset = 0.3;             ///< turns; the index pulse is at k + index_offset
  double brake_delay = 0.0;              ///< s from Operation enabled until set-points are followed
  double counts_per_turn = 131072;       ///< drive position units per motor turn (integer drives)
};

/// What 1018h of one drive says, where it differs from its family's definition.
struct DriveIdentity {
  std::optional<std::uint32_t> vendor, product, revision, serial;
};

/// Definition of a simulated drive family: dictionary and behaviour, read from
/// config/simulated_drives/<name>.yaml.
struct DriveDefinition;

/// Reads a definition; every problem of the file in one error text.
Result<std::shared_ptr<const DriveDefinition>> loadDriveDefinition(const std::string& path);

/// What the simulated world can be asked about a drive (truth, not what the bus says).
struct DriveTruth {
  double position_turns = 0.0;   ///< of the rotor
  double velocity_turns = 0.0;   ///< turns/s
  bool power_stage_on = false;   ///< current in the motor is possible
  bool moving = false;           ///< faster than 0.001 turns/s
  std::uint16_t statusword = 0;  ///< 6041h of the axis
  int mode = 0;                  ///< in which it is, whatever 6061h shows
  canopen::NmtState nmt = canopen::NmtState::unknown;
  /// Outputs that are on: 60FEh:01, as far as 60FEh:02 lets them through; 0 without power.
  std::uint32_t outputs = 0;
  unsigned bad_floats_received = 0;  ///< NaN, infinity, -0.0 in float objects, where trapped
};

/// A simulated CiA 402 drive: a Device with one axis or up to eight of them (CiA 402-2), each with
/// its own objects, state machine, modes, motor and switches. NMT state, SDO server, PDOs, 1001h
/// and EMCY are the device's.
class Drive {
 public:
  /// @param node node-ID as stored in the drive; 255: none yet, it waits for one by LSS.
  /// @param mechanics of axis 0, and of all others that are not in `further` (axes 1, 2, ...).
  Drive(std::shared_ptr<const DriveDefinition> definition, canopen::NodeId node, can::Sink& sink,
        AxisMechanics mechanics, const DriveIdentity& identity = {},
        const std::vector<AxisMechanics>& further = {});
  ~Drive();

  /// The bit rate of the bus that it hangs on, bit/s. A drive that has never had power yet has been
  /// set up for it; later it is deaf and mute where it speaks another one.
  void hangOn(std::uint32_t bit_rate);
  /// Supply on, or on again: boots, after the device's boot time.
  void powerOn(Time now);
  /// No supply: silent, rotors coast.
  void powerOff(Time now);
  /// Takes a frame from the bus, any frame.
  void receive(const can::Frame& frame, Time now);
  /// Does what is due until `now`.
  void tick(Time now);
  /// When tick() must be called next; kNever if nothing is pending.
  Time nextEvent() const;

  /// Injects a fault by its name in the definition ("following_error", "overcurrent",
  /// "overtemperature", "undervoltage", "encoder", ...) or as a raw error code "0x7305"; also
  /// "power_cycle", "exchange", "silent" (stops answering), "blocked_rotor",
  /// "reversed_motor", "sdo_silent", "emergency_storm", "short_tpdos", "long_tpdos"
  /// (docs/simulated_drives.md), and "clear", which takes the causes of all of them away. Faults,
  /// "blocked_rotor" and "reversed_motor" happen in one axis, the others to the device. @return an
  /// error that lists the known names. @pre axis < axisCount()
  Result<void> inject(const std::string& fault, Time now, unsigned axis = 0);
  /// What inject() knows by name.
  std::vector<std::string> faultNames() const;

  /// The input of a touch probe becomes active or not, at `now`. Where it has an edge and the probe
  /// is armed for it, the drive stores where the rotor is.
  /// @param probe 1 or 2  @pre axis < axisCount()
  void setProbe(unsigned probe, bool active, Time now, unsigned axis = 0);

  /// A digital input, by its bit of 60FDh, becomes active or not, at `now`; beside the switches of
  /// AxisMechanics.  @pre bit < 32, axis < axisCount()
  void setInput(unsigned bit, bool active, Time now, unsigned axis = 0);

  /// The pulse width at the input for a maker's speed, -1 to 1, at `now`; negative: the input for
  /// the direction says so.  @pre axis < axisCount()
  void setPulseWidth(double duty, Time now, unsigned axis = 0);

  /// @pre axis < axisCount()
  DriveTruth truth(Time now, unsigned axis = 0);
  /// 1 to 8.
  unsigned axisCount() const;
  /// What of the drive is CANopen.
  Device& device();
  /// All objects with their present values.
  ObjectDictionary& dictionary();
  /// May be changed at any time; initial_position counts at the first power-on only.
  /// @pre axis < axisCount()
  AxisMechanics& mechanics(unsigned axis = 0);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cia402::sim
