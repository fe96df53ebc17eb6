// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/touch_probe_job.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "bus/axis_cycle.h"
#include "common/text.h"
#include "decode/value_text.h"

namespace cia402::bus {
namespace {

// Of 60B8h (CiA 402-2), those of probe 1; those of probe 2 lie eight bits higher, as in 60B9h.
constexpr std::uint64_t kEnable = 0x01, kContinuous = 0x02, kByIndexPulse = 0x04, kFirstEdge = 0x10,
                        kBitsOfProbe = 0x3F;
// Of 60B9h.
constexpr std::uint64_t kFirstStored = 0x02;
constexpr unsigned kBitsPerProbe = 8;

constexpr double kLongestWait = 600.0;  // s
constexpr Duration kStatusPeriod = std::chrono::milliseconds(10);
/// For a drive to forget what it has stored, once it is disarmed.
constexpr Duration kForgetting = std::chrono::milliseconds(100);

constexpr const char* kEdgeNames[] = {"rising", "falling"};

std::string probeName(unsigned number) { return "touch probe " + std::to_string(number); }

/// Why the drive cannot be asked for an object.
std::string lackRefusal(const drive::Axis& axis, const drive::ObjectSpec& object) {
  if (!drive::saidToLack(axis.config(), object.name)) return {};
  return "the configuration says that the drive lacks " + object.name + " (`lacks`)";
}

/// The edges that are asked for, with their objects; or why they cannot be had.
Result<TouchProbeJob::Edges> wantedEdges(const drive::Axis& axis,
                                         const ArmTouchProbeCommand& command) {
  const drive::DriveProfile& profile = *axis.config().profile;
  const bool both = command.edge == "both";
  TouchProbeJob::Edges edges;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    edges[i].wanted = both || command.edge == kEdgeNames[i];
  }
  if (!edges[0].wanted && !edges[1].wanted) {
    return Error{"the edge is rising, falling or both, not \"" + command.edge + "\""};
  }
  const drive::TouchProbes::Probe& probe = profile.touch_probes->probes[command.probe - 1];
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const drive::TouchProbes::Edge& edge = i == 0 ? probe.rising : probe.falling;
    if (!edges[i].wanted) continue;
    if (edge.position.empty()) {
      return Error{"profile " + profile.name + " has nothing that stores a " + kEdgeNames[i] +
                   " edge of " + probeName(command.probe)};
    }
    edges[i].position = profile.find(edge.position);
    if (!edge.counter.empty()) edges[i].counter = profile.find(edge.counter);
    const std::string lack = lackRefusal(axis, *edges[i].position);
    if (!lack.empty()) return Error{lack};
  }
  return edges;
}

/// What of the command cannot be; empty: nothing.
std::string probeRefusal(drive::Axis& axis, const ArmTouchProbeCommand& command) {
  const drive::DriveProfile& profile = *axis.config().profile;
  if (!profile.touch_probes) {
    return "profile " + profile.name + " names no touch probes (`touch_probe`)";
  }
  if (command.probe < 1 || command.probe > drive::TouchProbes::kMost) {
    return "there are touch probes 1 and 2, not " + std::to_string(command.probe);
  }
  if (!(command.timeout > 0.0 && command.timeout <= kLongestWait)) {
    return "the timeout must be more than 0 and at most 600 s, not " + numberText(command.timeout);
  }
  std::string why = bitsRefusal(axis, *profile.find(profile.touch_probes->function));
  if (why.empty()) why = lackRefusal(axis, *profile.find(profile.touch_probes->status));
  return why;
}

std::string notArmed(const drive::Axis& axis, unsigned probe, const std::string& why) {
  return drive::whoIs(axis.config()) + ": " + probeName(probe) + " not armed: " + why;
}

std::uint64_t functionBits(const ArmTouchProbeCommand& command, const TouchProbeJob::Edges& edges) {
  std::uint64_t bits = kEnable;
  if (command.continuous) bits |= kContinuous;
  if (command.index_pulse) bits |= kByIndexPulse;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].wanted) bits |= kFirstEdge << i;
  }
  return bits;
}

}  // namespace

void ArmTouchProbeCommand::begin(AxisCycle& cycle, const Reply<TouchProbeAnswer>& reply,
                                 Time now) const {
  const auto unit = cycle.findToAsk(axis, "a touch probe");
  if (!unit) return refuse(reply, unit.error().message);
  drive::Axis& asked = (*unit)->axis;
  const std::string why = probeRefusal(asked, *this);
  if (!why.empty()) return refuse(reply, notArmed(asked, probe, why));
  const auto edges = wantedEdges(asked, *this);
  if (!edges) return refuse(reply, notArmed(asked, probe, edges.error().message));
  const drive::DriveProfile& profile = *asked.config().profile;
  const fieldbus::ObjectId function = profile.find(profile.touch_probes->function)->id;
  auto claim = cycle.claims().take({&asked.device(), function, probe});
  if (claim == nullptr) {
    return refuse(reply, notArmed(asked, probe, "another call has armed it and still waits"));
  }
  cycle.jobs().add(std::make_unique<TouchProbeJob>(asked, cycle.claims(), *this, std::move(claim),
                                                   *edges, reply, now));
}

