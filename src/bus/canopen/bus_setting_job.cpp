// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/bus_setting_job.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "bus/network.h"
#include "common/text.h"
#include "drive/profile/named_write.h"
#include "drive/profile/object_value.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {
namespace {

using canopen::BusSetting;

std::string notSet(const drive::Axis& axis, const std::string& why) {
  return drive::whoIs(axis.config()) + ": bus parameters not set: " + why;
}

/// Who else goes by it, and may be back at any time; empty if nobody does. A drive that is in the
/// robot's file and was never heard may be the one that gets its node-ID now.
std::string ownerOf(unsigned node_id, const drive::Axis& asked, Network& network) {
  const config::RobotConfig& robot = network.config();
  if (node_id == robot.bus.node_id) return "the master's own";
  const canopen::Node* const node = network.master().find(static_cast<canopen::NodeId>(node_id));
  if (node == nullptr || !node->everHeard()) return {};
  for (const drive::AxisConfig& axis : robot.axes) {
    const bool same_drive = axis.device == asked.config().device;
    if (!same_drive && robot.deviceOf(axis).node_id == node_id) return "that of " + axis.name;
  }
  return {};
}

std::string knownRates(const BusSetting& setting) {
  std::string text;
  for (const auto& [rate, number] : setting.numbers) append(text, std::to_string(rate), ", ");
  return text;
}

}  // namespace

Result<BusSettingChange> busSettingChange(const drive::Axis& axis,
                                          const canopen::DeviceProfile& device,
                                          const SetBusParametersCommand& command) {
  const drive::DriveProfile& profile = *axis.config().profile;
  const bool node = command.node_id != 0;
  if (node == (command.bit_rate != 0)) {
    return Error{"give a node_id or a bit_rate, one of them, and 0 for the other"};
  }
  BusSettingChange change;
  change.what = node ? "node-ID" : "bit rate";
  change.settings = &device.bus_settings;
  change.setting = node ? &change.settings->node_id : &change.settings->bit_rate;
  change.object = profile.find(change.setting->object);
  if (change.object == nullptr) {
    return Error{"profile " + profile.name + " names no object that holds the " + change.what +
                 " (`bus_settings`); drives with LSS take it by lss_assign and "
                 "lss_set_bit_timing"};
  }
  if (node) {
    if (command.node_id > 127) return Error{"a node-ID is 1 to 127"};
    change.number = command.node_id;
    change.value = std::to_string(command.node_id);
    change.file = "`node_id` of axes/" + axis.config().name;
    return change;
  }
  const auto known = change.setting->numbers.find(command.bit_rate);
  if (known == change.setting->numbers.end()) {
    return Error{"the drive has no bit rate " + std::to_string(command.bit_rate) + "; it has " +
                 knownRates(*change.setting) + " bit/s"};
  }
  change.number = known->second;
  change.value = std::to_string(command.bit_rate) + " bit/s";
  change.file = "`bitrate` of the bus, and that of every other device on it";
  return change;
}

void SetBusParametersCommand::begin(Network& network, const Reply<>& reply, Time) const {
  AxisCycle& cycle = network.cycle();
  const auto unit = cycle.findToAsk(axis, "its bus parameters");
  if (!unit) return refuse(reply, unit.error().message);
  drive::Axis& asked = (*unit)->axis;
  const canopen::DeviceProfile& device = *network.config().deviceOf(asked.config()).profile;
  const auto change = busSettingChange(asked, device, *this);
  if (!change) return refuse(reply, notSet(asked, change.error().message));
  const std::string owner = node_id == 0 ? std::string() : ownerOf(node_id, asked, network);
  if (!owner.empty()) {
    return refuse(reply, notSet(asked, "node-ID " + std::to_string(node_id) + " is " + owner +
                                           ", and two would follow the same frames; where drives "
                                           "are to be swapped, give one a free node-ID first"));
  }
  const std::string moves = asked.calibrationRefusal();
  if (!moves.empty()) return refuse(reply, notSet(asked, moves));
  cycle.jobs().add(std::make_unique<BusSettingJob>(asked, *change, confirm, reply));
}

BusSettingJob::BusSettingJob(drive::Axis& axis, const BusSettingChange& change, bool confirmed,
                             Reply<> reply)
    : Job(Turn::object, Ends::with_motion),
      axis_(&axis),
      change_(change),
      confirmed_(confirmed),
      reply_(std::move(reply)) {
  read(Stage::reading);
}

void BusSettingJob::read(Stage stage) {
  stage_ = stage;
  ticket_ = axis_->device().objects().upload(change_.object->id, change_.object->name);
}

