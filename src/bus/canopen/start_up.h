// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bus/axis_cycle.h"
#include "bus/canopen/bus_listener.h"
#include "bus/command.h"
#include "bus/event.h"
#include "bus/fixed_text.h"

namespace cia402::bus {

/// Listens before anything is sent. Two masters would command the same drives: as long as there is
/// another one nothing is sent.
class StartUp {
 public:
  /// @param listen the bus must be free of another master for so long; zero: nobody listens.
  /// @param cycle, @param events must outlive this.
  StartUp(const canopen::MasterConfig& master, Duration listen, AxisCycle& cycle, EventSink& events)
      : listener_(master, listen), cycle_(cycle), events_(events) {}

  /// Begins to listen. @return false if nobody is to listen
  bool begin(Time now);
  bool listening() const { return listener_.listening(); }
  /// When the bus will have been free for long enough.
  Time deadline() const { return listener_.deadline(); }
  /// A frame came.
  void receive(const can::Frame& frame, Time now);
  /// @param bus_lost nothing can be heard. @return true once the bus was free for long enough
  bool tick(bool bus_lost, Time now);
  /// It listens and has heard none so far: the bus may get free. @param bus_lost nothing is heard
  bool mayEnd(bool bus_lost) const { return listening() && !bus_lost && !listener_.heard(); }

  /// A command that comes meanwhile: calls wait for the end of the short listening, as they would
  /// for the drives to boot; set-points do not.
  void take(Command command);
  /// Those that have waited, in the order in which they came.
  std::vector<Command> takeDeferred();
  /// They get that for an answer instead: the program ends, or whatever else `why` says.
  void refuseDeferred(const std::string& why);

  /// Which other master is waited for, in words; empty if none is.
  const FixedText<256>& problem() const { return problem_; }

 private:
  void refuseForOtherMaster(Command& command) const;

  BusListener listener_;
  AxisCycle& cycle_;
  EventSink& events_;
  std::vector<Command> deferred_;
  FixedText<256> problem_;
};

}  // namespace cia402::bus
