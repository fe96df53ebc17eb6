// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/session.h"
#include "sim/bus/faults.h"

namespace cia402::campaign {

/// What goes wrong on the bus: frames that are lost or late, cables, strangers that send.
class BusTrouble {
 public:
  /// Attaches a stranger to the bus of the stage.
  explicit BusTrouble(Session& session);

  /// @return false if the words are no trouble of the bus.
  bool act(const Words& words);
  /// Frames come whole and in time again, and strangers are gone.
  void calm();

  // Actions.
  void lose(const Words& words);        ///< loss RATE SECONDS
  void duplicate(const Words& words);   ///< duplicate RATE SECONDS
  void corrupt(const Words& words);     ///< corrupt RATE SECONDS
  void delay(const Words& words);       ///< delay RATE SECONDS LONGEST
  void sync(const Words& words);        ///< sync PERIOD SECONDS: a second producer
  void foreignNmt(const Words& words);  ///< foreign_nmt A COMMAND
  /// unheard A all|service SECONDS: it hears the host, the host hears nothing of it, or TPDOs only
  void unheard(const Words& words);
  void loseNmt(const Words& words);    ///< nmt_loss A COUNT: so many commands do not reach it
  void pullCable(const Words& words);  ///< cable A|host SECONDS
  void busOff(const Words& words);     ///< bus_off A|host SECONDS

 private:
  /// Listens to nothing.
  struct Deaf : sim::Listener {
    void onFrame(const can::Frame&, Time) override {}
  };
  void disturb(double sim::FaultRates::*rate, const Words& words);
  void produceSync(Time end, Duration period, int counter);
  void loseAtHost(std::uint32_t id, Duration length);
  std::vector<sim::Port*> breakLinks(const Words& words);

  Session& session_;
  Deaf deaf_;
  sim::Port* foreign_;  ///< another master
  sim::FaultRates rates_;
};

}  // namespace cia402::campaign
