// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "can/bus.h"
#include "canopen/config.h"
#include "canopen/nmt/nmt.h"
#include "canopen/node/node.h"
#include "canopen/sdo/pacer.h"
#include "canopen/sdo/widths.h"

namespace cia402::canopen {

/// What the answer of a step means.
enum class Progress { waiting, again, next, failed };

/// Why a boot did not succeed, as far as it matters for what to do next.
enum class BootFailure {
  none,
  absent,     ///< nobody answered at all
  timed_out,  ///< somebody is there, but an answer was missing: another attempt may succeed
  refused,    ///< the drive answered, and a person must look at it
};

/// A PDO whose COB-ID is the drive's own.
struct AdoptedCobId {
  PdoDirection direction;
  unsigned number;
  std::uint16_t cob_id;
};

/// An entry of a PDO that the drive does not have or cannot map.
struct LeftOutEntry {
  PdoDirection direction;
  unsigned number;
  ObjectId object;
};

/// What an RPDO is to carry of an object that no cycle sets.
struct KeptValue {
  ObjectId object;
  std::uint64_t raw;
};

/// What was found out about the node since the boot began.
struct BootFindings {
  std::optional<Node::Identity> identity;
  bool after_reset = false;      ///< its boot-up message was seen: it has just been reset
  bool boot_up_missed = false;   ///< it was told to reset, and no boot-up message came
  bool appeared = false;         ///< the boot began because it was heard
  bool heartbeat_heard = false;  ///< since then; or an answer to guarding
  NmtState heartbeat_state = NmtState::unknown;  ///< that it told last, ...
  Time heartbeat_at{};                           ///< ... and when
  bool tpdo_heard = false;                       ///< before it was told to start
  bool braked = false;                   ///< a motor that turned on, or none of its motors did
  bool operational_heard = false;        ///< since it was told to start
  bool only_by_tpdo = false;             ///< a heartbeat may still say what was before
  bool stopped = false;                  ///< its last heartbeat said so: it answers no SDO
  unsigned stopped_count = 0;            ///< heartbeats that said so, ...
  Time stopped_since{}, stopped_last{};  ///< ... the first and the last of them
  unsigned wake_ups = 0;                 ///< NMT commands out of that state
  bool supervised = false;      ///< its loss will be noticed: heartbeat or guarding is set up
  bool guarded = false;         ///< ... by guarding
  bool watches_master = false;  ///< it took what it needs to notice a dead master
  bool error_control_differed = false;  ///< 1016h and the like were not as the last boot left them
  bool has_signature = false;           ///< it has 1020h
  bool unchanged = false;               ///< 1020h says so: the configuration is not written again
  bool half_floats_known = false;       ///< SdoClient::halfFloats() are those of this drive
  std::vector<AdoptedCobId> cob_ids;
  std::vector<LeftOutEntry> left_out;
  std::vector<LearnedWidth> widths;  ///< longer than assumed
  std::vector<KeptValue> kept;       ///< before its RPDOs are sent
  std::vector<std::string> lacking;  ///< what only defaults ask for, "606C:00 velocity_actual"
  std::vector<std::string> lacking_optional;  ///< what is optional anyhow
  bool started = false;                       ///< the NMT command was sent
};

/// What the steps of one boot share: the node's configuration, the SDO transfer on its way, what
/// was found so far and the words for people.
class BootContext {
 public:
  BootContext(const NodeConfig& node, const MasterConfig& bus, SdoClient& sdo_client,
              can::Sink& frame_sink, SdoPacer& sdo_pacer)
      : config(node),
        master(bus.node_id),
        master_heartbeat(bus.heartbeat),
        sync_period(bus.sync_period),
        external_sync(bus.external_sync),
        sdo(sdo_client),
        sink(frame_sink),
        pacer(sdo_pacer) {}

  const NodeConfig& config;
  const NodeId master;
  const Duration master_heartbeat, sync_period;
  const bool external_sync;
  SdoClient& sdo;
  can::Sink& sink;
  SdoPacer& pacer;

