// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Digital outputs and inputs, and touch probes.
#include "config/profile/parts.h"
#include "drive/profile/object_value.h"

namespace cia402::config {
namespace {

using ObjectReader = const ObjectSpec* (*)(const yaml::Value&, const DriveProfile&);

/// As readSetting(), of an object whose bits can be changed one by one.
const ObjectSpec* readChangeable(const yaml::Value& value, const DriveProfile& profile) {
  const ObjectSpec* object = readSetting(value, profile);
  if (object == nullptr || object->writable) return object;
  value.problem("`" + object->name + "` cannot be written");
  return nullptr;
}

/// `object` and `bit`.
std::optional<drive::ObjectBit> readObjectBit(yaml::Section& section, const DriveProfile& profile,
                                              ObjectReader read) {
  const auto name = section.require("object", "an object of the profile, by name");
  const auto bit = section.require("bit", "0 is its lowest");
  const ObjectSpec* object = name ? read(*name, profile) : nullptr;
  if (object == nullptr || !bit) return {};
  const auto number = bit->integer(0, fieldbus::sizeBits(object->type) - 1);
  if (!number) return {};
  return drive::ObjectBit{object->name, static_cast<unsigned>(*number)};
}

void readDigitalOutput(const std::string& name, const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  drive::DigitalOutput output;
  const auto bit = readObjectBit(section, profile, readChangeable);
  bool usable = bit.has_value();
  if (bit) output.value = *bit;
  if (const auto mask = section.get("mask")) {
    yaml::Section mask_section(*mask);
    output.mask = readObjectBit(mask_section, profile, readChangeable);
    mask_section.finish();
    usable = usable && output.mask;
  }
  if (const auto terminal = section.get("terminal")) {
    yaml::Section of_terminal(*terminal);
    const auto object = of_terminal.require("object", "what says what the terminal shows");
    const ObjectSpec* spec = object ? readSetting(*object, profile) : nullptr;
    of_terminal.require("is", "the number that it must be");
    of_terminal.readInteger("is", output.function, 0, 0xFFFFFFFF);
    of_terminal.finish();
    usable = usable && spec != nullptr;
    if (spec != nullptr) output.terminal = spec->name;
  }
  section.finish();
  if (usable) profile.outputs[name] = output;
}

/// The object that a touch probe stores a position in.
std::string readProbePosition(const yaml::Value& value, const DriveProfile& profile) {
  const auto text = value.text();
  const ObjectSpec* object = text ? profile.find(*text) : nullptr;
  if (object != nullptr && object->readable && object->quantity == Quantity::position) {
    return object->name;
  }
  if (text && object == nullptr) {
    value.problem("the profile has no object `" + *text + "`" +
                  yaml::suggestion(*text, drive::objectNames(profile)));
  } else if (text) {
    value.problem("`" + *text + "` is no position that the drive lets be read; see its `quantity`");
  }
  return {};
}

std::string readProbeCounter(const yaml::Value& value, const DriveProfile& profile) {
  const ObjectSpec* object = readSetting(value, profile);
  return object != nullptr ? object->name : std::string();
}

using ProbeReader = std::string (*)(const yaml::Value&, const DriveProfile&);
using ProbeField = std::string drive::TouchProbes::Edge::*;

/// {1: {rising: ..., falling: ...}, 2: ...}
void readProbeObjects(const yaml::Value& value, const DriveProfile& profile,
                      drive::TouchProbes& probes, ProbeField field, ProbeReader read) {
  yaml::Section section(value);
  for (unsigned number = 1; number <= drive::TouchProbes::kMost; ++number) {
    const auto entry = section.get(std::to_string(number));
    if (!entry) continue;
    yaml::Section edges(*entry);
    drive::TouchProbes::Probe& probe = probes.probes[number - 1];
    if (const auto rising = edges.get("rising")) probe.rising.*field = read(*rising, profile);
    if (const auto falling = edges.get("falling")) probe.falling.*field = read(*falling, profile);
    edges.finish();
  }
  section.finish();
}

/// The bits of both probes are in one word.
std::string readProbeWord(const std::optional<yaml::Value>& value, const DriveProfile& profile,
                          ObjectReader read) {
  const ObjectSpec* object = value ? read(*value, profile) : nullptr;
  if (object == nullptr) return {};
  if (fieldbus::sizeBits(object->type) >= 16) return object->name;
  value->problem("`" + object->name + "` has less than the 16 bits of CiA 402-2");
  return {};
}

}  // namespace

std::optional<drive::ObjectBit> readOutputBit(const yaml::Value& value,
                                              const DriveProfile& profile) {
  yaml::Section section(value);
  const auto bit = readObjectBit(section, profile, readChangeable);
  section.finish();
  return bit;
}

void readDigitalOutputs(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [name, entry] : section.entries()) readDigitalOutput(name, entry, profile);
  section.finish();
}

void readDigitalInputs(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [name, entry] : section.entries()) {
    yaml::Section input(entry);
    const auto bit = readObjectBit(input, profile, readSetting);
    bool active_low = false;
    input.read("active_low", active_low);
    input.finish();
    if (bit) profile.inputs[name] = {*bit, active_low};
  }
  section.finish();
}

void readTouchProbes(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  drive::TouchProbes probes;
  probes.function = readProbeWord(section.require("function", "the object that arms (60B8h)"),
                                  profile, readChangeable);
  probes.status =
      readProbeWord(section.require("status", "what tells of edges (60B9h)"), profile, readSetting);
  using Edge = drive::TouchProbes::Edge;
  if (const auto positions = section.require("positions", "{1: {rising: NAME, falling: NAME}}")) {
    readProbeObjects(*positions, profile, probes, &Edge::position, readProbePosition);
  }
  if (const auto counters = section.get("counters")) {
    readProbeObjects(*counters, profile, probes, &Edge::counter, readProbeCounter);
  }
  section.finish();
  if (!probes.function.empty() && !probes.status.empty()) profile.touch_probes = probes;
}

}  // namespace cia402::config