/// Once: what came of an answer that is lost is not known.
void BusSettingJob::write(const drive::ObjectSpec& object, std::int64_t number, Stage stage) {
  stage_ = stage;
  fieldbus::AccessOptions once;
  once.timeout = std::chrono::seconds(1);
  once.retries = 0;
  ticket_ = axis_->device().objects().download(
      object.id, drive::wireBytes(static_cast<std::uint64_t>(number), object.type), object.name,
      once);
}

bool BusSettingJob::step(Time) {
  if (!ticket_->done()) return false;
  const drive::DriveProfile& profile = *axis_->config().profile;
  switch (stage_) {
    case Stage::reading:
      return takeOld();
    case Stage::opening:
      if (!ticket_->ok()) return fail(ticket_->message());
      write(*change_.object, change_.number, Stage::writing);
      return false;
    case Stage::writing:
      return takeWritten();
    case Stage::closing:
      if (!problem_.empty()) return fail(problem_);
      if (change_.setting->counts == BusSetting::Counts::at_once) return finish();
      read(Stage::comparing);
      return false;
    case Stage::comparing: {
      const bool same = ticket_->ok() &&
                        drive::wholeNumber(change_.object->type, ticket_->data()) == change_.number;
      return same ? finish()
                  : fail("the drive has taken the write, but does not show it: read " +
                         profile.find(change_.setting->object)->name);
    }
  }
  return true;
}

bool BusSettingJob::takeOld() {
  if (!ticket_->ok()) return fail(ticket_->message());
  old_ = drive::wholeNumber(change_.object->type, ticket_->data());
  const drive::DriveProfile& profile = *axis_->config().profile;
  const std::string object =
      change_.object->name + " (" + fieldbus::toString(change_.object->id) + ")";
  if (!confirmed_) {
    return fail("nothing was written: " + object + " is " + numberText(old_) + " and would be " +
                numberText(change_.number) + " (" + change_.what + " " + change_.value + "), " +
                consequence() + "; call it again with confirm: true");
  }
  const std::string moves = axis_->calibrationRefusal();
  if (!moves.empty()) return fail(moves);
  if (change_.settings->memory.empty()) {
    write(*change_.object, change_.number, Stage::writing);
  } else {
    write(*profile.find(change_.settings->memory), change_.settings->memory_on, Stage::opening);
  }
  return false;
}

bool BusSettingJob::takeWritten() {
  const drive::DriveProfile& profile = *axis_->config().profile;
  const bool at_once = change_.setting->counts == BusSetting::Counts::at_once;
  const bool lost = ticket_->failure() == fieldbus::Transfer::Failure::timed_out;
  const bool opened = !change_.settings->memory.empty();
  if (!ticket_->ok() && !(at_once && lost)) {
    problem_ = ticket_->message();
    if (!opened) return fail(problem_);
  }
  doubtful_ = problem_.empty() && !ticket_->ok();
  if (doubtful_ || (at_once && !opened)) return finish();
  if (opened) {
    write(*profile.find(change_.settings->memory), change_.settings->memory_off, Stage::closing);
  } else {
    read(Stage::comparing);
  }
  return false;
}

std::string BusSettingJob::numberText(std::int64_t number) const {
  const std::string word = drive::textOf(change_.object->words, number);
  return std::to_string(number) + (word.empty() ? "" : " (" + word + ")");
}

std::string BusSettingJob::consequence() const {
  std::string text;
  switch (change_.setting->counts) {
    case BusSetting::Counts::at_once:
      text = "which counts at once: the drive is lost here by it";
      break;
    case BusSetting::Counts::after_reset:
      text = "which counts from its next reset on";
      break;
    case BusSetting::Counts::after_power_cycle:
      text = "which counts once its power was off";
      break;
  }
  if (change_.settings->saved_apart) {
    text += ", and stays only after save_parameters";
  }
  return text + "; then change " + change_.file + ", and start the driver anew";
}

bool BusSettingJob::fail(const std::string& why) {
  give(reply_, answerOf(false, notSet(*axis_, why)));
  return true;
}

bool BusSettingJob::finish() {
  give(reply_,
       answerOf(true, drive::whoIs(axis_->config()) + ": " + change_.what + ": " +
                          change_.object->name + " (" + fieldbus::toString(change_.object->id) +
                          ") was " + numberText(old_) + " and " +
                          (doubtful_ ? "should be " : "is ") + numberText(change_.number) +
                          (doubtful_ ? " (no answer came to the write), " : ", ") + consequence()));
  return true;
}

}  // namespace cia402::bus
