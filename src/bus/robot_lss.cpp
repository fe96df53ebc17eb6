// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Layer setting services of a robot: drives that the configuration names by identity get their
// node-IDs, and people may look for others.
#include <algorithm>
#include <cmath>

#include "cia402_driver/bus/robot.h"
#include "cia402_driver/canopen/lss/scan.h"

namespace cia402::bus {
namespace {

using fieldbus::Health;
namespace lss = canopen::lss;

constexpr Duration kLookInterval = std::chrono::seconds(5);
constexpr int kLookAttempts = 2;  // as it is looked for again anyway
/// After which one that boots has sent its boot-up message; the others are asked.
constexpr Duration kBootUpTime = std::chrono::milliseconds(500);

// Waited for by the boot procedure, but silent since the start.
bool neverHeard(const canopen::Node& node) {
  const auto& answers = node.sdo().counters();
  return node.bootUps() == 0 && node.lastHeartbeat() == Time() && answers.completed == 0 &&
         answers.aborted == 0;
}

/// It failed, or was taken out of operation, and its heartbeat has ended since.
bool fellSilent(const canopen::Node& node, Time now) {
  return node.health() == Health::failed &&
         node.supervision().kind == canopen::ErrorControl::heartbeat &&
         now > node.lastHeartbeat() + node.config().heartbeat_timeout;
}

}  // namespace

/// Why nothing that delays other things may be begun; empty if it may.
std::string Robot::motionOnBus() const {
  for (const Group& group : groups_) {
    if (group.executing() || group.stopping()) {
      return "refused: the group " + group.config().name + " is in motion";
    }
  }
  for (const drive::Axis& axis : axes_) {
    const drive::AxisState& state = axis.state();
    if (state.health != Health::ready) continue;
    const bool still = std::abs(state.velocity) < axis.config().standstill_velocity;
    if (!still && !(state.feedback_valid && drive::powerStageOff(state.state, state.statusword))) {
      return "refused: " + drive::whoIs(axis.config()) + " may be in motion; stop it first";
    }
  }
  return {};
}

std::vector<canopen::NodeId> Robot::nodesInOperation() const {
  std::vector<canopen::NodeId> ids = {config_.bus.node_id};
  for (const canopen::Node& node : master_.nodes()) {
    if (fieldbus::isAway(node.health()) || neverHeard(node) || fellSilent(node, now_)) continue;
    ids.push_back(node.id());
  }
  return ids;
}

/// Gives the drive of an axis its node-ID.
void Robot::assignByLss(std::size_t index, LssOccasion occasion) {
  const drive::AxisConfig& axis = config_.axes[index];
  canopen::LssAssignTask::Options options;
  const canopen::DeviceConfig& device = config_.deviceOf(axis);
  options.identity = device.lss->identity;
  options.node_id = device.node_id;
  options.store = device.lss->store;
  options.reset = occasion != LssOccasion::start;
  if (options.reset) options.in_use = [this] { return nodesInOperation(); };
  const bool looking = occasion == LssOccasion::look;
  if (looking) options.attempts = kLookAttempts;
  lss_.add(axis.name, std::make_unique<canopen::LssAssignTask>(std::move(options), sink_),
           [=](const canopen::LssTask& task, const std::string& error, Time now) {
             if (shutdown_ != Shutdown::no) return;
             const auto& assigned = static_cast<const canopen::LssAssignTask&>(task);
             if (occasion != LssOccasion::start && error.empty()) {
               nodes_[index]->look(now + kBootUpTime);
             }
             const bool news = error.empty() ? assigned.changed() : !assigned.absent();
             if (news || !looking) lssAssigned(index, task, error, now);
           });
}

void Robot::lssAssigned(std::size_t index, const canopen::LssTask& task, const std::string& error,
                        Time now) {
  const bool success = error.empty();
  const std::string text =
      drive::whoIs(config_.axes[index]) + ": LSS: " + (success ? task.result() : error);
  if (success) {
    lss_problems_[index].clear();
    tell(Event::Severity::info, text, now);
  } else if (lss_problems_[index] != text) {
    lss_problems_[index] = text;
    tell(Event::Severity::error, text, now);
  }
}

/// @return true if node-IDs are given out before anything else.
bool Robot::beginLss() {
  for (std::size_t i = 0; i < config_.axes.size(); ++i) {
    if (config_.deviceOf(config_.axes[i]).lss) assignByLss(i, LssOccasion::start);
  }
  return lss_.busy();
}

void Robot::stepLss(Time now) {
  lss_.tick(now);
  if (lss_starting_) {
    for (std::size_t i = 0; i < config_.axes.size(); ++i) {
      const bool working = lss_.busy() && lss_.who() == config_.axes[i].name;
      AxisWords& words = news_[i].words;
      words.say(&AxisWords::step, working       ? lss_.step()
                                  : lss_.busy() ? "LSS: waiting for its turn"
                                                : "");
      words.say(&AxisWords::problem, lss_problems_[i]);
    }
    if (lss_.busy()) return;
    lss_starting_ = false;
    begin(now);
    return;
  }
  if (lss_.busy()) return;
  for (ProcedureJob& job : procedures_) job.release();
}

/// A drive that comes without a node-ID cannot announce itself by a boot-up message: while one is
/// away, it is called by its identity. Not by "identify non-configured remote slave" (4Ch), which
/// many slaves do not know (CANopenNode, 305/CO_LSSslave.c).
void Robot::lookForLostDrives(Time now) {
  if (lss_.busy() || now < next_lss_look_) return;
  next_lss_look_ = now + kLookInterval;
  if (shutdown_ != Shutdown::no) return;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const bool away = fieldbus::isAway(axes_[i].state().health);
    if (config_.deviceOf(config_.axes[i]).lss && away) assignByLss(i, LssOccasion::look);
  }
}

