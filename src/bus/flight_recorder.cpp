// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/flight_recorder.h"

#include <algorithm>

namespace cia402::bus {
namespace {

using Kind = RecordingTrigger::Kind;

constexpr Duration kSpare = std::chrono::seconds(1);  // while the writer takes its copy
constexpr Duration kSampleInterval = std::chrono::milliseconds(100);
constexpr double kAxisRecordsPerSecond = 40.0;  // ten samples, and changes
constexpr double kNotesPerSecond = 50.0;        // of the whole bus
constexpr std::size_t kLeastRecords = 256;
constexpr Duration kStorm = std::chrono::minutes(1);
constexpr Duration kLongestGap = std::chrono::hours(1);

std::size_t recordsIn(Duration time, double per_second) {
  return static_cast<std::size_t>(toSeconds(time) * per_second) + kLeastRecords;
}

bool isLost(can::BusState state) {
  return state == can::BusState::missing || state == can::BusState::down;
}

std::uint8_t flagsOf(const drive::AxisState& state, const drive::ProcedureStatus& procedure,
                     bool moving) {
  return static_cast<std::uint8_t>(
      (state.homed ? AxisRecord::homed : 0) | (state.warning ? AxisRecord::warning : 0) |
      (state.internal_limit ? AxisRecord::internal_limit : 0) |
      (state.ready_for_motion ? AxisRecord::ready_for_motion : 0) |
      (procedure.running ? AxisRecord::running : 0) |
      (procedure.success ? AxisRecord::succeeded : 0) | (moving ? AxisRecord::moving : 0));
}

/// Everything of an axis whose change is recorded at once, in one number.
std::uint64_t signatureOf(const drive::AxisState& state, const drive::ProcedureStatus& procedure,
                          std::uint8_t flags) {
  return static_cast<std::uint64_t>(state.state) | static_cast<std::uint64_t>(state.health) << 4 |
         static_cast<std::uint64_t>(flags) << 8 |
         static_cast<std::uint64_t>(procedure.id & 0xFFFFU) << 16 |
         static_cast<std::uint64_t>(state.error_code) << 32 |
         static_cast<std::uint64_t>(static_cast<std::uint16_t>(state.mode_value)) << 48;
}

AxisRecord recordOf(std::size_t index, const drive::Axis& axis, std::uint8_t flags, Time now) {
  const drive::AxisState& state = axis.state();
  AxisRecord record;
  record.stamp = now;
  record.position = static_cast<float>(state.position);
  record.velocity = static_cast<float>(state.velocity);
  record.effort = static_cast<float>(state.effort);
  record.following_error = static_cast<float>(state.following_error);
  record.target = static_cast<float>(axis.target());
  record.axis = static_cast<std::uint16_t>(index);
  record.statusword = state.statusword;
  record.error_code = state.error_code;
  record.mode = state.mode_value;
  record.state = static_cast<std::uint8_t>(state.state);
  record.health = static_cast<std::uint8_t>(state.health);
  record.procedure = static_cast<std::uint8_t>(axis.procedure().kind);
  record.flags = flags;
  return record;
}

/// Calls `use(node, pdo)` for every PDO in operation, always in the same order.
template <typename Use>
void forEachPdo(const Network& network, Use&& use) {
  for (const canopen::Node& node : network.master().nodes()) {
    for (const auto& pdo : node.image().tpdos()) use(node, pdo);
    for (const auto& pdo : node.image().rpdos()) use(node, pdo);
  }
}

template <typename Record, typename StampOf>
void sortFrom(std::vector<Record>& records, Time begin, Time end, StampOf stamp_of) {
  records.erase(std::remove_if(records.begin(), records.end(),
                               [&](const Record& record) {
                                 return stamp_of(record) < begin || stamp_of(record) > end;
                               }),
                records.end());
  // Frames are stamped on the wire, or when they were handed over: not quite in order.
  std::stable_sort(records.begin(), records.end(),
                   [&](const Record& a, const Record& b) { return stamp_of(a) < stamp_of(b); });
}

}  // namespace

bool RecordingLimiter::permit(Time now) {
  const bool first = last_recording_ == Time::min();
  const bool storm = !first && now - last_trigger_ < kStorm;
  last_trigger_ = now;
  if (!storm) gap_ = least_;
  if (!first && now - last_recording_ < gap_) return false;
  if (storm) gap_ = std::min<Duration>(2 * gap_, kLongestGap);
  last_recording_ = now;
  return true;
}

FlightRecorder::FlightRecorder(const config::RobotConfig& robot, can::Sink& sink)
    : sink_(sink),
      duration_(robot.recorder.duration),
      post_trigger_(robot.recorder.post_trigger),
      on_faults_(robot.recorder.keep > 0),
      frames_(can::mostFrames(robot.bus.bitrate, duration_ + kSpare)),
      axes_(recordsIn(duration_ + kSpare,
                      kAxisRecordsPerSecond * static_cast<double>(robot.axes.size()))),
      notes_(recordsIn(duration_ + kSpare, kNotesPerSecond)),
      watched_(robot.axes.size()),
      groups_(robot.groups.size()),
      emergency_limiter_(duration_),
      limiters_(robot.axes.size() + 1, RecordingLimiter(duration_)) {
  for (const config::GroupConfig& group : robot.groups) group_names_.push_back(group.name);
}

void FlightRecorder::watch(const Network& network) {
  network_ = &network;
  forEachPdo(network, [&](const canopen::Node& node, const canopen::PdoImage::Pdo& pdo) {
    identifiers_.push_back({node.id(), pdo.direction, pdo.number, pdo.cob_id});
  });
  cob_ids_ = std::vector<std::atomic<std::uint16_t>>(identifiers_.size());
  observeIdentifiers();
}

void FlightRecorder::observeIdentifiers() {
  auto place = cob_ids_.begin();
  forEachPdo(*network_, [&](const canopen::Node&, const canopen::PdoImage::Pdo& pdo) {
    (place++)->store(pdo.cob_id, std::memory_order_relaxed);
  });
}

std::size_t FlightRecorder::memory() const {
  return frames_.memory() + axes_.memory() + notes_.memory();
}

void FlightRecorder::observeCycle() {
  const Time now = network_->now();
  observed_ = network_->cycle().lastCycle();
  const bool sample = now >= sampled_ + kSampleInterval;
  if (sample) {
    sampled_ = now;
    observeIdentifiers();
  }
  for (const AxisUnit& unit : network_->cycle().units()) observeAxis(unit, sample, now);
  observeGroups(now);
}

void FlightRecorder::observeAxis(const AxisUnit& unit, bool sample, Time now) {
  const std::size_t index = unit.index;
  const drive::Axis& axis = unit.axis;
  const drive::AxisState& state = axis.state();
  const drive::ProcedureStatus& procedure = axis.procedure();
  Watched& watched = watched_[index];
  if (procedure.running) observeStep(index, axis, now);
  const bool moving = !axis.stream().at_rest;
  const bool known = watched.signature != 0 && watched.condition == state &&
                     watched.last_procedure == procedure.id &&
                     watched.running == procedure.running &&
                     watched.succeeded == procedure.success && watched.moving == moving;
  if (known && !sample) return;
  watched.condition = state;
  watched.last_procedure = procedure.id;
  watched.running = procedure.running;
  watched.succeeded = procedure.success;
  watched.moving = moving;
  const std::uint8_t flags = flagsOf(state, procedure, moving);
  const std::uint64_t signature = signatureOf(state, procedure, flags);
  if (signature != watched.signature) {
    watched.signature = signature;
    axes_.push(recordOf(index, axis, flags, now));
    lookForFault(index, state, now);
  } else if (sample) {
    axes_.push(recordOf(index, axis, flags, now));
  }
}

void FlightRecorder::observeStep(std::size_t index, const drive::Axis& axis, Time now) {
  Watched& watched = watched_[index];
  const drive::ProcedureStatus& procedure = axis.procedure();
  if (watched.procedure == procedure.id && watched.step == procedure.step) return;
  watched.procedure = procedure.id;
  watched.step.assign(procedure.step);
  notes_.push({NoteRecord::Kind::step, index, watched.step.view(), now});
}

void FlightRecorder::observeGroups(Time now) {
  const std::vector<Group>& groups = network_->cycle().groups();
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::uint8_t motion = groups[i].stopping() ? 2 : groups[i].executing() ? 1 : 0;
    if (motion == groups_[i]) continue;
    groups_[i] = motion;
    static constexpr const char* kWords[] = {": at rest", ": follows a trajectory",
                                             ": is brought to rest"};
    NoteRecord note(NoteRecord::Kind::group, NoteRecord::kNoAxis, group_names_[i], now);
    note.append(kWords[motion]);
    notes_.push(note);
  }
}

