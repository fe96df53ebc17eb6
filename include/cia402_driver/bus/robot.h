// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <string>
#include <vector>

#include "cia402_driver/bus/axis_motion.h"
#include "cia402_driver/bus/axis_reporter.h"
#include "cia402_driver/bus/bus_listener.h"
#include "cia402_driver/bus/command.h"
#include "cia402_driver/bus/cycle_statistics.h"
#include "cia402_driver/bus/dcf_job.h"
#include "cia402_driver/bus/event.h"
#include "cia402_driver/bus/group.h"
#include "cia402_driver/bus/history_job.h"
#include "cia402_driver/bus/jobs.h"
#include "cia402_driver/bus/lss_desk.h"
#include "cia402_driver/bus/nmt_job.h"
#include "cia402_driver/bus/snapshot.h"
#include "cia402_driver/canopen/master.h"
#include "cia402_driver/config/robot.h"
#include "cia402_driver/drive/axis.h"

namespace cia402::bus {

/// Everything on one bus: the CANopen master, the axes, the trajectory groups, and the cycle that
/// ties them together. Sans-IO: BusRunner runs it in real time, tests run it in virtual time. One
/// thread.
///
/// The cycle: SYNC leaves at its absolute deadline before anything is computed; half a period later
/// the feedback is decoded, motion computed and the RPDOs sent, in time for the next SYNC.
class Robot final : private canopen::MasterListener {
 public:
  /// @param robot valid configuration, @param master made from it by config::makeMasterConfig.
  /// @param sink where frames go, @param events where news go; both must outlive the robot.
  Robot(config::RobotConfig robot, canopen::MasterConfig master, can::Sink& sink,
        EventSink& events);
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// To be called once the bus is there; nothing is sent before. Begins to boot the drives and to
  /// cycle once no other master has been heard for BusConfig::listen.
  void start(Time now);
  bool started() const { return started_; }
  /// A frame from the bus. @param stamp when it was on the wire.
  void receive(const can::Frame& frame, Time stamp, Time now);
  /// Tells the wall-clock time, for TIME messages (`bus: {time_interval: ...}`).
  void setWallTime(canopen::UnixTime wall, Time now) { master_.setWallTime(wall, now); }
  /// Sends SYNC if it is due; before frames that wait are taken in.
  void produceSync(Time now) {
    if (now >= next_sync_) onSyncDue(now);
  }
  /// Does all that is due: SYNC, cycle, time-outs, procedures; after the frames that came before.
  void tick(Time now);
  /// When tick() is due at the latest.
  Time nextDeadline() const;

  /// No frame leaves any more, for the reason `why` ("can0 is bus-off"): motion ends, axes are not
  /// enabled when the bus comes back, commands are refused until then.
  void busLost(const std::string& why, Time now);
  /// Frames leave again. @param is_news whether people are told.
  void busBack(bool is_news, Time now);

  /// Carries out a command; its reply may come at once or when a procedure has ended.
  void execute(Command command, Time now);

  /// Ends everything in good order: motion is ramped down, the axes are disabled, the drives go
  /// pre-operational; done after 1.8 s at the latest, see shutDown().
  void beginShutdown(Time now);
  bool shutDown() const { return shutdown_ == Shutdown::done; }

  /// Writes the state of everything but the bus interface. Allocates only if `snapshot` has not
  /// got the right sizes yet.
  void fill(RobotSnapshot& snapshot) const;
  /// Somebody is about to look at the axes: see drive::Axis::look().
  void look() {
    for (drive::Axis& axis : axes_) axis.look();
  }

  const config::RobotConfig& config() const { return config_; }
  std::vector<drive::Axis>& axes() { return axes_; }
  const std::vector<Group>& groups() const { return groups_; }
  /// The node that an axis sits in. @param axis index in axes()
  canopen::Node& node(std::size_t axis) { return *nodes_[axis]; }
  canopen::Master& master() { return master_; }
  const canopen::Master& master() const { return master_; }
  const CycleStatistics& statistics() const { return statistics_; }
  const std::vector<drive::Axis>& axes() const { return axes_; }
  const std::vector<AxisMotion>& motions() const { return motions_; }
  /// The time it was given last.
  Time now() const { return now_; }
  /// When feedback was decoded and motion computed last.
  Time lastCycle() const { return last_cycle_; }

 private:
  enum class Shutdown { no, stopping, disabling, done };

