// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `checks`: what a drive must be set to, or say, before an axis is enabled or searches its home.
#include <algorithm>

#include "config/profile/parts.h"

namespace cia402::config {
namespace {

using drive::Condition;
using drive::SettingCheck;

std::int64_t lowestOfAll(const std::vector<const ObjectSpec*>& objects) {
  std::int64_t lowest = lowestOf(DataType::int64);
  for (const ObjectSpec* object : objects) lowest = std::max(lowest, lowestOf(object->type));
  return lowest;
}

std::int64_t highestOfAll(const std::vector<const ObjectSpec*>& objects) {
  std::int64_t highest = highestOf(DataType::int64);
  for (const ObjectSpec* object : objects) highest = std::min(highest, highestOf(object->type));
  return highest;
}

/// A number or a list of numbers that all of the objects can hold.
std::vector<std::int64_t> readNumbers(const yaml::Value& value,
                                      const std::vector<const ObjectSpec*>& objects) {
  std::vector<std::int64_t> numbers;
  const auto add = [&](const yaml::Value& entry) {
    if (const auto number = entry.integer(lowestOfAll(objects), highestOfAll(objects))) {
      numbers.push_back(*number);
    }
  };
  if (!value.isList()) {
    add(value);
    return numbers;
  }
  for (const yaml::Value& entry : value.list()) add(entry);
  return numbers;
}

struct Key {
  const char* name;
  Condition::Kind kind;
};
constexpr Key kConditions[] = {{"is", Condition::Kind::is},
                               {"not", Condition::Kind::is_not},
                               {"above", Condition::Kind::above},
                               {"below", Condition::Kind::below}};

/// `bits`: which of the number are looked at.
void readBits(yaml::Section& section, const std::vector<const ObjectSpec*>& objects,
              Condition& condition) {
  const auto value = section.get("bits");
  const auto bits = value ? value->integer(1, highestOfAll(objects)) : std::nullopt;
  if (!bits) return;
  condition.bits = *bits;
  const bool above_or_below =
      condition.kind == Condition::Kind::above || condition.kind == Condition::Kind::below;
  if (above_or_below) value->problem("go with `is` and `not`");
  for (const std::int64_t number : condition.numbers) {
    if ((number & ~*bits) == 0) continue;
    value->problem(std::to_string(number) + " has other bits, so that it never is");
  }
}

/// Exactly one of `is`, `not`, `above`, `below`.
Condition readCondition(yaml::Section& section, const yaml::Value& place,
                        const std::vector<const ObjectSpec*>& objects) {
  Condition condition;
  int given = 0;
  for (const Key& key : kConditions) {
    const auto value = section.get(key.name);
    if (!value) continue;
    ++given;
    condition.kind = key.kind;
    const bool one = key.kind == Condition::Kind::above || key.kind == Condition::Kind::below;
    if (one && value->isList()) value->problem("expected one number");
    condition.numbers = readNumbers(*value, objects);
    if (value->isList() && value->list().empty()) value->problem("expected at least one number");
  }
  bool by_axis = false;
  section.read("given", by_axis);
  if (by_axis) {
    condition.kind = Condition::Kind::given;
    ++given;
  }
  if (given != 1)
    place.problem(
        "needs one of `is`, `not`, `above`, `below`, which says what it must be, or `given`");
  if (condition.numbers.empty()) condition.numbers.push_back(0);  // a problem has been told
  readBits(section, objects, condition);
  return condition;
}

/// Of `each_once`: the numbers that may stand in several objects.
Condition readExceptions(yaml::Section& section, const std::vector<const ObjectSpec*>& objects) {
  Condition condition;
  if (const auto value = section.get("but")) condition.numbers = readNumbers(*value, objects);
  return condition;
}

std::vector<const ObjectSpec*> readCheckedObjects(yaml::Section& section, const yaml::Value& place,
                                                  const DriveProfile& profile) {
  std::vector<const ObjectSpec*> objects;
  const auto one = section.get("object");
  const auto once = section.get("each_once");
  const auto several = once ? once : section.get("any_of");
  if (one.has_value() == several.has_value()) {
    place.problem(
        "needs `object`, a setting of the drive by name, or a list of these, `any_of` or "
        "`each_once`");
  }
  if (one) objects.push_back(readSetting(*one, profile));
  if (several) {
    for (const yaml::Value& entry : several->list()) objects.push_back(readSetting(entry, profile));
  }
  objects.erase(std::remove(objects.begin(), objects.end(), nullptr), objects.end());
  return objects;
}

void readUnless(const yaml::Value& value, const DriveProfile& profile, SettingCheck& check) {
  yaml::Section section(value);
  const auto name = section.require("object", "a setting of the drive, by name");
  const ObjectSpec* object = name ? readSetting(*name, profile) : nullptr;
  std::vector<const ObjectSpec*> objects;
  if (object != nullptr) {
    objects.push_back(object);
    check.unless = object->name;
  }
  check.unless_is = readCondition(section, value, objects);
  section.finish();
}

/// What may be written: one number.
void readWriting(yaml::Section& section, const std::vector<const ObjectSpec*>& objects,
                 SettingCheck& check) {
  section.read("power_cycle", check.power_cycle);
  section.read("locks", check.locks);
  const auto value = section.get("write");
  if (!value) return;
  const auto word = value->oneOf({"never", "asked", "always"});
  if (!word) return;
  check.write = static_cast<SettingCheck::Write>(*word);
  if (check.write == SettingCheck::Write::never || objects.empty()) return;
  const ObjectSpec& object = *objects.front();
  if (check.before == SettingCheck::Before::homing) {
    value->problem("what is compared before homing is not written; use homing/writes");
  } else if (check.condition.kind != Condition::Kind::is || objects.size() != 1 ||
             check.each_once) {
    value->problem("what is written must be given by `is`, of one `object`");
  } else if (check.condition.bits != -1) {
    value->problem("single bits (`bits`) are not written");
  } else if (!object.writable) {
    value->problem("`" + object.name + "` cannot be written");
  }
}

void readTexts(yaml::Section& section, SettingCheck& check) {
  const auto texts = section.get("texts");
  if (section.require("text", "what another number means")) section.read("text", check.text);
  if (section.require("remedy", "what to do then")) section.read("remedy", check.remedy);
  if (!texts) return;
  check.texts = readNumberTexts(*texts);
}

void readMoment(yaml::Section& section, const DriveProfile& profile, SettingCheck& check) {
  if (const auto before = section.get("before")) {
    if (before->oneOf({"enabling", "homing"}) == 1U) check.before = SettingCheck::Before::homing;
  }
  if (const auto modes = section.get("modes")) check.modes = readModeNames(*modes, profile);
  if (const auto methods = section.get("methods")) {
    for (const yaml::Value& entry : methods->list()) {
      const auto method = entry.integer(-128, 127);
      if (!method) continue;
      if (profile.homing.methods.count(static_cast<int>(*method)) == 0) {
        entry.problem("the profile has no homing method " + std::to_string(*method));
      }
      check.methods.push_back(static_cast<int>(*method));
    }
  }
  if (const auto given = section.get("if_given")) {
    const auto& sources = configurationSources();
    if (const auto index = given->oneOf(sources)) check.if_given = sources[*index];
  }
}

}  // namespace

void readChecks(const yaml::Value& list, DriveProfile& profile) {
  for (const yaml::Value& entry : list.list()) {
    yaml::Section section(entry);
    SettingCheck check;
    const auto objects = readCheckedObjects(section, entry, profile);
    for (const ObjectSpec* object : objects) check.objects.push_back(object->name);
    check.each_once = section.has("each_once");
    check.condition =
        check.each_once ? readExceptions(section, objects) : readCondition(section, entry, objects);
    readMoment(section, profile, check);
    if (const auto unless = section.get("unless")) readUnless(*unless, profile, check);
    if (const auto otherwise = section.get("else")) {
      check.only_warns = otherwise->oneOf({"refuse", "warn"}) == 1U;
    }
    readWriting(section, objects, check);
    readTexts(section, check);
    section.finish();
    if (!check.objects.empty()) profile.checks.push_back(check);
  }
}

}  // namespace cia402::config
