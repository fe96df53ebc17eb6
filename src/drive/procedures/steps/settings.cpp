// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/settings.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/text.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

constexpr double kSameCounts = 1e-6;  // relative: what a reduced fraction of 32 bits may be off

std::string named(const ObjectSpec& object) {
  return object.name + " (" + fieldbus::toString(object.id) + ")";
}

std::int64_t numberOf(const ObjectSpec& object, const fieldbus::Bytes& bytes) {
  const std::uint64_t raw = fieldbus::toUnsigned(bytes);
  const auto bits = static_cast<unsigned>(8 * std::min<std::size_t>(bytes.size(), 8));
  return fieldbus::isSigned(object.type) ? fieldbus::toSigned(raw, bits)
                                         : static_cast<std::int64_t>(raw);
}

/// Does the expectation count for the modes that the axis uses?
bool concerns(const Expectation& expectation, const AxisConfig& axis) {
  const auto& modes = expectation.modes;
  return modes.empty() || std::any_of(modes.begin(), modes.end(), [&](const std::string& mode) {
           return std::find(axis.modes.begin(), axis.modes.end(), mode) != axis.modes.end();
         });
}

}  // namespace

void SettingsStep::add(const AxisConfig& axis, const std::string& object) {
  const ObjectSpec* spec = profile_->find(object);
  if (spec == nullptr || saidToLack(axis, object)) return;
  const auto known = std::find_if(settings_.begin(), settings_.end(),
                                  [&](const Setting& s) { return s.object == spec; });
  if (known == settings_.end()) settings_.push_back({spec, {}});
}

void SettingsStep::plan(const AxisConfig& axis) {
  planned_ = true;
  for (const Expectation& expectation : profile_->expected) {
    if (concerns(expectation, axis)) add(axis, expectation.object);
  }
  for (const std::string& object : profile_->counts_rule.times) add(axis, object);
  for (const std::string& object : profile_->counts_rule.over) add(axis, object);
  if (!profile_->timing.brake_object.empty()) add(axis, profile_->timing.brake_object);
}

Outcome SettingsStep::advance(const Context& context) {
  AxisCore& axis = context.axis;
  if (!planned_) {
    plan(axis.config());
    if (!settings_.empty()) context.show("comparing settings", "the drive to tell them");
  }
  std::string problem;
  while (next_ < settings_.size()) {
    if (!ticket_) {
      const ObjectSpec& object = *settings_[next_].object;
      ticket_ = axis.device().objects().upload(object.id, object.name);
    }
    if (!ticket_->done()) return Outcome::running();
    if (!take(context, problem)) return Outcome::failed(problem);
  }
  for (const std::string& difference :
       {compare(axis.config()), compareCounts(axis.config()), learnBrake(axis)}) {
    if (!difference.empty()) append(problem, difference);
  }
  if (problem.empty()) return Outcome::done();
  return Outcome::failed(axis.who() + ": is not enabled: " + problem);
}

/// The brake's time alone has a number to fall back on.
bool SettingsStep::take(const Context& context, std::string& problem) {
  Setting& setting = settings_[next_++];
  const fieldbus::Ticket answer = std::exchange(ticket_, nullptr);
  if (answer->ok()) {
    setting.number = numberOf(*setting.object, answer->data());
  } else if (setting.object->name != profile_->timing.brake_object) {
    problem = context.axis.who() +
              ": is not enabled, as it is not known how it is set: " + answer->message() +
              "; `lacks: [" + setting.object->name + "]` of axes/" + context.axis.config().name +
              " says that the drive does not have the object";
    return false;
  }
  return true;
}

std::optional<std::int64_t> SettingsStep::find(const std::string& object) const {
  const auto found = std::find_if(settings_.begin(), settings_.end(), [&](const Setting& setting) {
    return setting.object->name == object;
  });
  return found == settings_.end() ? std::nullopt : found->number;
}

std::string SettingsStep::compare(const AxisConfig& axis) const {
  std::string problems;
  for (const Expectation& expected : profile_->expected) {
    if (!concerns(expected, axis)) continue;
    const auto number = find(expected.object);
    if (!number || *number == expected.raw) continue;
    append(problems, named(*profile_->find(expected.object)) + " is " + std::to_string(*number) +
                         " instead of " + std::to_string(expected.raw) + ", " + expected.text +
                         "; " + expected.remedy);
  }
  return problems;
}

std::string SettingsStep::compareCounts(const AxisConfig& axis) const {
  const CountsRule& rule = profile_->counts_rule;
  double counts = 1.0;
  std::string told;
  const auto multiply = [&](const std::vector<std::string>& objects, bool divides) {
    for (const std::string& object : objects) {
      const auto number = find(object);
      if (!number) return false;
      counts *= divides ? 1.0 / static_cast<double>(*number) : static_cast<double>(*number);
      append(told, named(*profile_->find(object)) + " = " + std::to_string(*number), ", ");
    }
    return true;
  };
  if (rule.times.empty() || !multiply(rule.times, false) || !multiply(rule.over, true)) return {};
  const double configured = axis.geometry.counts_per_turn;
  if (std::fabs(counts - configured) <= kSameCounts * configured) return {};
  return "the drive counts " + numberText(counts, 9) + " a turn of its motor (" + told +
         "), but counts_per_turn of axes/" + axis.name + " is " + numberText(configured, 9) +
         "; correct it, or set the drive by `write` of the axis";
}

std::string SettingsStep::learnBrake(AxisCore& axis) const {
  const DriveProfile::Timing& timing = profile_->timing;
  const auto number = find(timing.brake_object);
  axis.control().setBrakeRelease(timing.brake_release);
  if (!number) return {};
  const ObjectSpec& object = *profile_->find(timing.brake_object);
  const auto conversion = Conversion::create(object, *profile_, axis.config().geometry);
  if (!conversion) return conversion.error().message;
  const Duration told = fromSeconds(conversion->toJoint(static_cast<std::uint64_t>(*number)));
  if (told > timing.brake_release) {
    return named(object) + " is " + seconds(told) + ", longer than the " +
           seconds(timing.brake_release) + " that the profile allows for (brake_release)";
  }
  axis.control().setBrakeRelease(told);
  return {};
}

}  // namespace cia402::drive
