// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_homing.h"

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace cia402::sim {
namespace {

const std::vector<std::pair<const char*, HomingEvent>> kEvents = {
    {"negative on", HomingEvent::negative_on},
    {"negative off", HomingEvent::negative_off},
    {"positive on", HomingEvent::positive_on},
    {"positive off", HomingEvent::positive_off},
    {"home on", HomingEvent::home_on},
    {"home off", HomingEvent::home_off},
    {"index", HomingEvent::index},
    {"stop", HomingEvent::hard_stop}};
constexpr const char* kLegs =
    "must be legs like `+fast home on, -slow home off, -slow index`, each until `negative on`, "
    "`negative off`, `positive on`, `positive off`, `home on`, `home off`, `index` or `stop`";
constexpr const char* kBegunOn = "begun_on";

std::optional<HomingLeg> readLeg(const std::string& text) {
  std::istringstream words(text);
  std::string motion, event, more;
  words >> motion >> event;
  while (words >> more) event += " " + more;
  HomingLeg leg;
  if (motion != "+fast" && motion != "-fast" && motion != "+slow" && motion != "-slow") {
    return std::nullopt;
  }
  leg.direction = motion.front() == '+' ? 1 : -1;
  leg.slow = motion.substr(1) == "slow";
  const auto known = std::find_if(kEvents.begin(), kEvents.end(),
                                  [&](const auto& pair) { return event == pair.first; });
  if (known == kEvents.end()) return std::nullopt;
  leg.until = known->second;
  return leg;
}

std::optional<HomingLegs> readLegs(DefinitionReader& reader, const char* key) {
  if (!reader.has(key)) return std::nullopt;
  std::string text, part;
  reader.read(key, text);
  HomingLegs legs;
  std::istringstream parts(text);
  while (std::getline(parts, part, ',')) {
    if (const auto leg = readLeg(part)) {
      legs.push_back(*leg);
    } else {
      reader.problem(key, kLegs);
    }
  }
  return legs;
}

/// Where home is the place itself, there are no legs.
std::optional<HomingLegs> readBegunOn(DefinitionReader& reader) {
  if (!reader.has(kBegunOn)) return std::nullopt;
  std::string text;
  reader.read(kBegunOn, text);
  return text == "here" ? HomingLegs{} : readLegs(reader, kBegunOn);
}

HomingRoute readRoute(const yaml::Value& value) {
  DefinitionReader reader(value);
  HomingRoute route;
  if (const auto legs = readLegs(reader, "legs")) {
    route.legs = *legs;
  } else {
    reader.problem("legs", "is missing");
  }
  route.begun_on = readBegunOn(reader);
  route.from_limit = readLegs(reader, "from_limit");
  route.nearer = readLegs(reader, "nearer");
  if (route.nearer && (route.nearer->empty() || route.legs.empty())) {
    reader.problem("nearer", "needs legs, as `legs` does");
  }
  reader.list("fails_at", [&](const yaml::Value& item) {
    const auto limit = item.oneOf({"negative", "positive"});
    if (limit) (*limit == 0 ? route.negative_fails : route.positive_fails) = true;
  });
  reader.read("passes_limits", route.passes_limits);
  return route;
}

void readTerminals(DefinitionReader& reader, DriveHomingDefinition& out) {
  const std::pair<const char*, HomingInput> kSwitches[] = {
      {"negative_limit", HomingInput::negative_limit},
      {"positive_limit", HomingInput::positive_limit},
      {"home_switch", HomingInput::home_switch}};
  for (const auto& [key, input] : kSwitches) {
    std::int64_t function = 0;
    if (!reader.has(key)) continue;
    reader.read(key, function, 0, 65535);
    out.terminal_functions[input] = function;
  }
}

void readNumbers(DefinitionReader& reader, const char* key, std::vector<std::int64_t>& out) {
  if (!reader.has(key)) return;
  out.clear();
  reader.list(key, [&](const yaml::Value& item) {
    if (const auto number = item.integer(-128, 127)) out.push_back(*number);
  });
}

}  // namespace

void readHoming(DefinitionReader& reader, DriveHomingDefinition& out) {
  reader.read<bool>("home_offset", out.home_offset_is_zero_shift,
                    {{"position_at_home", false}, {"shift_of_zero", true}});
  reader.read("returns_to_home", out.returns);
  reader.read("stops_quickly_at_limits", out.stops_quickly_at_limits);
  reader.read("stops_by_torque", out.stops_by_torque);
  reader.read("stop_torque_bounds", out.stop_torque_bounds);
  reader.read("offset_counts_at_once", out.offset_counts_at_once);
  reader.section("terminals", [&](DefinitionReader& r) { readTerminals(r, out); });
  reader.each("routes", [&](const std::string& number, const yaml::Value& value) {
    const auto method = yaml::parseInteger(number);
    if (!method) return reader.problem("routes", "'" + number + "' is no number of a method");
    out.routes[*method] = readRoute(value);
  });
  readNumbers(reader, "inert", out.inert);
  readNumbers(reader, "methods", out.methods);
  for (const std::int64_t method : out.methods) {
    if (out.route(method) != nullptr) continue;
    reader.problem("methods",
                   "must be a list of methods 1..14, 17..30, 33, 34, 35, 37, and those "
                   "under routes");
  }
}

}  // namespace cia402::sim