void FlightRecorder::lookForFault(std::size_t index, const drive::AxisState& state, Time now) {
  Watched& watched = watched_[index];
  const bool faulted = drive::isFault(state.state) && !drive::isFault(watched.state);
  const bool fell = state.health != watched.health && !network_->shutDown();
  watched.state = state.state;
  watched.health = state.health;
  if (faulted) trigger(Kind::fault, index, state.error_code, now);
  if (fell && state.health == fieldbus::Health::lost) trigger(Kind::node_lost, index, 0, now);
  if (fell && state.health == fieldbus::Health::failed) {
    trigger(Kind::node_failed, index, 0, now);
  }
}

void FlightRecorder::onEvent(const Event& event) {
  notes_.push({NoteRecord::Kind::event, NoteRecord::kNoAxis, event.text.view(), event.stamp});
}

void FlightRecorder::onEmergency(const EmergencyEvent& event) {
  if (event.emergency.code == 0) return;
  trigger(Kind::emergency, event.axis, event.emergency.code, event.emergency.stamp);
}

void FlightRecorder::onInterface(can::BusState state, Time now) {
  const can::BusState before = interface_;
  interface_ = state;
  if (before == state) return;
  if (state == can::BusState::bus_off) trigger(Kind::bus_off, 0, 0, now);
  if (isLost(state) && !isLost(before)) trigger(Kind::interface_lost, 0, 0, now);
}