TouchProbeJob::TouchProbeJob(drive::Axis& axis, ObjectClaims& claims,
                             const ArmTouchProbeCommand& command, ObjectClaims::Claim claim,
                             const Edges& edges, Reply<TouchProbeAnswer> reply, Time now)
    : Job(Turn::object, Ends::at_once),
      axis_(&axis),
      claims_(&claims),
      probe_(std::move(claim)),
      reply_(std::move(reply)),
      function_(axis.config().profile->find(axis.config().profile->touch_probes->function)),
      status_(axis.config().profile->find(axis.config().profile->touch_probes->status)),
      edges_(edges),
      number_(command.probe),
      armed_for_(functionBits(command, edges)),
      deadline_(now + fromSeconds(command.timeout)),
      timeout_(command.timeout),
      boot_ups_(axis.device().bootUps()),
      zero_changes_(axis.state().zero_changes) {}

bool TouchProbeJob::step(Time now) {
  watch(now);
  switch (stage_) {
    case Stage::disarming:
    case Stage::arming:
    case Stage::releasing:
      stepChange(now);
      break;
    case Stage::clearing:
    case Stage::counting:
    case Stage::watching:
    case Stage::recounting:
    case Stage::reading:
      stepTransfer(now);
      break;
    case Stage::ended:
      break;
  }
  if (stage_ != Stage::ended) return false;
  give(reply_, answer());
  return true;
}

void TouchProbeJob::abandon(const std::string& why) {
  success_ = false;
  why_ = why;
  if (armed_) remark_ = "; it is left armed";
  give(reply_, answer());
}

void TouchProbeJob::watch(Time now) {
  if (stage_ == Stage::releasing) return;
  if (axis_->device().bootUps() != boot_ups_) {
    armed_ = false;
    return end(false, "the drive has started anew, and has forgotten it");
  }
  if (axis_->state().zero_changes != zero_changes_) {
    return end(false, "the axis has got another zero meanwhile; call it again");
  }
  if (late_ || stage_ == Stage::reading || now < deadline_) return;
  late_ = true;
  ticket_.reset();
  if (!askOfEdge(Stage::reading, 0, now)) end(false, lateText());
}

std::string TouchProbeJob::lateText() const {
  std::string missing;
  const bool old = edges_[0].old || edges_[1].old;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (edges_[i].wanted && !edges_[i].stored) append(missing, kEdgeNames[i], " or ");
  }
  return "no " + missing + " edge within " + numberText(timeout_) + " s (status " +
         fieldbus::toString(status_->id) + " is " + hexText(seen_status_, 4) +
         (old ? ", with what it had stored before)" : ")");
}

void TouchProbeJob::change(Stage stage, std::uint64_t bits) {
  stage_ = stage;
  bits_ = bits;
  ticket_.reset();
  change_.reset();
}

void TouchProbeJob::stepChange(Time now) {
  if (bits_claim_ == nullptr) bits_claim_ = claims_->take({&axis_->device(), {}, 0});
  if (bits_claim_ == nullptr) return;
  const unsigned shift = kBitsPerProbe * (number_ - 1);
  if (!change_) change_.emplace(*axis_, *function_, kBitsOfProbe << shift, bits_ << shift);
  if (stage_ == Stage::arming) armed_ = true;  // or may be, from now on
  if (!change_->step()) return;
  const std::string problem = change_->problem();
  change_.reset();
  bits_claim_.reset();
  afterChange(problem, now);
}

void TouchProbeJob::afterChange(const std::string& problem, Time now) {
  if (stage_ == Stage::releasing) {
    if (!problem.empty()) remark_ = "; it may still be armed: " + problem;
    stage_ = Stage::ended;
  } else if (!problem.empty()) {
    end(false, problem);
  } else if (stage_ == Stage::arming) {
    ask(Stage::watching, *status_, now);
  } else {
    clear_until_ = now + kForgetting;
    ask(Stage::clearing, *status_, now);
  }
}

void TouchProbeJob::ask(Stage stage, const drive::ObjectSpec& object, Time due) {
  stage_ = stage;
  object_ = &object;
  due_ = due;
}

