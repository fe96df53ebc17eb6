// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "cia402_driver/bus/trajectory_outcome.h"
#include "cia402_driver/common/result.h"
#include "cia402_driver/common/time.h"
#include "cia402_driver/motion/trajectory_point.h"

namespace cia402 {

/// What an axis can be asked to do; docs/interface.md says of each when it is refused and how it
/// ends.
enum class Procedure : std::uint8_t {
  enable,              ///< into operation, where it stands; releases a halt
  disable,             ///< power off; a moving axis is brought to rest first
  home,                ///< as its `homing` section says; ends enabled
  clear_faults,        ///< the axis stays disabled
  recover,             ///< boots the drive if needed, clears faults, enables
  quick_stop,          ///< by the drive's own ramp
  halt,                ///< to rest, and stays enabled until `enable` releases it
  save_parameters,     ///< in the drive, while disabled
  restore_parameters,  ///< the factory's, while disabled
};

/// What something that was asked for came to.
struct Answer {
  bool success = false;
  std::string message;  ///< a sentence: who, what, why not, what to do
};

/// A joint as it was in the newest cycle. Numbers that are unknown are NaN.
struct JointStatus {
  std::string name;
  double position = 0.0;  ///< rad or m
  double velocity = 0.0;  ///< rad/s or m/s
  double effort = 0.0;    ///< N m or N
  bool enabled = false;   ///< its axis takes commands
  bool homed = false;     ///< its position counts from the joint's zero
  bool faulted = false;   ///< or it warns of what stops it
  std::string condition;  ///< "operation enabled", or what is wrong and what to do
};

/// The drives of one CAN bus as one robot, for a program of its own without ROS: loads a robot's
/// file, boots the drives, runs the cycle in a thread, and takes commands from any other thread.
///
/// The thread has the process' ordinary scheduling unless a priority is asked for. Commands are
/// refused with a reason; what is asked for is answered once. Where this object ends
/// the axes are brought to rest and disabled, within two seconds.
class Robot {
 public:
  /// How a robot is run.
  struct Options {
    /// Where the package's `config` lies, with `drives/` and `simulated_drives/`; needed.
    std::string config_folder;
    /// A folder with further drive profiles; empty: none.
    std::string profile_folder;
    /// Interface instead of the file's: "can1", or "sim" for simulated drives in this process.
    /// Empty: the file's.
    std::string interface;
    /// SCHED_FIFO priority of the thread, 1 to 99, which needs the right to it; 0: ordinary.
    int realtime_priority = 0;
    /// Told what happens, a sentence each, in the thread that calls poll(). Empty: nobody.
    std::function<void(const std::string&)> log;
  };

  /// Reads a robot's file (docs/configuration.md). Nothing is sent yet.
  /// @return the robot, or every mistake in the file, a line each
  static Result<Robot> load(const std::string& file, Options options);
  Robot(Robot&&) noexcept;
  ~Robot();

  /// Starts the thread, and with it the boot of the drives; an interface that is not there is
  /// waited for. To be called once.
  void start();
  /// Every drive is identified, configured and started, and tells its position.
  bool ready() const;

  /// Joints and groups by name, in the order of the file.
  std::vector<std::string> joints() const;
  std::vector<std::string> groups() const;
  /// The joints of a group; empty where there is no such group.
  std::vector<std::string> jointsOf(const std::string& group) const;

  /// A procedure on one axis, or on all that are concerned where `axis` is empty.
  std::future<Answer> run(Procedure procedure, const std::string& axis = {});
  /// Another mode of operation: "cyclic_velocity", "csv". Disabled, or at standstill.
  std::future<Answer> setMode(const std::string& axis, const std::string& mode);
  /// Declares that the axis stands at `position` (rad or m); nothing moves.
  std::future<Answer> setPosition(const std::string& axis, double position);
  /// Reads or writes an object of an axis' drive, by profile name or "6041:00" (interface.md).
  std::future<Answer> readObject(const std::string& axis, const std::string& object);
  std::future<Answer> writeObject(const std::string& axis, const std::string& object,
                                  const std::string& value);

  /// A set-point of the active mode: rad or m, per s, N m or N. Velocities and efforts must be
  /// renewed within `command_timeout`. What is refused is told by Options::log.
  void command(const std::string& axis, double value);
  /// Sends a group along a trajectory, points in the order of `joints`; without points it stops.
  /// @return how it ended; one that is refused has ended at once
  std::future<bus::TrajectoryOutcome> follow(const std::string& group,
                                             const std::vector<std::string>& joints,
                                             const std::vector<motion::TrajectoryPoint>& points);

  /// All joints as of the newest cycle, in the order of the file.
  std::vector<JointStatus> state() const;
  /// Gives what has happened since to Options::log.
  void poll();

 private:
  class Impl;
  explicit Robot(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace cia402