RecordingLimiter& FlightRecorder::limiterOf(Kind kind, std::size_t axis) {
  if (kind == Kind::emergency) return emergency_limiter_;
  return limiters_[namesAxis(kind) ? axis : limiters_.size() - 1];
}

void FlightRecorder::trigger(Kind kind, std::size_t axis, std::uint16_t code, Time now) {
  if (!on_faults_) return;
  if (now > recording_until_) {
    if (!limiterOf(kind, axis).permit(now)) {
      ++suppressed_;
      return;
    }
    recording_until_ = now + post_trigger_;
  }
  RecordingTrigger trigger;
  trigger.kind = kind;
  trigger.axis = static_cast<std::uint16_t>(axis);
  trigger.code = code;
  trigger.stamp = now;
  if (!triggers_.push(RecordingTrigger(trigger))) ++suppressed_;
  triggered_ = true;
}

Recording FlightRecorder::copy(Time end) const {
  Recording recording;
  recording.begin = end - duration_;
  recording.end = end;
  recording.frames = frames_.copy();
  recording.axes = axes_.copy();
  recording.notes = notes_.copy();
  recording.identifiers = identifiers_;
  for (std::size_t i = 0; i < cob_ids_.size(); ++i) {
    recording.identifiers[i].cob_id = cob_ids_[i].load(std::memory_order_relaxed);
  }
  sortFrom(recording.frames, recording.begin, end,
           [](const can::FrameRecord& record) { return record.stamp(); });
  sortFrom(recording.axes, recording.begin, end,
           [](const AxisRecord& record) { return record.stamp; });
  sortFrom(recording.notes, recording.begin, end,
           [](const NoteRecord& record) { return record.stamp; });
  return recording;
}

}  // namespace cia402::bus