/// Asks for what belongs to an edge, from `first` on; false: none is left that has something to
/// tell.
bool TouchProbeJob::askOfEdge(Stage stage, std::size_t first, Time now) {
  for (edge_ = first; edge_ < edges_.size(); ++edge_) {
    const ProbeEdge& edge = edges_[edge_];
    const bool positions = stage == Stage::reading;
    const bool tells = positions ? edge.stored : edge.old && edge.counter != nullptr;
    if (!tells) continue;
    ask(stage, positions ? *edge.position : *edge.counter, now);
    return true;
  }
  return false;
}

void TouchProbeJob::stepTransfer(Time now) {
  if (ticket_ == nullptr) {
    if (now >= due_) ticket_ = axis_->device().objects().upload(object_->id, object_->name);
    return;
  }
  if (!ticket_->done()) return;
  const fieldbus::Ticket read = std::exchange(ticket_, nullptr);
  if (read->ok()) return take(fieldbus::toUnsigned(read->data()), now);
  end(false,
      fieldbus::toString(object_->id) + " " + object_->name + " not read: " + read->reason());
}

void TouchProbeJob::take(std::uint64_t raw, Time now) {
  ProbeEdge& edge = edges_[std::min(edge_, edges_.size() - 1)];
  switch (stage_) {
    case Stage::clearing:
      return takeCleared(raw, now);
    case Stage::counting:
      edge.count = raw;
      if (!askOfEdge(Stage::counting, edge_ + 1, now)) change(Stage::arming, armed_for_);
      return;
    case Stage::watching:
      takeStatus(raw);
      if (!askOfEdge(Stage::recounting, 0, now)) judge(now);
      return;
    case Stage::recounting:
      edge.stored = raw != edge.count;
      edge.old = !edge.stored;
      if (!askOfEdge(Stage::recounting, edge_ + 1, now)) judge(now);
      return;
    case Stage::reading:
      edge.joint = axis_->positionBy(*edge.position, raw);
      if (!askOfEdge(Stage::reading, edge_ + 1, now)) endRead();
      return;
    case Stage::disarming:
    case Stage::arming:
    case Stage::releasing:
    case Stage::ended:
      return;
  }
}

void TouchProbeJob::endRead() {
  if (late_) return end(false, lateText());
  const bool known = std::none_of(edges_.begin(), edges_.end(), [](const ProbeEdge& edge) {
    return edge.stored && std::isnan(edge.joint);
  });
  end(known, known ? "" : "stored, but where the axis is now is not known, nor where it was");
}

bool TouchProbeJob::shown(std::uint64_t status, std::size_t edge) const {
  return ((status >> (kBitsPerProbe * (number_ - 1))) & (kFirstStored << edge)) != 0;
}

void TouchProbeJob::takeCleared(std::uint64_t status, Time now) {
  bool any = false;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    edges_[i].old = edges_[i].wanted && shown(status, i);
    any = any || edges_[i].old;
  }
  if (any && now < clear_until_) return ask(Stage::clearing, *status_, now + kStatusPeriod);
  if (!askOfEdge(Stage::counting, 0, now)) change(Stage::arming, armed_for_);
}

void TouchProbeJob::takeStatus(std::uint64_t status) {
  seen_status_ = status;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    ProbeEdge& edge = edges_[i];
    if (!edge.wanted || edge.stored) continue;
    if (!shown(status, i)) {
      edge.old = false;
    } else if (!edge.old) {
      edge.stored = true;
    }
  }
}

void TouchProbeJob::judge(Time now) {
  const bool all = std::all_of(edges_.begin(), edges_.end(),
                               [](const ProbeEdge& edge) { return edge.stored || !edge.wanted; });
  if (!all) return ask(Stage::watching, *status_, now + kStatusPeriod);
  askOfEdge(Stage::reading, 0, now);
}

void TouchProbeJob::end(bool success, const std::string& why) {
  success_ = success;
  why_ = why;
  const bool stays = success && (armed_for_ & kContinuous) != 0;
  if (stays) remark_ = "; it stays armed";
  if (armed_ && !stays) return change(Stage::releasing, 0);
  stage_ = Stage::ended;
}

TouchProbeAnswer TouchProbeJob::answer() const {
  const drive::AxisConfig& config = axis_->config();
  const char* const unit = decode::unitOf(drive::Quantity::position, config);
  TouchProbeAnswer answer;
  answer.success = success_;
  answer.rising = edges_[0].joint;
  answer.falling = edges_[1].joint;
  std::string text = why_;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const ProbeEdge& edge = edges_[i];
    if (!edge.stored || std::isnan(edge.joint)) continue;
    append(text, std::string(kEdgeNames[i]) + " edge at " + numberText(edge.joint) + " " + unit,
           ", ");
  }
  if (success_ && !axis_->state().homed) text += ", by the drive's own zero: it is not homed";
  answer.message = drive::whoIs(config) + ": " + probeName(number_) + ": " + text + remark_;
  return answer;
}

}  // namespace cia402::bus
