// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/can/bus.h"
#include "cia402_driver/canopen/config.h"
#include "cia402_driver/canopen/nmt.h"
#include "cia402_driver/canopen/node.h"
#include "pdo_configurator.h"

namespace cia402::canopen {

/// The boot procedure of one node (after CiA 302-2, figure "boot slave"): wait for the device,
/// identify it, configure supervision, SYNC, PDOs and objects, start it. A table of steps
/// (boot.cpp) that advances with every answer; all nodes run theirs at once.
class BootProcedure {
 public:
  enum class Status { idle, running, done, failed, absent };
  /// What is known about the node at the start.
  enum class From {
    reset,    ///< it was just told to reset: a boot-up message is due
    boot_up,  ///< its boot-up message came
    unknown,  ///< nothing: it is brought to pre-operational and asked whether it is there
  };

  BootProcedure(const NodeConfig& config, const MasterConfig& master, SdoClient& sdo,
                can::Sink& sink);

  void start(From from, Time now);
  void stop();

  /// Goes as far as the answers allow. To be called after every SDO answer and heartbeat and when
  /// deadline() has come. A boot-up message, expected or not, is a reason to start() again.
  Status advance(Time now);
  void heartbeatHeard(NmtState state);
  /// The time by which the present step must have ended (SDO time-outs are the SDO client's).
  Time deadline() const { return status_ == Status::running ? deadline_ : kNever; }

  bool running() const { return status_ == Status::running; }
  const std::string& step() const { return step_; }
  /// Why it failed or found nobody, and what to do.
  const std::string& error() const { return error_; }
  const std::vector<std::string>& notes() const { return notes_; }
  const std::optional<Node::Identity>& identity() const { return identity_; }
  /// The drive took 1017h: it sends heartbeats.
  bool supervised() const { return supervised_; }
  /// The node was told to start: its PDOs are as configured and may be believed.
  bool started() const { return started_; }
  /// A PDO whose COB-ID is the drive's own.
  struct CobId {
    PdoDirection direction;
    unsigned number;
    std::uint16_t cob_id;
  };
  const std::vector<CobId>& adoptedCobIds() const { return adopted_cob_ids_; }

 private:
  enum class Progress { waiting, again, next, failed };
  struct Step {
    /// Asks the drive for the step's present item. @return false: nothing to do, next step.
    bool (BootProcedure::*begin)(Time now);
    Progress (BootProcedure::*check)(Time now);
  };
  static const Step kSteps[];
  static const std::size_t kStepCount;

  void enter(std::size_t step, Time now);
  void read(ObjectId object, const std::string& name, Time now,
            std::optional<SdoOptions> options = {});
  void write(ObjectId object, Bytes data, const std::string& name, Time now);
  Progress fail(const std::string& reason);
  Progress failTransfer();
  bool refused() const;
  bool refusedAsMissing() const;
  void note(const std::string& text);

  bool beginWaitingForBootUp(Time now);
  Progress checkWaitingForBootUp(Time now);
  bool beginProofOfLife(Time now);
  Progress checkProofOfLife(Time now);
  Progress nobodyThere();
  bool beginIdentity(Time now);
  Progress checkIdentity(Time now);
  bool beginMasterTimeout(Time now);
  Progress checkMasterTimeout(Time now);
  bool beginHeartbeat(Time now);
  Progress checkHeartbeat(Time now);
  bool beginReadSyncCounter(Time now);
  Progress checkReadSyncCounter(Time now);
  bool beginReadSyncPeriod(Time now);
  Progress checkReadSyncPeriod(Time now);
  bool beginStopSyncPeriod(Time now);
  Progress checkStopSyncPeriod(Time now);
  bool beginWriteSyncCounter(Time now);
  Progress checkWriteSyncCounter(Time now);
  bool beginWriteSyncPeriod(Time now);
  Progress checkWriteSyncPeriod(Time now);
  bool beginPdo(Time now);
  Progress checkPdo(Time now);
  void adoptCobId();
  bool beginStartupWrite(Time now);
  Progress checkStartupWrite(Time now);
  Progress checkReadBeforeWrite(Time now);
  Progress repeatLater(Time now);
  void sendStartupWrite(Time now);
  bool beginStart(Time now);
  Progress checkStart(Time now);

  const NodeConfig& config_;
  NodeId master_;
  bool master_has_heartbeat_;
  SdoClient& sdo_;
  can::Sink& sink_;
  std::vector<PdoConfig> pdos_;  ///< first those to be found disabled, then the configured ones

  Status status_ = Status::idle;
  std::size_t index_ = 0;  ///< of the step in kSteps
  std::size_t item_ = 0;   ///< within the step: which identity object, PDO, start-up write
  Time deadline_ = kNever, absent_at_ = kNever;
  SdoTicket ticket_;
  std::optional<PdoConfigurator> pdo_;
  std::vector<CobId> adopted_cob_ids_;
  std::optional<Node::Identity> identity_;
  bool sync_counter_differs_ = false;
  std::optional<std::uint32_t> sync_period_;         ///< 1006h as the drive has it
  std::optional<std::uint32_t> wanted_sync_period_;  ///< 1006h as it shall be
  bool reading_before_write_ = false;
  /// A start-up write that the drive's present state forbids: when to try again, and until when.
  Time repeat_at_ = kNever, patient_until_ = kNever;
  bool boot_up_missed_ = false, heartbeat_heard_ = false, operational_heard_ = false;
  bool supervised_ = false, started_ = false;
  std::string step_{"not started"}, error_;
  std::vector<std::string> notes_;
};

}  // namespace cia402::canopen