/// Recovering begins with the node-ID where the drive may have lost it.
bool Robot::recoverByLss(const std::vector<ProcedureJob::Item>& items) {
  bool needed = false;
  for (const ProcedureJob::Item& item : items) {
    const Health health = axes_[item.axis].state().health;
    const bool there = health == Health::booting || health == Health::ready;
    if (!config_.deviceOf(config_.axes[item.axis]).lss || there) continue;
    assignByLss(item.axis, LssOccasion::recover);
    needed = true;
  }
  return needed;
}

void Robot::run(LssScanCommand& command, const Reply& reply, Time) {
  const std::string refusal = motionOnBus();
  if (!refusal.empty()) return refuse(reply, refusal);
  lss_.add(
      "", std::make_unique<canopen::LssScanTask>(),
      [this, reply](const canopen::LssTask& task, const std::string& error, Time) {
        const auto& scan = static_cast<const canopen::LssScanTask&>(task);
        const bool success = error.empty();
        Answer answer = answerOf(success && !scan.incomplete(), success ? task.result() : error);
        for (const lss::Identity& identity : scan.found()) {
          answer.devices.push_back(identity);
          answer.device_axes.emplace_back();
          std::string owner;
          for (const drive::AxisConfig& axis : config_.axes) {
            const auto& assigned = config_.deviceOf(axis).lss;
            const bool its = assigned && assigned->identity == identity;
            if (its) answer.device_axes.back() = axis.name;
            if (its) owner = " is that of " + drive::whoIs(axis);
          }
          answer.message += "; " + toString(identity) + owner;
        }
        give(reply, answer);
      },
      [this] { return motionOnBus(); }, command.window);
}

void Robot::run(LssAssignCommand& command, const Reply& reply, Time) {
  if (command.node_id < 1 || command.node_id > 127) {
    return refuse(reply,
                  "refused: node-ID " + std::to_string(command.node_id) + " is not in 1..127");
  }
  const auto node = static_cast<canopen::NodeId>(command.node_id);
  const std::vector<canopen::NodeId> in_use = nodesInOperation();
  if (std::find(in_use.begin(), in_use.end(), node) != in_use.end()) {
    const bool own = node == config_.bus.node_id;
    return refuse(reply, "refused: node-ID " + std::to_string(node) +
                             (own ? " is the master's own" : " is that of a drive in operation"));
  }
  const std::string refusal = motionOnBus();
  if (!refusal.empty()) return refuse(reply, refusal);
  canopen::LssAssignTask::Options options;
  options.identity = command.identity;
  options.node_id = node;
  options.store = command.store;
  options.in_use = [this] { return nodesInOperation(); };
  const std::string device = toString(command.identity);
  lss_.add(
      "", std::make_unique<canopen::LssAssignTask>(std::move(options), sink_),
      [this, reply, device, node](const canopen::LssTask& task, const std::string& error,
                                  Time now) {
        const bool success = error.empty();
        canopen::Node* const own = success ? master_.find(node) : nullptr;
        if (own != nullptr) own->look(now + kBootUpTime);
        give(reply, answerOf(success, device + ": " + (success ? task.result() : error)));
      },
      [this] { return motionOnBus(); });
}

/// "left (node 1) is not disabled"; empty if it is, and nothing is about to enable it.
std::string Robot::notDisabled(std::size_t index) const {
  const drive::Axis& axis = axes_[index];
  const drive::AxisState& state = axis.state();
  const drive::ProcedureStatus& procedure = axis.procedure();
  const std::string who = drive::whoIs(axis.config());
  if (procedure.running) {
    return who + " is not disabled for good: " + toString(procedure.kind) + " runs (" +
           procedure.step + ")";
  }
  const bool off = state.feedback_valid && drive::powerStageOff(state.state, state.statusword);
  return state.health == Health::ready && !off ? who + " is not disabled" : std::string();
}