  struct AxisNews {  // what people were told last, to tell only what changes
    AxisWords words;
    Time checked{};
    drive::State state = drive::State::unknown;
    fieldbus::Health health = fieldbus::Health::absent;
    std::uint32_t procedure = 0, notices = 0;
    bool running = false, feedback_valid = false, warning = false;
    std::uint16_t error_code = 0;
    Time history_asked{};
    bool history_wanted = false;
    Time boot_began{};
    unsigned boot_ups = 0;  ///< messages since the last boot that succeeded
    std::uint64_t stale_count = 0, wrong_lengths = 0;  // of the TPDOs
    std::uint64_t pdo_troubles = 0;                    // both together
    Time pdos_told = Time::min();
    bool dried_up = false;        // its stream of set-points
    Time unknown_since = kNever;  // its state or position

    bool differ(const drive::Axis& axis) const {
      const drive::AxisState& shown = axis.state();
      return state != shown.state || health != shown.health || error_code != shown.error_code ||
             feedback_valid != shown.feedback_valid || warning != shown.warning ||
             procedure != axis.procedure().id || running != axis.procedure().running ||
             notices != axis.noticeCount();
    }
  };

  void onEmergency(canopen::Node& node, const fieldbus::Emergency& emergency) override;
  void onMalformedEmergency(canopen::Node& node, std::size_t size) override;
  void onSdoAnswer(canopen::Node& node) override;
  void onBootUp(canopen::Node& node, Time now) override;
  void onHealthChange(canopen::Node& node, fieldbus::Health before, Time now) override;
  void tellBooted(std::size_t axis, Time now);
  void onForeignSync(const can::Frame& frame, Time stamp, Time now) override;

  /// A counter in SYNC is an error to drives that are not yet configured for it (EMCY 0x8240): the
  /// first SYNC waits until a drive is ready or none is booting.
  bool mayProduceSync();
  void onSyncDue(Time now);
  void hurryProcedures(Time now);
  void sync(Time now);
  void cycle(Time now);
  /// SYNC of another device leads the cycle.
  void followSync(const can::Frame& frame, Time stamp, Time now);
  /// That SYNC is due and does not come: the cycle goes on without it, motion does not.
  void lackSync(Time now);
  /// Set-points do not reach the drives as they should: all that moves is stopped, by SDO.
  void stopForSync(const std::string& why, Time now);
  void noteSecondProducer(Time now);
  void noteLateness(Duration late, Time now);
  /// How this program was late itself around `stamp`, in words; empty if it was not.
  std::string ownLateness(Time stamp) const;
  void watchSync(Time now);
  enum class SyncTrouble : std::uint8_t { none, second_producer, absent, wrong_form, wrong_period };
  SyncTrouble syncTrouble() const;
  void watchSecondProducer(Time now);
  std::string syncText(SyncTrouble trouble) const;
  /// Why no axis may be enabled as SYNC is now, or was a moment ago; empty if it is well.
  std::string syncProblem() const;
  void stepJobs(Time now);
  void disableAtShutdown(drive::Axis& axis, Time now);
  void stepShutdown(Time now);
  void stopMotion(const std::string& why);
  /// Nothing that was asked for before enables an axis any more.
  void withdrawEnabling(const std::string& why);
  void watchAxes(Time now);
  bool isUnwell(std::size_t axis) const;
  void tellNews(std::size_t axis, Time now);
  void tellProblem(std::size_t axis, Time now);
  void watchPdos(std::size_t axis, Time now);
  void watchStream(std::size_t axis, Time now);
  std::string unknownProblem(std::size_t axis, Time now);
  void tell(Event::Severity severity, std::string_view text, Time now);
  // robot_lss.cpp
  std::string motionOnBus() const;
  std::vector<canopen::NodeId> nodesInOperation() const;
  /// At the start all nodes are reset afterwards; a look that finds nobody is no news.
  enum class LssOccasion : std::uint8_t { start, recover, look };
  void assignByLss(std::size_t index, LssOccasion occasion);
  void lssAssigned(std::size_t index, const canopen::LssTask& task, const std::string& error,
                   Time now);
  bool beginLss();
  void stepLss(Time now);
  void lookForLostDrives(Time now);
  bool recoverByLss(const std::vector<ProcedureJob::Item>& items);
  std::string notDisabled(std::size_t index) const;
  std::string bitTimingRefusal(std::size_t index, canopen::lss::Identity& identity);
  std::string activationRefusal(bool stored) const;
  /// Why no axis may be enabled now; empty if it may.
  std::string enableProblem() const;
  // robot_start.cpp
  void listenTo(const can::Frame& frame, Time now);
  void stepListening(Time now);
  void beginSending(Time now);
  void executeLater(Command command);
  void refuseForOtherMaster(const Reply& reply) const;
  void abandonStart(const std::string& why);
  void sayStep(const std::string& step);
  /// Boots the nodes and begins to cycle.
  void begin(Time now);
  /// nullptr if there is none; `reply` says so then.
  drive::Axis* axisNamed(const std::string& name, const Reply& reply);
  /// The same for what asks the drive for `what` by SDO, which it cannot answer while it is stopped
  /// (NMT).
  drive::Axis* axisToAsk(const std::string& name, const std::string& what, const Reply& reply);
  std::size_t axisOf(const canopen::Node& node) const;

