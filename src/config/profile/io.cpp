// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Digital outputs and inputs, and touch probes.
#include "config/profile/parts.h"
#include "drive/profile/object_value.h"

namespace cia402::config {
namespace {

/// What the driver does with an object of these.
enum class IoUse : std::uint8_t { read, changed };

/// The object of the profile that `value` names, if it is a whole number for that use; else a
/// problem.
const ObjectSpec* readIoObject(const yaml::Value& value, const DriveProfile& profile, IoUse use) {
  const auto text = value.text();
  if (!text) return nullptr;
  const ObjectSpec* object = profile.find(*text);
  if (object == nullptr) {
    value.problem("the profile has no object `" + *text + "`" +
                  yaml::suggestion(*text, drive::objectNames(profile)));
    return nullptr;
  }
  const bool whole =
      fieldbus::sizeBits(object->type) != 0 && !drive::holdsFloat(object->type, object->encoding);
  if (use == IoUse::changed && !(whole && object->readable && object->writable)) {
    value.problem("`" + *text +
                  "` is no whole number that the drive lets be read and written: its other bits "
                  "could not be kept");
    return nullptr;
  }
  if (whole && object->readable) return object;
  value.problem("`" + *text + "` is no whole number that the drive lets be read");
  return nullptr;
}

/// `object` and `bit`.
std::optional<drive::ObjectBit> readObjectBit(yaml::Section& section, const DriveProfile& profile,
                                              IoUse use) {
  const auto name = section.require("object", "an object of the profile, by name");
  const auto bit = section.require("bit", "0 is its lowest");
  const ObjectSpec* object = name ? readIoObject(*name, profile, use) : nullptr;
  if (object == nullptr || !bit) return {};
  const auto number = bit->integer(0, fieldbus::sizeBits(object->type) - 1);
  if (!number) return {};
  return drive::ObjectBit{object->name, static_cast<unsigned>(*number)};
}

void readDigitalOutput(const std::string& name, const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  drive::DigitalOutput output;
  const auto bit = readObjectBit(section, profile, IoUse::changed);
  bool usable = bit.has_value();
  if (bit) output.value = *bit;
  if (const auto mask = section.get("mask")) {
    yaml::Section mask_section(*mask);
    output.mask = readObjectBit(mask_section, profile, IoUse::changed);
    mask_section.finish();
    usable = usable && output.mask;
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
  const ObjectSpec* object = readIoObject(value, profile, IoUse::read);
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
                          IoUse use) {
  const ObjectSpec* object = value ? readIoObject(*value, profile, use) : nullptr;
  if (object == nullptr) return {};
  if (fieldbus::sizeBits(object->type) >= 16) return object->name;
  value->problem("`" + object->name + "` has less than the 16 bits of CiA 402-2");
  return {};
}

}  // namespace

void readDigitalOutputs(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [name, entry] : section.entries()) readDigitalOutput(name, entry, profile);
  section.finish();
}

void readDigitalInputs(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [name, entry] : section.entries()) {
    yaml::Section input(entry);
    const auto bit = readObjectBit(input, profile, IoUse::read);
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
                                  profile, IoUse::changed);
  probes.status =
      readProbeWord(section.require("status", "what tells of edges (60B9h)"), profile, IoUse::read);
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
