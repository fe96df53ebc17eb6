// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "config/profile/parts.h"

namespace cia402::config {
namespace {

using Base = UnitSpec::Base;

struct BaseName {
  const char* name;
  Base base;
};
constexpr BaseName kBases[] = {
    {"count", Base::count},
    {"turn", Base::turn},
    {"rad", Base::radian},
    {"deg", Base::degree},
    {"N.m", Base::newton_metre},
    {"per_mille_of_rated", Base::per_mille_of_rated},
    {"A", Base::ampere},
    {"V", Base::volt},
    {"degC", Base::celsius},
    {"s", Base::second},
    {"1", Base::one},
};

struct QuantityName {
  const char* name;
  Quantity quantity;
  int per_seconds;          // power of 1/s that its unit must have
  std::vector<Base> bases;  // what it may be counted in
};

const std::vector<QuantityName>& quantities() {
  static const std::vector<Base> kAngles = {Base::count, Base::turn, Base::radian, Base::degree};
  static const std::vector<QuantityName> kQuantities = {
      {"none", Quantity::none, 0, {Base::one}},
      {"position", Quantity::position, 0, kAngles},
      {"distance", Quantity::distance, 0, kAngles},
      {"velocity", Quantity::velocity, 1, kAngles},
      {"acceleration", Quantity::acceleration, 2, kAngles},
      {"jerk", Quantity::jerk, 3, kAngles},
      {"torque", Quantity::torque, 0, {Base::per_mille_of_rated, Base::newton_metre}},
      {"current", Quantity::current, 0, {Base::ampere}},
      {"voltage", Quantity::voltage, 0, {Base::volt}},
      {"temperature", Quantity::temperature, 0, {Base::celsius}},
      {"time", Quantity::time, 0, {Base::second}},
  };
  return kQuantities;
}

const QuantityName& describe(Quantity quantity) {
  return *std::find_if(quantities().begin(), quantities().end(),
                       [&](const QuantityName& entry) { return entry.quantity == quantity; });
}

std::string example(const QuantityName& quantity) {
  for (const BaseName& entry : kBases) {
    if (entry.base != quantity.bases.front()) continue;
    const char* const powers[] = {"", "/s", "/s^2", "/s^3"};
    return std::string(entry.name) + powers[quantity.per_seconds];
  }
  return "";
}

// "/s", "/s^2", "/min" behind the base; false if a part is none of these.
bool readPer(const std::string& part, UnitSpec& unit) {
  if (part == "s" || part == "s^1") {
    unit.per_seconds += 1;
  } else if (part == "s2" || part == "s^2") {
    unit.per_seconds += 2;
  } else if (part == "s3" || part == "s^3") {
    unit.per_seconds += 3;
  } else if (part == "min" && !unit.per_minute) {
    unit.per_minute = true;
    unit.per_seconds += 1;
  } else {
    return false;
  }
  return true;
}

std::optional<UnitSpec> parseUnit(const std::string& text) {
  std::istringstream parts(text);
  std::string part;
  std::getline(parts, part, '/');
  const auto base = std::find_if(std::begin(kBases), std::end(kBases),
                                 [&](const BaseName& entry) { return part == entry.name; });
  if (base == std::end(kBases)) return {};
  UnitSpec unit;
  unit.base = base->base;
  while (std::getline(parts, part, '/')) {
    if (!readPer(part, unit)) return {};
  }
  return unit;
}

/// Anything but a unit of that quantity is a problem.
std::optional<UnitSpec> unitOf(const yaml::Value& value, const std::string& text,
                               Quantity quantity) {
  if (text.empty()) return {};
  const QuantityName& wanted = describe(quantity);
  auto unit = parseUnit(text);
  if (unit && unit->per_seconds == wanted.per_seconds &&
      std::find(wanted.bases.begin(), wanted.bases.end(), unit->base) != wanted.bases.end()) {
    return unit;
  }
  value.problem("`" + text + "` is no unit of " + wanted.name + "; write for example `" +
                example(wanted) + "`");
  return {};
}

/// An acceleration as the time to a speed: {unit: s, to: 1000, of: turn/min}.
std::optional<UnitSpec> timeToSpeed(yaml::Section& section, const std::string& text,
                                    Quantity quantity) {
  const auto of = section.require("of", "the unit of the speed that `to` counts");
  double to = 0.0;
  section.read("to", to, yaml::kPositive);
  if (quantity != Quantity::acceleration || text != "s") {
    section.get("to")->problem(
        "is of accelerations that are times: write `quantity: acceleration` "
        "and `unit: s`, or leave it out");
    return {};
  }
  auto unit = of ? unitOf(*of, of->text().value_or(""), Quantity::velocity) : std::nullopt;
  if (unit) unit->to = to;
  return unit && to > 0.0 ? unit : std::nullopt;
}

/// Units by quantity.
Units readUnitMap(yaml::Section& section) {
  Units units;
  for (const QuantityName& entry : quantities()) {
    if (entry.quantity == Quantity::none || entry.quantity == Quantity::distance) continue;
    const auto value = section.get(entry.name);
    const auto unit = value ? readUnit(*value, entry.quantity) : std::nullopt;
    if (unit) units[entry.quantity] = *unit;
  }
  section.finish();
  return units;
}

}  // namespace

std::optional<Quantity> readQuantity(const yaml::Value& value) {
  std::vector<std::string> names;
  for (const QuantityName& entry : quantities()) names.emplace_back(entry.name);
  const auto index = value.oneOf(names);
  if (!index) return {};
  return quantities()[*index].quantity;
}

std::optional<UnitSpec> readUnit(const yaml::Value& value, Quantity quantity) {
  if (!value.isMap()) return unitOf(value, value.text().value_or(""), quantity);
  std::string text;
  double scale = 1.0;
  yaml::Section section(value);
  if (section.require("unit", "write for example `unit: " + example(describe(quantity)) + "`")) {
    section.read("unit", text);
  }
  section.read("scale", scale, yaml::kPositive);
  auto unit =
      section.has("to") ? timeToSpeed(section, text, quantity) : unitOf(value, text, quantity);
  section.finish();
  if (unit) unit->scale = scale;
  return unit;
}

void readUnits(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  profile.units = readUnitMap(section);
}

void readUnitSystems(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  drive::UnitSystems& systems = profile.unit_systems;
  const auto name = section.require("object", "the setting that says which units count, by name");
  const ObjectSpec* object = name ? readSetting(*name, profile) : nullptr;
  if (object == nullptr) return;
  systems.object = object->name;
  const bool checked =
      std::any_of(profile.checks.begin(), profile.checks.end(), [&](const auto& check) {
        return !check.objects.empty() && check.objects.front() == object->name;
      });
  if (!checked) name->problem("`checks` must compare it with what `units` are for");
  for (const auto& [key, units] : section.entries()) {
    if (key == "object") continue;
    const auto number = yaml::parseInteger(key);
    if (!number) {
      units.problem("a unit system is a number that `" + object->name + "` may hold");
      continue;
    }
    yaml::Section of_system(units);
    Units& all = systems.others[*number] = readUnitMap(of_system);
    all.insert(profile.units.begin(), profile.units.end());
  }
  section.finish();
}

}  // namespace cia402::config
