// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/settings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "common/text.h"
#include "drive/procedures/steps/setting_parts.h"
#include "drive/profile/named_write.h"
#include "drive/profile/object_value.h"
#include "drive/sentence.h"
#include "fieldbus/abort_code.h"

namespace cia402::drive {
namespace {

constexpr double kSameTorque = 0.01;  // relative: what rounding of a name plate may be off
constexpr double kSameCounts = 1e-6;  // relative: what a reduced fraction of 32 bits may be off

}  // namespace

/// Where it stands in settings_; their number if it does not.
std::size_t SettingsStep::indexOf(const std::string& object) const {
  const auto found = std::find_if(settings_.begin(), settings_.end(), [&](const Setting& setting) {
    return setting.object->name == object;
  });
  return static_cast<std::size_t>(found - settings_.begin());
}

std::optional<std::int64_t> SettingsStep::numberOf(const std::string& object) const {
  const std::size_t index = indexOf(object);
  return index < settings_.size() ? settings_[index].number : std::nullopt;
}

void SettingsStep::add(const AxisConfig& axis, const std::string& object, bool needed) {
  const ObjectSpec* spec = profile_->find(object);
  if (spec == nullptr || saidToLack(axis, object)) return;
  if (indexOf(spec->name) == settings_.size()) settings_.push_back({spec, {}, needed});
}

void SettingsStep::plan(const AxisConfig& axis) {
  planned_ = true;
  for (const SettingCheck& check : profile_->checks) {
    if (check.before != before_ || !concerns(check, axis)) continue;
    checks_.push_back(&check);
    for (const std::string& object : check.objects) add(axis, object);
    if (!check.unless.empty()) add(axis, check.unless);
  }
  if (enabling()) {
    for (const std::string& object : profile_->counts_rule.times) add(axis, object);
    for (const std::string& object : profile_->counts_rule.over) add(axis, object);
    for (const auto* name : profile_->timing.told()) add(axis, *name);
    if (axis.geometry.rated_torque > 0.0) add(axis, profile_->rated_torque);
    for (const std::string& object : profile_->may_be_cut) {
      if (lastWrite(axis, object)) add(axis, object, false);
    }
  }
  for (std::size_t i = 0; i < settings_.size(); ++i) reads_.push_back(i);
}

Outcome SettingsStep::advance(const Context& context) {
  if (!planned_) {
    plan(context.axis.config());
    if (!settings_.empty()) context.show("comparing settings", "the drive to tell them");
  }
  const Outcome transferred = transfer(context);
  if (!transferred.isDone()) return transferred;
  if (writes_.empty() && planWrites(context.axis)) {
    context.show("adjusting settings", "the drive to take them");
    return transfer(context);
  }
  return judge(context);
}

/// Writes, then reads, what is planned.
Outcome SettingsStep::transfer(const Context& context) {
  while (settled(context) && (ticket_ || ask(context))) {
    if (!ticket_->done()) return Outcome::running();
    const fieldbus::Ticket answer = std::exchange(ticket_, nullptr);
    const std::string problem = take(context, *answer);
    if (!problem.empty()) return Outcome::failed(problem);
  }
  return settles_ ? Outcome::running() : Outcome::done();
}

/// @return false: nothing is left
bool SettingsStep::ask(const Context& context) {
  fieldbus::ObjectAccess& objects = context.axis.device().objects();
  if (written_ < writes_.size()) {
    const SettingCheck& check = *writes_[written_];
    const ObjectSpec& object = *profile_->find(check.objects.front());
    const auto number = static_cast<std::uint64_t>(check.condition.numbers.front());
    ticket_ = objects.download(object.id, wireBytes(number, object.type), object.name);
  } else if (read_ < reads_.size()) {
    const ObjectSpec& object = *settings_[reads_[read_]].object;
    ticket_ = objects.upload(object.id, object.name);
  }
  return ticket_ != nullptr;
}

/// @return what went wrong; the brake's time alone has a number to fall back on
std::string SettingsStep::take(const Context& context, const fieldbus::Transfer& answer) {
  if (answer.failure() == fieldbus::Transfer::Failure::cancelled) return {};  // asked again
  if (answer.direction() == fieldbus::Transfer::Direction::download) {
    ++written_;
    if (!answer.ok()) return refusal(context) + answer.message();
    if (profile_->coordinateMark(answer.object()) != CoordinateMark::none) losePosition(context);
    return {};
  }
  Setting& setting = settings_[reads_[read_++]];
  if (answer.ok() && !answer.data().empty()) {
    setting.number = wholeNumber(setting.object->type, answer.data());
    return {};
  }
  if (!setting.needed || setting.object->name == profile_->timing.brake_object) return {};
  if (mayBeAbsent(answer)) {
    append(absent_, settingTitle(*setting.object), ", ");
    return {};
  }
  const std::string why = answer.ok()
                              ? settingTitle(*setting.object) + ": the drive answers nothing"
                              : answer.message();
  return refusal(context) + "it is not known how the drive is set: " + why + "; `lacks: [" +
         setting.object->name + "]` of axes/" + context.axis.config().name +
         " says that the drive does not have the object";
}

bool SettingsStep::mayBeAbsent(const fieldbus::Transfer& answer) const {
  return profile_->absent_settings_pass &&
         answer.failure() == fieldbus::Transfer::Failure::aborted_by_server &&
         fieldbus::abort_code::saysLacking(answer.abortCode());
}

/// What was written may have given the drive another zero, or another idea of its motor.
void SettingsStep::losePosition(const Context& context) {
  context.axis.loseZero();
  context.axis.basis().neighbours.loseZero();
  settles_ = context.now + kZeroSettles;
}

/// What is measured counts in the new coordinates then.
bool SettingsStep::settled(const Context& context) {
  if (!settles_) return true;
  if (context.now < *settles_) return false;
  settles_.reset();
  context.axis.measureAnew();
  context.axis.basis().neighbours.measureAnew();
  return true;
}

std::optional<SettingsStep::Difference> SettingsStep::compare(const SettingCheck& check) const {
  const auto excuse = check.unless.empty() ? std::nullopt : numberOf(check.unless);
  if (excuse && check.unless_is.holds(*excuse)) return {};
  if (check.each_once) return compareAmongThem(check);
  std::string told;
  const std::string* meaning = &check.text;
  for (const std::string& name : check.objects) {
    const auto number = numberOf(name);
    if (!number || check.condition.holds(*number)) return {};  // or `lacks` names it
    append(told, settingTitle(*profile_->find(name)) + " is " + check.condition.complaint(*number),
           " and ");
    meaning = &check.meaning(*number);
  }
  return Difference{&check, told + ", " + *meaning + "; " + check.remedy};
}

/// Two objects with one number, where each shall have its own.
std::optional<SettingsStep::Difference> SettingsStep::compareAmongThem(
    const SettingCheck& check) const {
  std::map<std::int64_t, const std::string*> seen;
  for (const std::string& name : check.objects) {
    const auto number = numberOf(name);
    if (!number || check.condition.holds(*number)) continue;
    const auto [first, fresh] = seen.emplace(*number, &name);
    if (fresh) continue;
    return Difference{&check, settingTitle(*profile_->find(*first->second)) + " and " +
                                  settingTitle(*profile_->find(name)) + " are both " +
                                  std::to_string(*number) + ", " + check.meaning(*number) + "; " +
                                  check.remedy};
  }
  return {};
}

std::vector<SettingsStep::Difference> SettingsStep::differences() const {
  std::vector<Difference> all;
  for (const SettingCheck* check : checks_) {
    if (auto difference = compare(*check)) all.push_back(std::move(*difference));
  }
  return all;
}

bool SettingsStep::mayWrite(AxisCore& axis, const SettingCheck& check) const {
  const std::string& object = check.objects.front();
  const bool asked =
      check.write == SettingCheck::Write::asked && contains(axis.config().adjust, object);
  if (!asked && check.write != SettingCheck::Write::always) return false;
  const bool shifts = profile_->coordinateMark(profile_->find(object)->id) != CoordinateMark::none;
  return !shifts || axis.basis().neighbours.refusal().empty();  // which might be enabled
}

/// What differs and may be written; it is read again afterwards. @return whether there is any
bool SettingsStep::planWrites(AxisCore& axis) {
  reads_.clear();
  read_ = written_ = 0;
  for (const Difference& difference : differences()) {
    if (!mayWrite(axis, *difference.check)) continue;
    writes_.push_back(difference.check);
    reads_.push_back(indexOf(difference.check->objects.front()));
  }
  planCounts(axis);
  return !writes_.empty();
}

/// The counts of a turn that the axis has, as a reduced fraction of those of the encoder.
void SettingsStep::planCounts(AxisCore& axis) {
  const CountsRule& rule = profile_->counts_rule;
  const bool asked =
      enabling() && rule.adjustable && contains(axis.config().adjust, std::string("counts_rule"));
  if (!asked || compareCounts(axis.config()).empty() || !axis.basis().neighbours.refusal().empty())
    return;
  const double counts = axis.config().geometry.counts_per_turn;
  const auto encoder = numberOf(rule.times[0]);
  const auto wanted = static_cast<std::int64_t>(std::llround(counts));
  if (!encoder || *encoder <= 0 || std::fabs(counts - static_cast<double>(wanted)) > kSameCounts)
    return;
  const std::int64_t divisor = std::gcd(*encoder, wanted);
  const auto set = [&](SettingCheck& check, const std::string& object, std::int64_t number) {
    check.objects = {object};
    check.condition.numbers = {number / divisor};
    writes_.push_back(&check);
    reads_.push_back(indexOf(object));
  };
  set(counts_[0], rule.over[0], *encoder);
  set(counts_[1], rule.times[1], wanted);
}

/// Until its power is off, what was written must be in its memory.
std::string SettingsStep::keptBy(AxisCore& axis, const SettingCheck& check) const {
  if (profile_->parameters.recipes.memory.object.empty()) return "; switch it off and on";
  axis.basis().written.insert(profile_->find(check.objects.front())->id);
  return "; call save_parameters, for it is not kept otherwise, then switch it off and on";
}

Outcome SettingsStep::judge(const Context& context) {
  AxisCore& axis = context.axis;
  std::string problem;
  std::vector<std::string> warnings;
  if (!absent_.empty()) {
    warnings.push_back("the drive does not have " + absent_ +
                       ", and is taken to be as it shall be there; see that it is");
  }
  if (const std::string torque = compareTorque(axis.config()); !torque.empty()) {
    warnings.push_back(torque);
  }
  for (const Difference& difference : differences()) {
    if (difference.check->only_warns) {
      warnings.push_back(difference.text);
    } else if (contains(writes_, difference.check)) {
      append(problem, difference.text + " (the drive was told so just now, and keeps its own)");
    } else {
      append(problem, difference.text);
    }
  }
  // One a cycle: of several the last alone would be told. An answer may come within one.
  if (warned_at_ && context.now < *warned_at_ + axis.config().cycle) return Outcome::running();
  if (warned_ < warnings.size()) {
    axis.notices().warnOnce(axis.who() + ": " + warnings[warned_++]);
    warned_at_ = context.now;
    return Outcome::running();
  }
  for (const SettingCheck* check : writes_) {
    if (!check->power_cycle || compare(*check)) continue;
    const std::string why = settingTitle(*profile_->find(check->objects.front())) + " was set to " +
                            std::to_string(check->condition.numbers.front()) +
                            ", which counts once its power was off";
    axis.control().wantPowerCycle(why);
    axis.basis().neighbours.wantPowerCycle(why);
    append(problem, why + keptBy(axis, *check));
  }
  if (enabling()) {
    compareReadBack(axis);
    for (const std::string& text : {compareCounts(axis.config()), learnTimes(axis)}) {
      if (!text.empty()) append(problem, text);
    }
  }
  return problem.empty() ? Outcome::done() : Outcome::failed(refusal(context) + problem);
}

/// What the boot has written and the drive does not hold as it was written: it may have cut it to
/// what it can do.
void SettingsStep::compareReadBack(AxisCore& axis) const {
  for (const std::string& name : profile_->may_be_cut) {
    const ObjectSpec& object = *profile_->find(name);
    const auto number = numberOf(name);
    const auto written = number ? lastWrite(axis.config(), name) : std::nullopt;
    if (!written) continue;
    const std::int64_t wanted = wholeNumber(object.type, wireBytes(written->raw, written->type));
    if (*number == wanted) continue;
    axis.notices().warnOnce(axis.who() + ": " + settingTitle(object) + " is " +
                            std::to_string(*number) + " instead of the " + std::to_string(wanted) +
                            " that was written at the boot, and counts as it is: the drive has cut "
                            "it to what it can do, or something else has written it since");
  }
}

std::string SettingsStep::refusal(const Context& context) const {
  return context.axis.who() + (enabling() ? ": is not enabled: " : ": does not search its home: ");
}

std::string SettingsStep::compareCounts(const AxisConfig& axis) const {
  const CountsRule& rule = profile_->counts_rule;
  double counts = 1.0;
  std::string told;
  const auto multiply = [&](const std::vector<std::string>& objects, bool divides) {
    for (const std::string& object : objects) {
      const auto number = numberOf(object);
      if (!number) return false;
      counts *= divides ? 1.0 / static_cast<double>(*number) : static_cast<double>(*number);
      append(told, settingTitle(*profile_->find(object)) + " = " + std::to_string(*number), ", ");
    }
    return true;
  };
  if (rule.times.empty() || !multiply(rule.times, false) || !multiply(rule.over, true)) return {};
  const double configured = axis.geometry.counts_per_turn;
  if (std::fabs(counts - configured) <= kSameCounts * configured) return {};
  return "the drive counts " + numberText(counts, 9) + " a turn of its motor (" + told +
         "), but counts_per_turn of axes/" + axis.name + " is " + numberText(configured, 9) +
         "; correct it, or set the drive by " +
         (rule.adjustable ? "`adjust: [counts_rule]`" : "`write`") + " of the axis";
}

std::string SettingsStep::compareTorque(const AxisConfig& axis) const {
  const auto number = numberOf(profile_->rated_torque);
  if (!number) return {};
  const ObjectSpec& object = *profile_->find(profile_->rated_torque);
  const double told = static_cast<double>(*number) / object.factor;
  const double configured = axis.geometry.rated_torque;
  if (std::fabs(told - configured) <= kSameTorque * configured) return {};
  return "the motor's rated torque is " + numberText(told, 4) + " N m by the drive (" +
         settingTitle(object) + " = " + std::to_string(*number) + "), but rated_torque of axes/" +
         axis.name + " is " + numberText(configured, 4) +
         ": efforts are told and limited wrong by that much; correct it";
}

std::string SettingsStep::learnTime(const AxisConfig& axis, const std::string& name,
                                    Duration& time) const {
  const auto number = numberOf(name);
  if (!number) return {};
  const ObjectSpec& object = *profile_->find(name);
  const auto conversion = Conversion::create(object, *profile_, axis.geometry);
  if (!conversion) return conversion.error().message;
  const Duration told = fromSeconds(conversion->toJoint(static_cast<std::uint64_t>(*number)));
  if (told > time) {
    return settingTitle(object) + " is " + seconds(told) + ", longer than the " + seconds(time) +
           " that the profile allows for (timing)";
  }
  if (told >= Duration(0)) time = told;
  return {};
}

std::string SettingsStep::learnTimes(AxisCore& axis) const {
  const DriveProfile::Timing& timing = profile_->timing;
  Duration brake = timing.brake_release, power = timing.power_off;
  std::string problem = learnTime(axis.config(), timing.brake_object, brake);
  if (problem.empty()) problem = learnTime(axis.config(), timing.power_object, power);
  axis.control().setBrakeRelease(brake);
  axis.control().setPowerOffTime(power);
  return problem;
}

}  // namespace cia402::drive