  BootFindings found;
  SdoTicket ticket;        ///< of the transfer that the present step has asked for
  Time deadline = kNever;  ///< of the present step; SDO time-outs are the SDO client's
  Time absent_at = kNever;
  Time commanded{};                                            ///< the last NMT command to the node
  Time asked{};                                                ///< the last SDO request was queued
  NmtCommand reset_command = NmtCommand::reset_communication;  ///< that it was given
  bool resetting = false;          ///< its boot-up message is waited for
  bool braking = false;            ///< it is left in its NMT state until its motors are braked ...
  bool stopped_before = false;     ///< ... unless it was stopped (NMT), and answers no SDO ...
  bool reset_when_braked = false;  ///< ... and gets a reset then
  unsigned resets_left = 0;        ///< repetitions of a reset that shows no effect
  bool ask_state = false;          ///< Node shall send a remote frame for the NMT state, now
  // These outlive the boot:
  bool restore_pending = false;  ///< 1011h was written, the drive has not yet started anew
  bool restored = false;         ///< ... and it has
  bool must_configure = false;   ///< whatever 1020h says
  bool vendor_known = false;     ///< it is the configured one, since the boot-up message
  bool stops_unasked = false;    ///< see BootProcedure::stopUnasked()
  std::string step{"not started"}, error;
  BootFailure failure = BootFailure::none;
  std::vector<std::string> notes;    ///< warnings
  std::vector<std::string> remarks;  ///< good to know

  /// Begins a new boot; keeps only what outlives one.
  void reset();

  void read(ObjectId object, const std::string& name, Time now,
            std::optional<SdoOptions> options = {});
  void write(ObjectId object, Bytes data, const std::string& name, Time now,
             std::optional<SdoOptions> options = {});
  /// For an object that the drive may lack: one that answers nothing for it, but does for others,
  /// does not have it. Asked three times, for a lost frame must not look like that.
  SdoOptions ifThere() const {
    SdoOptions options = config.sdo;
    options.silence_is_missing = true;
    options.retries = std::max(options.retries, 2);
    return options;
  }
  /// Sends what is queued for the node as soon as it is its turn on the bus.
  void submit(Time now);
  void command(NmtCommand command, Time now) {
    sink.send(nmtFrame(command, config.node_id));
    commanded = now;
  }
  /// Out of the NMT state stopped; one that does not tell its state by itself is asked for it.
  void wake(Time now) {
    command(NmtCommand::enter_pre_operational, now);
    if (guarded()) ask_state = true;
  }
  /// A reset has left: its boot-up message is waited for.
  void awaitReset(Time now) {
    constexpr unsigned kResets = 3;
    resetting = true;
    resets_left = kResets;
    commanded = now;
  }
  bool guarded() const { return config.error_control == ErrorControl::guarding; }

  bool answered() const { return ticket->done(); }
  bool ok() const { return ticket->ok(); }
  std::uint32_t value() const { return static_cast<std::uint32_t>(toUnsigned(ticket->data())); }
  /// The drive aborted the transfer: it is there, but will not.
  bool refused() const;
  /// ... because it has no such object.
  bool refusedAsMissing() const;
  /// The answer is this number of `size` bytes; some drives answer four, whatever the type.
  bool has(std::uint32_t number, std::size_t size) const {
    const bool long_enough = ok() && ticket->data().size() >= size && ticket->data().size() <= 8;
    return long_enough && toUnsigned(ticket->data()) == number;
  }

  /// Ends the boot. @param reason a sentence without the node's name.
  Progress fail(BootFailure kind, const std::string& reason);
  /// Ends the boot of a drive that stays in the NMT state stopped.
  Progress failStopped();
  /// Ends the boot because of the last transfer. @param remedy what the user can do, if anything
  Progress failTransfer(const std::string& remedy = "");
  /// Where heartbeats came while nothing was answered: "; its heartbeat goes on (NMT state
  /// operational): ..." with what to try; else empty.
  std::string muteText() const;
  /// A warning: `what`, and why the last transfer did not succeed.
  void noteTransfer(const std::string& what);
};

/// What the present state of the drive forbids (0x08000022) is tried again for a while: one that
/// was left enabled may still be on its way out of operation. One per step.
class StatePatience {
 public:
  /// To be asked for each answer that is no success. @return true: it was such a refusal, and the
  /// step waits, see rest().
  bool grant(BootContext& boot, std::uint32_t abort, Time now);
  /// To be asked first in check(): `waiting` or, when the time has come, `again`; none if the step
  /// does not wait.
  std::optional<Progress> rest(BootContext& boot, Time now);
  /// The item is done: the next one has as long.
  void renew() { until_ = kNever; }

 private:
  Time repeat_at_ = kNever, until_ = kNever;
};

/// One step of the boot procedure. Lives as long as one boot.
class BootStep {
 public:
  virtual ~BootStep() = default;
  /// Asks the drive for the step's present item. @return false: nothing (more) to do, next step.
  virtual bool begin(BootContext& boot, Time now) = 0;
  /// Looks at what came. `again`: begin() once more, with the next item.
  virtual Progress check(BootContext& boot, Time now) = 0;
};

}  // namespace cia402::canopen
