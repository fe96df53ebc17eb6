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

}  // namespace

std::optional<Quantity> readQuantity(const yaml::Value& value) {
  std::vector<std::string> names;
  for (const QuantityName& entry : quantities()) names.emplace_back(entry.name);
  const auto index = value.oneOf(names);
  if (!index) return {};
  return quantities()[*index].quantity;
}

std::optional<UnitSpec> readUnit(const yaml::Value& value, Quantity quantity) {
  std::string text;
  double scale = 1.0;
  if (value.isMap()) {
    yaml::Section section(value);
    if (section.require("unit", "write for example `unit: " + example(describe(quantity)) + "`")) {
      section.read("unit", text);
    }
    section.read("scale", scale, yaml::kPositive);
    section.finish();
  } else {
    text = value.text().value_or("");
  }
  if (text.empty()) return {};
  const QuantityName& wanted = describe(quantity);
  auto unit = parseUnit(text);
  if (!unit || unit->per_seconds != wanted.per_seconds ||
      std::find(wanted.bases.begin(), wanted.bases.end(), unit->base) == wanted.bases.end()) {
    value.problem("`" + text + "` is no unit of " + wanted.name + "; write for example `" +
                  example(wanted) + "`");
    return {};
  }
  unit->scale = scale;
  return unit;
}

void readUnits(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const QuantityName& entry : quantities()) {
    if (entry.quantity == Quantity::none || entry.quantity == Quantity::distance) continue;
    const auto unit_value = section.get(entry.name);
    if (!unit_value) continue;
    if (const auto unit = readUnit(*unit_value, entry.quantity)) {
      profile.units[entry.quantity] = *unit;
    }
  }
  section.finish();
}

}  // namespace cia402::config
