// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_modes.h"

#include <algorithm>

#include "yaml/reader.h"

namespace cia402::sim {
namespace {

const std::vector<std::pair<const char*, ModeBehaviour>> kBehaviours = {
    {"hold", ModeBehaviour::hold},
    {"profile_position", ModeBehaviour::profile_position},
    {"velocity", ModeBehaviour::velocity},
    {"profile_velocity", ModeBehaviour::profile_velocity},
    {"profile_torque", ModeBehaviour::profile_torque},
    {"homing", ModeBehaviour::homing},
    {"interpolated_position", ModeBehaviour::interpolated_position},
    {"cyclic_position", ModeBehaviour::cyclic_position},
    {"cyclic_velocity", ModeBehaviour::cyclic_velocity},
    {"cyclic_torque", ModeBehaviour::cyclic_torque}};
const std::vector<std::pair<const char*, Bit12>> kBit12 = {
    {"none", Bit12::none},       {"acknowledge", Bit12::acknowledge},
    {"started", Bit12::started}, {"zero_speed", Bit12::zero_speed},
    {"follows", Bit12::follows}, {"homing_attained", Bit12::homing_attained},
    {"always", Bit12::always}};
const std::vector<std::pair<const char*, Bit13>> kBit13 = {
    {"none", Bit13::none},
    {"following_error", Bit13::following_error},
    {"homing_error", Bit13::homing_error}};
const std::vector<std::pair<const char*, StopsFade>> kStopsFade = {
    {"false", StopsFade::never}, {"ramps", StopsFade::ramps}, {"true", StopsFade::always}};
std::optional<Role> readRole(DefinitionReader& reader, const std::string& key) {
  if (!reader.has(key)) return std::nullopt;
  std::string text;
  reader.read(key, text);
  const auto role = findRole(text);
  if (!role) reader.problem(key, "'" + text + "' is no role of an object");
  return role;
}

// What the standard gives bits 12 and 13 in a mode, unless the file says otherwise.
void applyStandardBits(ModeDefinition& mode) {
  switch (mode.behaviour) {
    case ModeBehaviour::profile_position:
      mode.bit_12 = Bit12::acknowledge;
      mode.bit_13 = Bit13::following_error;
      mode.velocity = Role::profile_velocity;
      break;
    case ModeBehaviour::profile_velocity:
      mode.bit_12 = Bit12::zero_speed;
      break;
    case ModeBehaviour::cyclic_position:
      mode.target_reached = false;
      mode.bit_12 = Bit12::follows;
      mode.bit_13 = Bit13::following_error;
      break;
    case ModeBehaviour::interpolated_position:
    case ModeBehaviour::cyclic_velocity:
    case ModeBehaviour::cyclic_torque:
      mode.bit_12 = Bit12::follows;
      break;
    case ModeBehaviour::homing:
      mode.bit_12 = Bit12::homing_attained;
      mode.bit_13 = Bit13::homing_error;
      break;
    default:
      break;
  }
}

/// Bits 8 and 14, and those that wait for a start.
void readMakerBits(DefinitionReader& reader, MakerBits& out) {
  reader.read<bool>("bit_8", out.stopped, {{"none", false}, {"stopped", true}});
  reader.list("bit_14", [&](const yaml::Value& item) {
    const auto text = item.text();
    const auto role = text ? findRole(*text) : std::nullopt;
    if (role) out.not_0.push_back(*role);
    if (text && !role) item.problem("'" + *text + "' is no role of an object");
  });
  out.waits_for_start = reader.has("before_start");
  reader.list("before_start", [&](const yaml::Value& item) {
    const auto bit = item.integer(8, 15);
    if (bit) out.before_start = static_cast<std::uint16_t>(out.before_start | 1U << *bit);
  });
}

}  // namespace

void readMode(const std::string& number, const yaml::Value& from, DefinitionReader& parent,
              DriveDefinition& out) {
  DefinitionReader reader(from);
  ModeDefinition mode;
  const auto value = yaml::parseInteger(number);
  if (!value) parent.problem("modes", "'" + number + "' is no mode number");
  mode.number = value.value_or(0);
  if (!reader.has("behaviour")) reader.problem("behaviour", "is missing");
  reader.read("behaviour", mode.behaviour, kBehaviours);
  applyStandardBits(mode);
  reader.read("handshake", mode.handshake);
  reader.read("bit_12", mode.bit_12, kBit12);
  reader.read("bit_13", mode.bit_13, kBit13);
  reader.read("target_reached", mode.target_reached);
  if (reader.has("velocity") && reader.node("velocity").Scalar() == "none") {
    mode.velocity.reset();
  } else if (reader.has("velocity")) {
    mode.velocity = readRole(reader, "velocity");
  }
  mode.torque = readRole(reader, "torque");
  reader.read("delayed", mode.delayed);
  reader.read("stops_fade", mode.stops_fade, kStopsFade);
  reader.read("queue", mode.queue, 1, 64);
  reader.read("stop_empties_queue", mode.stop_empties_queue);
  reader.read("replaces_queue", mode.replaces_queue);
  std::int64_t bit = mode.set_point_bit;
  reader.read("set_point_bit", bit, 4, 5);
  mode.set_point_bit = static_cast<unsigned>(bit);
  readMakerBits(reader, mode.maker);
  const auto known = std::find_if(out.modes.begin(), out.modes.end(),
                                  [&](const auto& other) { return other.number == mode.number; });
  known == out.modes.end() ? out.modes.push_back(mode) : void(*known = mode);
}

}  // namespace cia402::sim