/// Why not all devices may be told to take their new bit timing; empty if they may.
std::string Robot::activationRefusal(bool stored) const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const std::string why = notDisabled(i);
    if (why.empty()) continue;
    return "not activated: " + why +
           "; nothing has changed on the bus yet, but the drives hold the new bit timing and take "
           "it with the next `activate`" +
           (stored ? " or when they are powered on again" : "") +
           ": disable the axis and call it again, or set the old bit rate";
  }
  return {};
}

std::string Robot::enableProblem() const {
  if (activations_ > 0) {
    return "lss_set_bit_timing is at work (" + lss_.step() +
           "), and then all devices switch to another bit rate, which no axis may be enabled for; "
           "wait for its end";
  }
  if (now_ < bit_timing_switched_) {
    return "all devices switch to another bit rate at this moment; set the interface and "
           "`bus/bitrate` to it";
  }
  return syncProblem();
}

/// Why the bit timing of an axis' drive cannot be set; empty if it can, then `identity` is filled.
std::string Robot::bitTimingRefusal(std::size_t index, lss::Identity& identity) {
  const drive::AxisConfig& config = axes_[index].config();
  const std::string why = notDisabled(index);
  if (!why.empty()) return "refused: " + why + "; disable it first";
  if (const auto& assigned = config_.deviceOf(config).lss) {
    identity = assigned->identity;
  } else if (const auto& read = nodes_[index]->identity()) {
    identity = {read->vendor_id, read->product_code, read->revision, read->serial};
  } else {
    return "refused: the identity of " + drive::whoIs(config) +
           " is not known: it has neither `lss` in the configuration nor been there to be read";
  }
  return {};
}

void Robot::run(LssBitTimingCommand& command, const Reply& reply, Time) {
  const std::string rate = std::to_string(command.kbit_per_s);
  std::vector<std::pair<std::size_t, lss::Identity>> drives;
  std::string refusal;
  for (std::size_t i = 0; i < axes_.size() && refusal.empty(); ++i) {
    if (!command.axis.empty() && axes_[i].config().name != command.axis) continue;
    drives.emplace_back(i, lss::Identity());
    refusal = bitTimingRefusal(i, drives.back().second);
  }
  if (drives.empty()) refusal = noSuchAxis(command.axis);
  if (!lss::bitTimingIndex(command.kbit_per_s)) {
    refusal =
        "refused: there is no bit timing of " + rate + " kbit/s; CiA 305 has " + lss::bitRates();
  }
  if (command.activate && !command.axis.empty()) {
    refusal = "refused: all drives must take a new bit rate at once; activate it for the bus";
  }
  const bool recovers = std::any_of(procedures_.begin(), procedures_.end(),
                                    [](const ProcedureJob& job) { return job.held(); });
  if (command.activate && recovers) {
    refusal = "refused: recover waits for its turn, and enables its axes then; wait for its end";
  }
  if (!refusal.empty()) return refuse(reply, refusal);

  struct Progress {
    std::string text;
    std::size_t left = 0;
    bool success = true;
  };
  const auto progress = std::make_shared<Progress>();
  progress->left = drives.size();
  const bool activate = command.activate, store = command.store;
  if (activate) ++activations_;
  const auto delay = static_cast<std::uint16_t>(
      std::clamp<std::int64_t>(command.delay.count() / 1000000, 1, 65535));
  const auto activated = [=](const canopen::LssTask&, const std::string& failure, Time now) {
    --activations_;
    if (!failure.empty()) return refuse(reply, progress->text + "; " + failure);
    bit_timing_switched_ = now + 2 * std::chrono::milliseconds(delay);
    give(reply,
         answerOf(true, progress->text + "; all devices switch in " + std::to_string(delay) +
                            " ms and are silent as long again: set the interface (ip link set ... "
                            "type can bitrate " +
                            rate +
                            "000) and `bus/bitrate` to it now, the drives are lost until then"));
  };
  for (const auto& [index, identity] : drives) {
    const std::string who = drive::whoIs(axes_[index].config());
    lss_.add(
        who,
        std::make_unique<canopen::LssBitTimingTask>(identity, command.kbit_per_s, command.store),
        [=](const canopen::LssTask& task, const std::string& error, Time) {
          const bool success = error.empty();
          progress->text +=
              (progress->text.empty() ? "" : "; ") + who + ": " + (success ? task.result() : error);
          progress->success = progress->success && success;
          if (--progress->left > 0) return;
          if (progress->success && activate) {
            return lss_.add("", std::make_unique<canopen::LssActivateTask>(delay), activated,
                            [this, store] { return activationRefusal(store); });
          }
          if (activate) --activations_;
          std::string end = "; nothing has changed on the bus yet: ";
          end += progress->success
                     ? "the drives take it when they are powered on again (stored) or by "
                       "`activate`; the interface and `bus/bitrate` must be set to it then"
                     : "not all drives took it, none was told to activate it";
          give(reply, answerOf(progress->success, progress->text + end));
        },
        [this, i = index] {
          const std::string why = notDisabled(i);
          return why.empty() ? why : "refused: " + why;
        });
  }
}

}  // namespace cia402::bus
