// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/bus_watch.h"
#include "bus/event.h"
#include "bus/flight_recorder.h"
#include "bus/load_meter.h"
#include "bus/network.h"
#include "can/bus.h"

namespace cia402::bus {

/// A network on a CAN interface, with the load meter, the flight recorder and the watch over the
/// interface: what BusRunner does again and again, and tests do in virtual time. One thread.
class BusLoop {
 public:
  /// @param robot valid configuration, @param master made from it.
  /// @param interface, @param events must outlive this; events are not recorded by themselves.
  BusLoop(config::RobotConfig robot, canopen::MasterConfig master, can::Interface& interface,
          EventSink& events);

  /// One round. SYNC leaves first if it is due. Then all that came before `now` is taken in, and
  /// only then what depends on the time is done: after a stall nobody is given up for lost whose
  /// frames wait in the kernel.
  void step(Time now);
  /// When step() is due at the latest, even if no frame comes.
  Time nextDeadline() const;

  Network& network() { return network_; }
  const Network& network() const { return network_; }
  FlightRecorder& recorder() { return recorder_; }
  const LoadMeter& meter() const { return meter_; }
  const BusWatch& watch() const { return watch_; }

 private:
  bool takeIn(Time now);

  can::Interface& interface_;
  LoadMeter meter_;
  FlightRecorder recorder_;
  Network network_;
  BusWatch watch_;
  int rounds_behind_ = 0;    ///< since tick(): they left frames of the past
  bool more_waits_ = false;  ///< the last round may have left frames
};

}  // namespace cia402::bus
