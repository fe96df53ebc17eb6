// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "can/bus.h"
#include "sim/bus/bus.h"
#include "sim/drive/drive.h"

namespace cia402::sim {

/// Something that lives in the time of a simulated bus, e.g. the computer of a master under test.
class Timed {
 public:
  virtual ~Timed() = default;
  /// Does what is due until `now`.
  virtual void tick(Time now) = 0;
  /// When tick() is due; kNever: not by itself.
  virtual Time nextDeadline() const = 0;
};

/// The same with a port on the bus that it shares with nobody.
class Participant : public Timed {
 public:
  /// A frame of another one has ended on the bus.
  virtual void receive(const can::Frame& frame, Time now) = 0;
};

/// A bus with its drives and any number of participants in one thread and one time, virtual or
/// fed from a clock. Two worlds that are built alike, with the same seed, run alike bit by bit.
class World {
 public:
  /// @param bitrate bit/s, @param seed of the injected faults.
  explicit World(double bitrate, std::uint64_t seed = 1);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Adds a drive; power it on with Drive::powerOn(), or all with powerOn().
  /// @param mechanics, @param further of its axes, as Drive takes them.
  Drive& addDrive(const std::string& name, std::shared_ptr<const DriveDefinition> definition,
                  canopen::NodeId node, const AxisMechanics& mechanics,
                  const DriveIdentity& identity = {},
                  const std::vector<AxisMechanics>& further = {});
  /// Adds a participant that outlives the world. @return its port, to send on.
  Port& addParticipant(const std::string& name, Participant& participant);
  /// Adds what sees to its ports itself; must outlive the last advance(). Those that are due at one
  /// time are ticked in the order in which they were added, after the bus and the drives.
  void add(Timed& timed) { timed_.push_back(&timed); }

  /// Powers all drives on at the present time.
  void powerOn();
  /// Lets everything happen that happens up to and including `until`, in order.
  void advance(Time until);
  Time now() const { return now_; }
  /// When the next thing happens.
  Time nextEvent() const;

  Bus& bus() { return bus_; }
  /// The drives in the order of addDrive().
  std::size_t driveCount() const { return drives_.size(); }
  /// In the order in which they were added. @pre index is one of them
  Drive& drive(std::size_t index);
  /// The drive of that name, or nullptr.
  Drive* find(const std::string& name);
  /// The drive's controller, to pull its cable or force it bus-off. @pre index < driveCount()
  Port& port(std::size_t index);

 private:
  class DriveNode;
  class ParticipantNode;

  Bus bus_;
  Time now_{};
  std::vector<std::unique_ptr<DriveNode>> drives_;
  std::vector<std::unique_ptr<ParticipantNode>> participants_;
  std::vector<Timed*> timed_;  ///< the participants, too
};

}  // namespace cia402::sim
