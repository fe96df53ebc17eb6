// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "bus/bus_loop.h"
#include "bus/bus_time.h"
#include "bus/command.h"
#include "bus/event.h"
#include "bus/realtime.h"
#include "bus/recording_service.h"
#include "bus/snapshot.h"
#include "bus/spsc_queue.h"
#include "bus/triple_buffer.h"
#include "can/bus.h"

namespace cia402::bus {

/// Runs a Network on a CAN interface at the pace of the clock: one thread that owns both. Other
/// threads reach it through post(), snapshot() and nextEvent() only.
class BusRunner final : private EventSink {
 public:
  struct Options {
    int priority = 80;  ///< SCHED_FIFO priority, 1..99; 0: leave scheduling and memory alone
    BusTime::Kind time = BusTime::Kind::real;  ///< simulated: the bus lives inside this process
    std::function<Time()> clock = realNow;     ///< of BusTime
  };

  /// @param robot valid configuration, @param master made from it.
  BusRunner(config::RobotConfig robot, canopen::MasterConfig master,
            std::unique_ptr<can::Interface> interface, Options options);
  /// Shuts down in good order if that has not been done.
  ~BusRunner() override;

  /// Starts the thread. Where the interface is missing or down it waits for it.
  void start();
  /// Begins the orderly shutdown; returns at once.
  void requestShutdown();
  /// Waits for the end of the thread, at most about 2 s on the bus after requestShutdown().
  void join();
  bool running() const { return running_.load(); }

  /// Any thread: queues a command. If there is no room or no running thread, its reply is given at
  /// once and false returned.
  bool post(Command command);
  /// Any thread: the newest snapshot; before the first cycle all that is configured, as unknown.
  NetworkSnapshot snapshot();
  /// Any thread: what a snapshot shows of the axes is shown to somebody, at the rate of these
  /// calls. What no TPDO brings and only people want is read no oftener: drive::Axis::look().
  void look() { looked_ = true; }
  /// One thread: the next event. @return false if there is none.
  bool nextEvent(Event& event) { return events_.pop(event); }
  /// One thread: the next emergency. @return false if there is none.
  bool nextEmergency(EmergencyEvent& event) { return emergencies_.pop(event); }
  /// Any thread: the time of snapshots, commands, events and emergencies.
  const BusTime& time() const { return time_; }
  /// Events that found no room, since start.
  std::uint64_t lostEvents() const { return lost_events_.load(); }
  /// The flight recorder's files.
  RecordingService& recordings() { return recordings_; }
  /// Emergencies that found no room, since start; counted in the snapshot all the same.
  std::uint64_t lostEmergencies() const { return lost_emergencies_.load(); }
  /// Valid once running(); what the operating system granted.
  RealtimeReport realtime();

 private:
  void onEvent(const Event& event) override;
  void onEmergency(const EmergencyEvent& event) override;
  void run();
  void iterate(Time now);
  NetworkSnapshot first() const;
  void publish(Time now);
  void fill(NetworkSnapshot& snapshot, Time now) const;
  void wait();
  void wake() const;
  void refuseRest();

  Options options_;
  BusTime time_;
  std::unique_ptr<can::Interface> interface_;
  BusLoop loop_;
  int wake_fd_;
  SpscQueue<Command> mailbox_{256};
  std::mutex producers_;  // among the posting threads only
  SpscQueue<Event> events_{512};
  SpscQueue<EmergencyEvent> emergencies_{4096};  // half a second of nothing else at 1 Mbit/s
  TripleBuffer<NetworkSnapshot> snapshots_;
  std::mutex readers_;  // among the reading threads only
  RealtimeReport realtime_;
  std::mutex realtime_mutex_;
  std::atomic<std::uint64_t> lost_events_{0}, lost_emergencies_{0};
  std::atomic<bool> running_{false}, shutdown_requested_{false}, looked_{false};
  std::uint64_t published_cycle_ = 0;
  Time published_{};
  Time due_ = kNever;  // when the loop has to go round again
  RecordingService recordings_;
  std::thread thread_;
};

}  // namespace cia402::bus
