// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/canopen/config.h"
#include "cia402_driver/canopen/emergency.h"
#include "cia402_driver/canopen/nmt.h"
#include "cia402_driver/canopen/pdo.h"
#include "cia402_driver/canopen/sdo_client.h"
#include "cia402_driver/canopen/sdo_pacer.h"

namespace cia402::canopen {

/// Health of a node as the master sees it.
enum class NodeHealth : std::uint8_t {
  absent,   ///< never heard of, or boot timed out
  booting,  ///< identified and configured at the moment; bootStep() says how far
  ready,    ///< configured and started (operational)
  failed,   ///< boot failed, or commanded out of operation; problem() says why; boot() tries again
  lost,     ///< heartbeat, or answer to guarding, missing
};
const char* toString(NodeHealth health);
/// Nobody answers.
inline bool isAway(NodeHealth health) {
  return health == NodeHealth::absent || health == NodeHealth::lost;
}

/// The master's side of one node: SDO client, process image, supervision and boot procedure.
/// Owned by Master.
class Node {
 public:
  /// @param turns gives turns to the requests of all booting nodes; none: they leave at once.
  /// @param deadlines_changed set whenever nextDeadline() may have become another one.
  /// @param wire the sink where it is a pacer, for SDO block transfers. All outlive the node.
  Node(const NodeConfig& config, const MasterConfig& master, can::Sink& sink,
       SdoPacer* turns = nullptr, bool* deadlines_changed = nullptr, can::Pacer* wire = nullptr);
  ~Node();
  Node(Node&&) noexcept;

  NodeId id() const;
  const std::string& name() const;
  /// "shoulder (node 3)", for messages.
  std::string who() const;
  const NodeConfig& config() const;
  /// It is away, and the configuration says that it may be.
  bool excused() const;

  NodeHealth health() const { return front_->health; }
  NmtState nmtState() const;
  /// Step of the boot procedure in words: "reading 1018:01 vendor id", "waiting for boot-up".
  const std::string& bootStep() const;
  /// Why the boot failed or the node was lost, and what to do; empty when healthy.
  const std::string& problem() const;
  /// Why a drive that says it is stopped (NMT) cannot be asked for `what`, e.g. "6041:00
  /// statusword", and what to do; empty if it is not stopped. A stopped node answers no SDO (CiA
  /// 301, 7.3.2.2).
  std::string stoppedRefusal(const std::string& what) const;
  /// Identity read at boot.
  struct Identity {
    std::uint32_t device_type = 0, vendor_id = 0, product_code = 0, revision = 0, serial = 0;
  };
  const std::optional<Identity>& identity() const;
  /// Notes worth telling: optional writes refused, objects missing, heartbeat not supported.
  const std::vector<std::string>& notes() const;
  /// Good to know about the last boot, but no reason to worry.
  const std::vector<std::string>& remarks() const;
  /// Who notices whose loss, as found at boot.
  struct Supervision {
    ErrorControl kind = ErrorControl::none;
    bool watched = false;         ///< the master notices the loss of the node
    bool watches_master = false;  ///< the node notices the loss of the master
  };
  Supervision supervision() const;
  /// It was told to start: its PDOs are as configured.
  bool started() const;

  /// (Re)starts the boot procedure: identify, configure, start. @param reset send NMT reset
  /// communication first; without it the node is only brought to pre-operational.
  void boot(Time now, bool reset);
  /// Somebody tells that the drive is there, without a sign of life on its node-ID yet: a node that
  /// is away is asked for its device type at `at` instead of whenever the search comes to it. Not
  /// while it is told to stop after its loss, nor where an NMT command took it out of operation.
  void look(Time at);
  /// NMT command to this node alone. After stop and pre-operational the node is `failed` until
  /// boot() is called or it reboots, and one that is away is not looked for any more and `failed`
  /// once it is heard; after a reset it boots again by itself.
  void command(NmtCommand command, Time now);
  /// The same after the master has sent `command` to all nodes at once: nothing is sent.
  void commanded(NmtCommand command, Time now);

  /// Takes a node that is ready through NMT stop and, after `stopped`, start. It stays ready, with
  /// the configuration that it has; where it does not start again it is booted.
  static constexpr Duration kStartPatience{std::chrono::seconds(1)};
  void stopAndStart(Duration stopped, Time now);
  /// That is under way.
  bool paused() const;

  /// To be used at once, not kept: the node looks at its transfers' deadlines anew after each call.
  SdoClient& sdo();
  const SdoClient& sdo() const;
  ProcessImage& image() { return front_->image; }
  const ProcessImage& image() const { return front_->image; }

  /// Boot-ups seen since start. A change tells that the node lost its configuration.
  std::uint32_t bootUps() const { return front_->boot_ups; }
  Time lastHeartbeat() const;
  /// Grows with everything that is new of the node but what PDOs bring.
  std::uint32_t changes() const { return front_->changes; }
  const std::optional<Emergency>& lastEmergency() const;
  /// Emergencies received since start, error resets included.
  std::uint32_t emergencies() const;
  /// Emergency frames without an error code, not counted in emergencies().
  std::uint32_t malformedEmergencies() const;

  /// Takes an EMCY, SDO or heartbeat frame of this node; called by Master.
  void receive(const can::Frame& frame, Time stamp, Time now);
  /// Takes the frame of TPDO number image().tpdos()[tpdo]; called by Master.
  void receiveTpdo(std::size_t tpdo, const can::Frame& frame, Time stamp);
  /// SYNC is on the bus (or should be): ages the inputs and sends the remote frames that ask for
  /// TPDOs; called by Master.
  void onSync(Time now);
  /// The drive insisted on COB-IDs of its own, in image() now; told once. Called by Master.
  bool takeCobIdChange();
  /// The node cannot be used as it is: takes it out of operation, for `why` in words. Called by
  /// Master.
  void refuse(const std::string& why, Time now);
  void tick(Time now);        ///< called by Master
  Time nextDeadline() const;  ///< called by Master
  /// Sends the RPDOs that are due in this cycle (PdoConfig::refresh_every).
  void sendRpdos(Time now);

 private:
  struct Impl;
  /// The part of Impl that every cycle looks at.
  struct Front {
    explicit Front(const std::vector<PdoConfig>& pdos) : image(pdos) {}
    ProcessImage image;
    NodeHealth health = NodeHealth::absent;
    std::uint32_t boot_ups = 0, changes = 1;
  };
  std::unique_ptr<Impl> impl_;
  Front* front_;
};

}  // namespace cia402::canopen
