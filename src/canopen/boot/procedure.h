// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopen/boot/context.h"

namespace cia402::canopen {

/// The boot procedure of one node (after CiA 302-2, figure "boot slave"): wait for the device,
/// identify it, configure error control, SYNC, PDOs and objects, start it. A table of steps
/// (procedure.cpp) that advances with every answer; all nodes run theirs at once.
class BootProcedure {
 public:
  enum class Status { idle, running, done, failed, absent };
  /// What is known about the node at the start.
  enum class From {
    reset,         ///< it was just told to reset: a boot-up message is due
    boot_up,       ///< its boot-up message came
    unknown,       ///< nothing: it is brought to pre-operational and asked whether it is there
    heard,         ///< the same, but it is there: a heartbeat or an answer of it came just now
    before_reset,  ///< as unknown, but its communication is reset instead
  };

  BootProcedure(const NodeConfig& config, const MasterConfig& master, SdoClient& sdo,
                can::Sink& sink, SdoPacer& pacer);

  /// @param told of the node's NMT state, last of all: one that is stopped answers no SDO
  /// @param reset the command that was given, with From::reset
  void start(From from, Time now, NmtState told = NmtState::unknown,
             NmtCommand reset = NmtCommand::reset_communication);
  void stop();
  /// Whether motors that are asked for in vain are told to stop once, before its NMT command: who
  /// it is was seen before, and that stop brakes them. Counts from the next start() on.
  void stopUnasked(bool may) { boot_.stops_unasked = may; }

  /// Goes as far as the answers allow. To be called after every SDO answer and heartbeat and when
  /// deadline() has come. A boot-up message, expected or not, is a reason to start() again.
  Status advance(Time now);
  /// A heartbeat, or an answer to guarding. One that shows that the last NMT command was lost makes
  /// it be sent again.
  void heartbeatHeard(NmtState state, Time now);
  /// That heartbeat tells of a node that was told to reset and goes on as before.
  bool ignoresReset(NmtState state, Time now) const;
  /// Its motors are asked for before all else and have not answered; nothing is known to speak
  /// against stopping them unasked. @param heard what its heartbeat told just now
  bool asksForMotors(NmtState heard) const;
  /// They are, or are going to be as it is heard; see fieldbus::Device.
  bool seesToMotors() const;
  /// A TPDO came: the node is operational. @return false if nobody waits for that.
  bool tpdoHeard();
  /// A TPDO came though the node was not told to start: it is operational, and may turn its motors.
  /// @return true: the boot goes on by that
  bool tpdoAppears(Time now);
  /// @return true for the heartbeat that a TPDO, of higher priority, may have overtaken: the first
  /// one after a TPDO alone showed that the node is operational, if it says pre-operational.
  bool overtakenByTpdo(NmtState state);
  /// Somebody is to ask for the NMT state by a remote frame. Cleared by the question.
  bool takeStateRequest() { return std::exchange(boot_.ask_state, false); }
  /// The time by which the present step must have ended (SDO time-outs are the SDO client's).
  Time deadline() const { return running() ? boot_.deadline : kNever; }

  bool running() const { return status_ == Status::running; }
  const std::string& step() const { return boot_.step; }
  /// Why it failed or found nobody, and what to do.
  const std::string& error() const { return boot_.error; }
  BootFailure failure() const { return boot_.failure; }
  const std::vector<std::string>& notes() const { return boot_.notes; }
  const std::vector<std::string>& remarks() const { return boot_.remarks; }
  const BootFindings& found() const { return boot_.found; }
  /// The node was told to start: its PDOs are as configured and may be believed.
  bool started() const { return boot_.found.started; }

 private:
  void enter(std::size_t step, Time now);
  void begin(std::size_t step, Time now);
  void stoppedHeard(Time now);
  bool mayStillTurn(NmtState state, Time now);
  void tellWhatIsLacking();

  BootContext boot_;
  Status status_ = Status::idle;
  bool unheard_ = false;     ///< this boot began with its motors, and has heard no heartbeat yet
  bool from_reset_ = false;  ///< it did not: a reset came, or comes, before
  std::vector<std::unique_ptr<BootStep>> steps_;
  std::size_t index_ = 0;  ///< of the present one in steps_
};

}  // namespace cia402::canopen
