// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/bit_timing_switch.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "bus/canopen/lss_supervisor.h"
#include "bus/network.h"
#include "canopen/lss/task.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

namespace lss = canopen::lss;

/// "left (node 1) is not disabled"; empty if it is, and nothing is about to enable it.
std::string notDisabled(const drive::Axis& axis) {
  const drive::AxisState& state = axis.state();
  const drive::ProcedureStatus& procedure = axis.procedure();
  const std::string who = drive::whoIs(axis.config());
  if (procedure.running) {
    return who + " is not disabled for good: " + toString(procedure.kind) + " runs (" +
           procedure.step + ")";
  }
  const bool off = state.feedback_valid && drive::powerStageOff(state.state, state.statusword);
  const bool may_be_on = state.health == fieldbus::Health::ready && !off;
  return may_be_on ? who + " is not disabled" : std::string();
}

/// Of the silence before and after the switch, in whole milliseconds.
std::uint16_t delayOf(const LssBitTimingCommand& command) {
  const auto delay = std::chrono::duration_cast<std::chrono::milliseconds>(command.delay).count();
  return static_cast<std::uint16_t>(std::clamp<std::int64_t>(delay, 1, 65535));
}

}  // namespace

void LssBitTimingCommand::begin(Network& network, const Reply<>& reply, Time) const {
  network.lss().bitTiming().begin(*this, reply);
}

std::string BitTimingSwitch::enableProblem() const {
  if (activations_ > 0) {
    return "lss_set_bit_timing is at work (" + desk_.step() +
           "), and then all devices switch to another bit rate, which no axis may be enabled for; "
           "wait for its end";
  }
  if (cycle_.now() < switched_) {
    return "all devices switch to another bit rate at this moment; set the interface and "
           "`bus/bitrate` to it";
  }
  return {};
}

void BitTimingSwitch::begin(const LssBitTimingCommand& command, const Reply<>& reply) {
  std::vector<Drive> drives;
  const std::string why_not = refusal(command, drives);
  if (!why_not.empty()) return refuse(reply, why_not);
  const auto progress = std::make_shared<Progress>();
  progress->command = command;
  progress->reply = reply;
  progress->left = drives.size();
  if (command.activate) ++activations_;
  for (const Drive& drive : drives) set(drive, progress);
}

/// @param drives filled with those that are concerned
std::string BitTimingSwitch::refusal(const LssBitTimingCommand& command,
                                     std::vector<Drive>& drives) const {
  if (command.activate && cycle_.jobs().anyHeld()) {
    return "refused: recover waits for its turn, and enables its axes then; wait for its end";
  }
  if (command.activate && !command.axis.empty()) {
    return "refused: all drives must take a new bit rate at once; activate it for the bus";
  }
  if (!lss::bitTimingIndex(command.kbit_per_s)) {
    return "refused: there is no bit timing of " + std::to_string(command.kbit_per_s) +
           " kbit/s; CiA 305 has " + lss::bitRates();
  }
  for (const AxisUnit& unit : cycle_.units()) {
    if (!command.axis.empty() && unit.axis.config().name != command.axis) continue;
    drives.push_back({&unit, {}});
    std::string why_not = refusalOf(unit, drives.back().identity);
    if (!why_not.empty()) return why_not;
  }
  return drives.empty() ? noSuchAxis(command.axis) : std::string();
}

/// Why the bit timing of an axis' drive cannot be set; empty if it can, then `identity` is filled.
std::string BitTimingSwitch::refusalOf(const AxisUnit& unit, lss::Identity& identity) const {
  const std::string why = notDisabled(unit.axis);
  if (!why.empty()) return "refused: " + why + "; disable it first";
  const NodeUnit& node = nodes_.ofAxis(unit.index);
  if (const auto& assigned = node.config().lss) {
    identity = assigned->identity;
  } else if (const auto& read = node.node().identity()) {
    identity = {read->vendor_id, read->product_code, read->revision, read->serial};
  } else {
    return "refused: the identity of " + drive::whoIs(unit.axis.config()) +
           " is not known: it has neither `lss` in the configuration nor been there to be read";
  }
  return {};
}

/// Why not all devices may be told to take their new bit timing; empty if they may.
std::string BitTimingSwitch::activationRefusal(bool stored) const {
  for (const AxisUnit& unit : cycle_.units()) {
    const std::string why = notDisabled(unit.axis);
    if (why.empty()) continue;
    return "not activated: " + why +
           "; nothing has changed on the bus yet, but the drives hold the new bit timing and take "
           "it with the next `activate`" +
           (stored ? " or when they are powered on again" : "") +
           ": disable the axis and call it again, or set the old bit rate";
  }
  return {};
}

void BitTimingSwitch::set(const Drive& drive, const std::shared_ptr<Progress>& progress) {
  const LssBitTimingCommand& command = progress->command;
  const std::string who = drive::whoIs(drive.unit->axis.config());
  desk_.add(
      who,
      std::make_unique<canopen::LssBitTimingTask>(drive.identity, command.kbit_per_s,
                                                  command.store),
      [this, progress, who](const canopen::LssTask& task, const std::string& error, Time) {
        append(progress->text, who + ": " + (error.empty() ? task.result() : error));
        progress->success = progress->success && error.empty();
        if (--progress->left == 0) onAllSet(progress);
      },
      [unit = drive.unit] {
        const std::string why = notDisabled(unit->axis);
        return why.empty() ? why : "refused: " + why;
      });
}

void BitTimingSwitch::onAllSet(const std::shared_ptr<Progress>& progress) {
  if (progress->success && progress->command.activate) return activate(progress);
  if (progress->command.activate) --activations_;
  give(progress->reply,
       answerOf(progress->success,
                progress->text + "; nothing has changed on the bus yet: " +
                    (progress->success
                         ? "the drives take it when they are powered on again (stored) or by "
                           "`activate`; the interface and `bus/bitrate` must be set to it then"
                         : "not all drives took it, none was told to activate it")));
}

void BitTimingSwitch::activate(const std::shared_ptr<Progress>& progress) {
  desk_.add(
      "", std::make_unique<canopen::LssActivateTask>(delayOf(progress->command)),
      [this, progress](const canopen::LssTask&, const std::string& failure, Time now) {
        onActivated(*progress, failure, now);
      },
      [this, stored = progress->command.store] { return activationRefusal(stored); });
}

void BitTimingSwitch::onActivated(const Progress& progress, const std::string& failure, Time now) {
  --activations_;
  if (!failure.empty()) return refuse(progress.reply, progress.text + "; " + failure);
  const std::uint16_t delay = delayOf(progress.command);
  switched_ = now + 2 * std::chrono::milliseconds(delay);
  give(progress.reply,
       answerOf(true, progress.text + "; all devices switch in " + std::to_string(delay) +
                          " ms and are silent as long again: set the interface (ip link set ... "
                          "type can bitrate " +
                          std::to_string(progress.command.kbit_per_s) +
                          "000) and `bus/bitrate` to it now, the drives are lost until then"));
}

}  // namespace cia402::bus
