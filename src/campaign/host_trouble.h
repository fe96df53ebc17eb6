// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/calls.h"
#include "campaign/session.h"

namespace cia402::campaign {

/// What goes wrong with the computer that the driver runs on, and with its process.
class HostTrouble {
 public:
  /// @param calls of the driver, which end with it.
  HostTrouble(Session& session, Calls& calls) : session_(session), calls_(calls) {}

  /// @return false if the words are no trouble of the host.
  bool act(const Words& words);
  /// It is in time again.
  void calm();

  // Actions.
  void stall(const Words& words);     ///< stall SECONDS: no processor
  void late(const Words& words);      ///< late MOST SECONDS: it wakes up late
  void kill(const Words& words);      ///< kill SECONDS: until a new process runs
  void shutDown(const Words& words);  ///< shutdown SECONDS: from its end to a new process

 private:
  void start();

  Session& session_;
  Calls& calls_;
  Time ends_at_{};  ///< the new driver after an orderly shutdown starts then
};

}  // namespace cia402::campaign
