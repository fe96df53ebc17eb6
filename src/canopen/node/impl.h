// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canopen/boot/procedure.h"
#include "canopen/boot/retry.h"
#include "canopen/nmt/heartbeat.h"
#include "canopen/nmt/node_guarding.h"
#include "canopen/nmt/pause.h"
#include "canopen/node/kept_outputs.h"
#include "canopen/node/last_stop.h"
#include "canopen/node/node.h"
#include "canopen/node/sdo_cycle.h"

namespace cia402::canopen {

/// Why a drive in the NMT state stopped is not asked by SDO (CiA 301, table 38).
inline constexpr char kStoppedIsMute[] =
    "the drive's heartbeat says stopped (NMT state), and a stopped drive answers no SDO; boot it "
    "(recover, or nmt start) first";

/// The parts of a node and what one's news mean to the others.
struct Node::Impl : Node::Front {
  PdoImage image;

  Impl(const NodeConfig& node_config, const MasterConfig& master, can::Sink& frame_sink,
       SdoPacer* shared_turns, bool* changed, can::Pacer* wire);

  /// Begins a boot that is no repetition of a failed one.
  /// @param reset the command that was given, with From::reset
  void startBoot(BootProcedure::From from, const std::string& why, Time now,
                 NmtCommand reset = NmtCommand::reset_communication);
  void beginBoot(BootProcedure::From from, const std::string& why, Time now,
                 NmtCommand reset = NmtCommand::reset_communication);
  void runBoot(Time now);
  void succeed(Time now);
  void endBoot(Health end, Time now);
  /// Whatever was known of the node or on its way to it is void.
  void takeOut(Health as, const std::string& why);
  /// Stop or enter pre-operational, on purpose: nothing but its own boot-up message boots it again
  /// before somebody asks for it.
  void takeOutBy(NmtCommand command);
  void lose(const std::string& why, Time now);

  void onBootUp(Time now);
  void onErrorControl(std::uint8_t byte, Time stamp, Time now);
  void onHeartbeat(NmtState state, Time stamp, Time now);
  void stopUnasked(NmtState state, Time now);
  void onEmergency(const can::Frame& frame, Time stamp);

  void adoptCobIds();
  void adoptLeftOut();
  void adoptHalfFloats();
  void superviseWhileBooting(Time now);
  void checkSupervision(Time now);
  void continuePause(Time now);
  void tryAgain(Time now);
  void look(Time at);
  void runProbe(Time now);
  /// A drive exchanged while it was off is told where no serial number refuses it.
  void compareWithLastIdentity();

  void refresh();
  std::string who() const;
  std::string sentence(const std::string& text) const;
  const std::string& step() const;

  NodeConfig config;
  can::Sink& sink;
  bool* deadlines_changed;  ///< may be nullptr
  SdoPacer own_turns{0.0};  ///< where the master shares none
  SdoClient sdo;
  HeartbeatConsumer consumer;
  NodeGuard guard;
  BootProcedure boot;
  BootRetry retry;
  LastStop last_stop;
  NmtPause pause;
  SdoCycle sdo_cycle;
  KeptOutputs kept;
  SdoTicket probe;  ///< of the search for a node that does not answer
  NmtState nmt_state = NmtState::unknown;
  std::string problem;
  std::string taken_out;  ///< why it is not booted at its next heartbeat, though it is away
  mutable std::string step_text;
  std::vector<std::string> notes;
  std::optional<Node::Identity> last_identity;  ///< of the last boot that succeeded
  bool begun = false;            ///< boot() was called once; before that nothing starts by itself
  bool pdos_live = false;        ///< TPDOs are those that were configured
  bool cob_ids_changed = false;  ///< since takeCobIdChange()
  bool widened = false;          ///< the image has objects in more bits than it was made with
  std::size_t left_out = 0;      ///< entries of PDOs, as the image has them
  bool half_floats_adopted = false;  ///< the image has them as wide as the present boot found them
  Time next = kNever;                ///< of all deadlines but that of a transfer queued since
  std::uint32_t emergencies = 0, malformed_emergencies = 0;
  Time last_heartbeat{};
  std::optional<Emergency> last_emergency;
};

}  // namespace cia402::canopen
