// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canopen/config.h"
#include "canopen/emcy/emergency.h"
#include "canopen/nmt/nmt.h"
#include "canopen/pdo/image.h"
#include "canopen/sdo/client.h"
#include "canopen/sdo/pacer.h"
#include "fieldbus/device.h"

namespace cia402::canopen {

using fieldbus::Health;
using fieldbus::isAway;

/// The master's side of one node: SDO client, process image, supervision and boot procedure.
/// Owned by Master.
class Node final : public fieldbus::Device {
 public:
  /// @param turns gives turns to the requests of all booting nodes; none: they leave at once.
  /// @param deadlines_changed set whenever nextDeadline() may have become another one.
  /// @param wire the sink where it is a pacer, for SDO block transfers. All outlive the node.
  Node(const NodeConfig& config, const MasterConfig& master, can::Sink& sink,
       SdoPacer* turns = nullptr, bool* deadlines_changed = nullptr, can::Pacer* wire = nullptr);
  ~Node() override;
  Node(Node&&) noexcept;

  /// Node-ID, 1..127.
  NodeId id() const;
  /// As configured: "shoulder"; may be empty.
  const std::string& name() const;
  /// "shoulder (node 3)", for messages.
  std::string who() const;
  /// As given, or changed by swapWrites().
  const NodeConfig& config() const;
  /// What is written at each boot is this from now on; one that is under way begins anew. `writes`
  /// gets what it was before.
  void swapWrites(std::vector<StartupWrite>& writes, Time now);
  /// As its last heartbeat, guarding answer or boot-up message told; `unknown` before the first.
  NmtState nmtState() const;

  /// As fieldbus::Device says.
  bool excused() const override;
  const std::string& bootStep() const override;
  const std::string& problem() const override;
  fieldbus::DeviceTimes times() const override;
  const std::optional<Emergency>& lastEmergency() const override;
  fieldbus::ObjectAccess& objects() override;
  const fieldbus::Terms& terms() const override;
  std::string overdueText() const override;
  std::string missingText() const override;
  std::string carrierText(fieldbus::Slot output) const override;
  /// A drive that says it is stopped (NMT) answers no SDO (CiA 301, 7.3.2.2).
  std::string askingRefusal(const std::string& what) const override;
  /// Identity read at boot.
  struct Identity {
    std::uint32_t device_type = 0, vendor_id = 0, product_code = 0, revision = 0, serial = 0;
  };
  /// As read by the present or last boot; nothing before it was read.
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
  /// As the present or last boot has set it up.
  Supervision supervision() const;
  bool noticesLostMaster() const override { return supervision().watches_master; }
  bool seesToMotors() const override;
  /// It was told to start: its PDOs are as configured.
  bool started() const;

  /// @param reset send NMT reset communication first; without it the node is only brought to
  /// pre-operational.
  void boot(Time now, bool reset) override;
  /// By NMT reset node, or reset communication where that is not allowed.
  void restart(Time now) override;
  std::string restartGap() const override;
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

  /// By NMT stop and start.
  void stopAndStart(Duration stopped, Time now) override;
  bool paused() const override;

  /// The SDO client that boot, axes and services share.
  SdoClient& sdo();
  const SdoClient& sdo() const;
  /// The values that travel by PDO.
  PdoImage& image() { return static_cast<PdoImage&>(Device::image()); }
  const PdoImage& image() const { return static_cast<const PdoImage&>(Device::image()); }

  /// A boot-up message, a heartbeat or an SDO answer has come since this program started.
  bool everHeard() const;
  /// Stamp of the last heartbeat or guarding answer, Time() before the first.
  Time lastHeartbeat() const;
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
  void refuse(const std::string& why);
  void tick(Time now);        ///< called by Master
  Time nextDeadline() const;  ///< called by Master
  /// Sends the RPDOs that are due in this cycle (PdoConfig::refresh_every).
  void sendRpdos(Time now);

 private:
  struct Impl;
  explicit Node(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace cia402::canopen
