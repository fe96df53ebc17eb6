// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bus/event.h"
#include "bus/fixed_text.h"
#include "bus/network.h"
#include "bus/recording.h"
#include "bus/spsc_queue.h"
#include "can/bus.h"
#include "can/record_ring.h"

namespace cia402::bus {

/// Says how often faults may be recorded: at once while they are rare; in a storm (less than a
/// minute from one to the next) after a gap that doubles with every recording, up to an hour.
class RecordingLimiter {
 public:
  /// @param gap the least time between two recordings.
  explicit RecordingLimiter(Duration gap) : least_(gap), gap_(gap) {}
  /// A fault: may it be recorded?
  bool permit(Time now);

 private:
  Duration least_, gap_;
  Time last_trigger_ = Time::min(), last_recording_ = Time::min();
};

/// The last seconds of a bus in fixed memory: frames received and sent, axis states, and what was
/// told. Stands between a network and its interface as LoadMeter does. The thread of the bus
/// writes; it neither waits nor allocates. Another thread takes triggers and copies.
class FlightRecorder final : public can::Sink {
 public:
  /// Takes all the memory. @param sink where frames go; must outlive the recorder.
  FlightRecorder(const config::RobotConfig& robot, can::Sink& sink);

  // The thread of the bus:
  /// The network whose axes are recorded and by whose time frames are stamped; before it sends.
  void watch(const Network& network);
  /// Records what the interface takes. Not inlined, as can::Pacer::send().
  [[gnu::noinline]] bool send(const can::Frame& frame) override {
    if (!sink_.send(frame)) return false;
    frames_.push({frame, network_->now(), true});
    return true;
  }
  /// A frame from the bus. @param stamp when it was on the wire.
  void received(const can::Frame& frame, Time stamp) { frames_.push({frame, stamp, false}); }
  /// To be called after Network::tick(): records the axes if there was a cycle, and looks for
  /// faults.
  void observe() {
    if (network_->cycle().lastCycle() != observed_) observeCycle();
  }
  void onEvent(const Event& event);
  void onEmergency(const EmergencyEvent& event);
  /// The interface has another state.
  void onInterface(can::BusState state, Time now);
  /// Were there triggers since the last call?
  bool triggered() { return std::exchange(triggered_, false); }

  // One other thread at a time:
  /// The next trigger, oldest first. @return false if there is none.
  bool nextTrigger(RecordingTrigger& trigger) { return triggers_.pop(trigger); }
  /// What was recorded in the configured time before `end`, sorted by time. Allocates.
  Recording copy(Time end) const;

  // Any thread:
  /// Bytes taken at construction.
  std::size_t memory() const;
  std::size_t frameCapacity() const { return frames_.capacity(); }
  /// Faults that were not recorded because there were too many.
  std::uint64_t suppressed() const { return suppressed_.load(); }

 private:
  struct Watched {  // of an axis
    // All that decides whether it is recorded, as it was looked at last:
    drive::AxisCondition condition;
    std::uint32_t last_procedure = 0;
    bool running = false, succeeded = false, moving = false;
    // As it was recorded last:
    std::uint64_t signature = 0;
    drive::State state = drive::State::unknown;
    fieldbus::Health health = fieldbus::Health::absent;
    std::uint32_t procedure = 0;
    FixedText<96> step;
  };

  void observeCycle();
  void observeAxis(const AxisUnit& unit, bool sample, Time now);
  void observeStep(std::size_t index, const drive::Axis& axis, Time now);
  void observeGroups(Time now);
  void observeIdentifiers();
  void lookForFault(std::size_t index, const drive::AxisState& state, Time now);
  RecordingLimiter& limiterOf(RecordingTrigger::Kind kind, std::size_t axis);
  void trigger(RecordingTrigger::Kind kind, std::size_t axis, std::uint16_t code, Time now);

  can::Sink& sink_;
  const Network* network_ = nullptr;
  Duration duration_, post_trigger_;
  bool on_faults_;
  can::RecordRing<can::FrameRecord> frames_;
  can::RecordRing<AxisRecord> axes_;
  can::RecordRing<NoteRecord> notes_;
  std::vector<Watched> watched_;
  std::vector<std::uint8_t> groups_;
  std::vector<std::string> group_names_;
  std::vector<PdoIdentifier> identifiers_;  // fixed once the network is known, but the COB-IDs:
  std::vector<std::atomic<std::uint16_t>> cob_ids_;
  SpscQueue<RecordingTrigger> triggers_{64};
  RecordingLimiter emergency_limiter_;      // one for all: a storm of them hides no failure
  std::vector<RecordingLimiter> limiters_;  // failures of each axis, and of the bus
  Time observed_{}, sampled_{}, recording_until_ = Time::min();
  bool triggered_ = false;
  can::BusState interface_ = can::BusState::missing;
  std::atomic<std::uint64_t> suppressed_{0};
};

}  // namespace cia402::bus