  void run(ProcedureCommand& command, Reply reply, Time now);
  void run(SetpointCommand& command, const Reply& reply, Time now);
  void run(TrajectoryCommand& command, const Reply& reply, Time now);
  void run(ReadObjectCommand& command, const Reply& reply, Time now);
  void run(WriteObjectCommand& command, const Reply& reply, Time now);
  void run(NmtServiceCommand& command, const Reply& reply, Time now);
  void run(LssScanCommand& command, const Reply& reply, Time now);
  void run(LssAssignCommand& command, const Reply& reply, Time now);
  void run(LssBitTimingCommand& command, const Reply& reply, Time now);
  void run(ErrorHistoryCommand& command, const Reply& reply, Time now);
  void run(SaveDcfCommand& command, const Reply& reply, Time now);
  void run(CallCommand& command, const Reply& reply, Time now);
  /// Reads the error history of an axis that has got a fault, but not in quick succession.
  void readHistoryAfterFault(std::size_t axis, Time now);

  config::RobotConfig config_;
  EventSink& events_;
  BusListener listener_;
  std::bitset<2048> foreseen_;     ///< identifiers that receive filters pass
  std::vector<Command> deferred_;  ///< until the bus was listened to for long enough
  canopen::Master master_;
  std::vector<drive::Axis> axes_;
  std::vector<AxisMotion> motions_;
  std::vector<Group> groups_;
  std::vector<ProcedureJob> procedures_;
  std::vector<ObjectJob> objects_;
  std::vector<NmtJob> nmt_;
  can::Sink& sink_;
  LssDesk lss_;
  bool lss_starting_ = false;  ///< drives get their node-IDs before anything else
  Time next_lss_look_{};
  unsigned activations_ = 0;    ///< bit timing jobs that end with an activation, queued or running
  Time bit_timing_switched_{};  ///< all devices have taken their new bit timing by then
  std::vector<std::string> lss_problems_;  // of each axis
  std::vector<HistoryJob> histories_;
  std::vector<DcfJob> dcfs_;
  std::vector<AxisNews> news_;
  std::vector<AxisReporter> reporters_;
  std::vector<canopen::Node*> nodes_;  // of each axis
  std::vector<std::uint64_t> missed_feedback_;
  std::vector<Time> last_feedback_;
  std::vector<bool> answered_;  ///< by SDO, since tick()
  std::string bus_lost_;        ///< why; empty: it is there
  CycleStatistics statistics_;
  Time last_cycle_{};
  bool any_answered_ = false;
  bool started_ = false, sync_held_ = false;
  canopen::SyncConsumer external_sync_;
  std::uint64_t foreign_syncs_ = 0;  ///< of others, while this program produces SYNC
  std::uint64_t foreign_seen_ = 0;   ///< of them, at the last look
  unsigned foreign_looks_ = 0;       ///< in a row that found new ones
  Time last_foreign_sync_{}, sync_checked_{};
  Duration lateness_{0};              ///< of the last SYNC of this program that was late
  Time late_since_{}, late_until_{};  ///< what drives miss meanwhile may be because of it
  SyncTrouble sync_trouble_ = SyncTrouble::none;  // that was told
  SyncTrouble sync_seen_ = SyncTrouble::none;     // at the last look
  Time sync_seen_since_{};
  FixedText<256> sync_problem_;  // sync_trouble_ in words, or the other master
  Time next_sync_ = kNever, next_cycle_ = kNever, now_{};
  Shutdown shutdown_ = Shutdown::no;
  Time shutdown_began_{};
};

}  // namespace cia402::bus
