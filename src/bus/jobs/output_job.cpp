// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/output_job.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "bus/axis_cycle.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

using drive::DigitalOutput;
using drive::DriveProfile;

std::string knownOutputs(const DriveProfile& profile) {
  std::string names;
  for (const auto& [name, output] : profile.outputs) append(names, name, ", ");
  return names.empty() ? "profile " + profile.name + " names no digital outputs"
                       : "there are " + names;
}

void addTo(std::vector<OutputGroup>& groups, const DriveProfile& profile,
           const DigitalOutput& output, bool on) {
  const drive::ObjectSpec* value = profile.find(output.value.object);
  const drive::ObjectSpec* mask = output.mask ? profile.find(output.mask->object) : nullptr;
  auto group = std::find_if(groups.begin(), groups.end(), [&](const OutputGroup& other) {
    return other.value == value && other.mask == mask;
  });
  if (group == groups.end()) group = groups.insert(groups.end(), {value, mask, 0, 0, 0});
  group->changed |= output.value.mask();
  if (on) group->bits |= output.value.mask();
  if (output.mask) group->opened |= output.mask->mask();
}

std::vector<OutputTerminal> terminalsOf(const DriveProfile& profile,
                                        const std::vector<std::string>& names) {
  std::vector<OutputTerminal> terminals;
  for (const std::string& name : names) {
    const DigitalOutput& output = profile.outputs.at(name);
    if (output.terminal.empty()) continue;
    terminals.push_back({name, profile.find(output.terminal), output.function});
  }
  return terminals;
}

std::string outputsText(const SetOutputsCommand& command) {
  std::string text;
  for (std::size_t i = 0; i < command.names.size(); ++i) {
    append(text, command.names[i] + (command.values[i] ? " on" : " off"), ", ");
  }
  return text;
}

std::string outputsNotSet(const drive::Axis& axis, const std::string& why) {
  return drive::whoIs(axis.config()) + ": outputs not set: " + why;
}

}  // namespace

Result<std::vector<OutputGroup>> outputGroups(drive::Axis& axis, const SetOutputsCommand& command) {
  const DriveProfile& profile = *axis.config().profile;
  const std::vector<std::string>& names = command.names;
  const std::vector<bool>& values = command.values;
  if (names.size() != values.size()) {
    return Error{std::to_string(names.size()) + " names and " + std::to_string(values.size()) +
                 " values were given; give a value for each name"};
  }
  if (names.empty()) return Error{"no output was named; " + knownOutputs(profile)};
  std::vector<OutputGroup> groups;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto output = profile.outputs.find(names[i]);
    if (output == profile.outputs.end()) {
      return Error{"there is no output \"" + names[i] + "\"; " + knownOutputs(profile)};
    }
    if (std::count(names.begin(), names.end(), names[i]) > 1) {
      return Error{"\"" + names[i] + "\" was named twice"};
    }
    addTo(groups, profile, output->second, values[i]);
  }
  for (const OutputGroup& group : groups) {
    std::string why = bitsRefusal(axis, *group.value);
    if (why.empty() && group.mask != nullptr) why = bitsRefusal(axis, *group.mask);
    if (!why.empty()) return Error{why};
  }
  return groups;
}

void SetOutputsCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time) const {
  const auto unit = cycle.findToAsk(axis, "its digital outputs");
  if (!unit) return refuse(reply, unit.error().message);
  drive::Axis& asked = (*unit)->axis;
  auto groups = outputGroups(asked, *this);
  if (!groups) return refuse(reply, outputsNotSet(asked, groups.error().message));
  auto job = std::make_unique<OutputJob>(asked, cycle.claims(), std::move(groups).value(),
                                         outputsText(*this), reply);
  job->lookAt(terminalsOf(*asked.config().profile, names));
  cycle.jobs().add(std::move(job));
}

OutputJob::OutputJob(drive::Axis& axis, ObjectClaims& claims, std::vector<OutputGroup> groups,
                     std::string text, Reply<> reply)
    : Job(Turn::object, Ends::at_once),
      axis_(&axis),
      claims_(&claims),
      groups_(std::move(groups)),
      text_(std::move(text)),
      reply_(std::move(reply)) {}

bool OutputJob::step(Time) {
  if (claim_ == nullptr) {
    claim_ = claims_->take({&axis_->device(), {}, 0});
    if (claim_ == nullptr) return false;
    if (terminals_.empty()) return beginGroup();
  }
  if (terminal_ < terminals_.size()) return lookAtTerminal();
  if (!change_->step()) return false;
  if (!change_->problem().empty()) return fail(change_->problem());
  const OutputGroup& group = groups_[group_];
  switch (stage_) {
    case Stage::looking: {
      const bool open = (change_->found() & group.opened) == group.opened;
      begin(open ? Stage::setting : Stage::preparing);
      return false;
    }
    case Stage::preparing:
      begin(Stage::opening);
      return false;
    case Stage::opening:
      begin(Stage::setting);
      return false;
    case Stage::setting:
      break;
  }
  ++group_;
  return beginGroup();
}

bool OutputJob::lookAtTerminal() {
  const OutputTerminal& terminal = terminals_[terminal_];
  if (!ticket_) {
    ticket_ = axis_->device().objects().upload(terminal.object->id, terminal.object->name);
    return false;
  }
  if (!ticket_->done()) return false;
  const std::string why = terminalRefusal(terminal);
  ticket_.reset();
  if (!why.empty()) return fail(why);
  return ++terminal_ == terminals_.size() && beginGroup();
}

std::string OutputJob::terminalRefusal(const OutputTerminal& terminal) const {
  if (!ticket_->ok()) return ticket_->message();
  const auto shown = static_cast<std::int64_t>(fieldbus::toUnsigned(ticket_->data()));
  if (shown == terminal.function) return {};
  const std::string word = drive::textOf(terminal.object->words, shown);
  return "the terminal of " + terminal.output + " shows something else: " + terminal.object->name +
         " (" + fieldbus::toString(terminal.object->id) + ") is " + std::to_string(shown) +
         (word.empty() ? "" : " (" + word + ")") + ", not " + std::to_string(terminal.function);
}

bool OutputJob::beginGroup() {
  if (group_ < groups_.size()) {
    begin(groups_[group_].mask != nullptr ? Stage::looking : Stage::setting);
    return false;
  }
  give(reply_, answerOf(true, drive::whoIs(axis_->config()) + ": " + text_));
  return true;
}

void OutputJob::begin(Stage stage) {
  const OutputGroup& group = groups_[group_];
  stage_ = stage;
  switch (stage) {
    case Stage::looking:
      change_.emplace(*axis_, *group.mask, 0, 0);
      break;
    case Stage::opening:
      change_.emplace(*axis_, *group.mask, group.opened, group.opened);
      break;
    case Stage::preparing:
    case Stage::setting:
      change_.emplace(*axis_, *group.value, group.changed, group.bits);
      break;
  }
}

bool OutputJob::fail(const std::string& why) {
  const bool partly = group_ > 0 || stage_ == Stage::opening;
  give(reply_, answerOf(false, outputsNotSet(*axis_, why) +
                                   (partly ? "; some of them may be: read_object tells" : "")));
  return true;
}

}  // namespace cia402::bus
