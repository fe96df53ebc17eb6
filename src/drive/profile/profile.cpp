// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/profile.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/text.h"
#include "fieldbus/emergency.h"
#include "fieldbus/object_dictionary.h"

namespace cia402::drive {

Encoding encodingAt(const DriveProfile& profile, ObjectId id, DataType type) {
  if (type == DataType::real32) return Encoding::float32;
  const Encoding* encoding = profile.encodings.find(id);
  if (encoding == nullptr || *encoding == Encoding::integer) return Encoding::integer;
  const unsigned bits = *encoding == Encoding::float32 ? 32 : 16;
  return fieldbus::sizeBits(type) == bits ? *encoding : Encoding::integer;
}

const ObjectSpec* DriveProfile::find(const std::string& object_name) const {
  const auto found = std::find_if(objects.begin(), objects.end(),
                                  [&](const ObjectSpec& o) { return o.name == object_name; });
  if (found != objects.end()) return &*found;
  if (eds.empty()) return nullptr;
  const std::string key = fieldbus::nameKey(object_name);
  const auto by_key = std::find_if(objects.begin(), objects.end(), [&](const ObjectSpec& o) {
    return std::find(o.eds_keys.begin(), o.eds_keys.end(), key) != o.eds_keys.end();
  });
  return by_key == objects.end() ? nullptr : &*by_key;
}

const ObjectSpec* DriveProfile::find(ObjectId id) const {
  const auto found = std::find_if(objects.begin(), objects.end(),
                                  [&](const ObjectSpec& object) { return object.id == id; });
  return found == objects.end() ? nullptr : &*found;
}

std::string DriveProfile::feedbackObjects() const {
  return "statusword (" + address(0x6041) + ") and position (" + address(0x6064) + ")";
}

Encoding DriveProfile::encodingOf(ObjectId id, DataType type) const {
  if (const ObjectSpec* object = find(id)) return object->encoding;
  return encodingAt(*this, id, type);
}

std::optional<ObjectSpec> DriveProfile::unnamedFloat(ObjectId id, std::size_t bytes) const {
  ObjectSpec object;
  object.id = id;
  object.type = bytes == 2 ? DataType::uint16 : DataType::uint32;
  object.encoding = encodingAt(*this, id, object.type);
  if (fieldbus::sizeBits(object.type) != 8 * bytes) return {};
  if (object.encoding == Encoding::integer) return {};
  return object;
}

const ModeChange::Detour* ModeChange::detour(const std::string& from, const std::string& to) const {
  const auto found = std::find_if(detours.begin(), detours.end(), [&](const Detour& candidate) {
    return candidate.from == from && candidate.to == to;
  });
  return found == detours.end() ? nullptr : &*found;
}

bool movesByStandard(int method) {
  constexpr std::array<int, 2> kOnPresentPosition = {35, 37};
  return std::find(kOnPresentPosition.begin(), kOnPresentPosition.end(), method) ==
         kOnPresentPosition.end();
}

Duration DriveProfile::Timing::transition(int number) const {
  const auto own = transitions.find(number);
  return own != transitions.end() ? own->second : state_change;
}

Duration DriveProfile::Timing::disabling(const Disabling& by) const {
  Duration longest{0};
  for (const int number : by.transitions()) longest = std::max(longest, transition(number));
  return longest;
}

Duration DriveProfile::Timing::disablingInTurn(const Disabling& by) const {
  Duration time{0};
  for (const int number : by.transitions()) time += transition(number);
  return time;
}

CoordinateMark DriveProfile::coordinateMark(ObjectId id) const {
  const CoordinateMark* mark = coordinates.find(id);
  return mark != nullptr ? *mark : standardMark(id);
}

const ModeSpec* DriveProfile::mode(const std::string& mode_name) const {
  const std::string canonical = canonicalModeName(mode_name);
  const auto found = std::find_if(modes.begin(), modes.end(),
                                  [&](const ModeSpec& m) { return m.name == canonical; });
  return found == modes.end() ? nullptr : &*found;
}

std::string activeInputs(const DriveProfile& profile, const ObjectSpec& object, std::uint64_t raw) {
  std::string text;
  for (const auto& [name, input] : profile.inputs) {
    const bool active = ((raw & input.value.mask()) != 0) != input.active_low;
    if (input.value.object == object.name && active) append(text, name, ", ");
  }
  return text;
}

const ObjectSpec* findObject(const DriveProfile& profile, const std::string& name) {
  if (const ObjectSpec* object = profile.find(name)) return object;
  const auto id = objectId(profile, name);
  return id ? profile.find(*id) : nullptr;
}

std::optional<ObjectId> objectId(const DriveProfile& profile, const std::string& text) {
  const auto id = fieldbus::parseObjectAddress(text);
  return id ? id : profile.parameter_names.find(text);
}

std::optional<ObjectId> addressOf(const DriveProfile& profile, const std::string& name) {
  if (const ObjectSpec* object = profile.find(name)) return object->id;
  return objectId(profile, name);
}

std::string sourceOf(const DriveProfile& profile) {
  return "profile " + profile.name + (profile.eds.empty() ? "" : " with " + profile.eds);
}

std::vector<std::string> objectNames(const DriveProfile& profile) {
  std::vector<std::string> names;
  for (const ObjectSpec& object : profile.objects) names.push_back(object.name);
  return names;
}

ErrorText::Missing missingByCode(const DriveProfile& profile, std::uint16_t code) {
  const auto known = profile.errors.find(code);
  const bool told =
      known != profile.errors.end() && known->second.missing != ErrorText::Missing::nothing;
  if (told) return known->second.missing;
  return code == fieldbus::kOutputsLate ? ErrorText::Missing::outputs : ErrorText::Missing::nothing;
}

StopBy stopBy(const ModeSpec& mode, const DriveProfile& profile) {
  if (mode.stop) return *mode.stop;
  if (profile.halt_supported && !mode.cyclic) return StopBy::halt;
  return mode.kind == ControlKind::torque ? StopBy::quick_stop : StopBy::set_points;
}

std::string canonicalModeName(const std::string& name) {
  static constexpr std::pair<const char*, const char*> kShortForms[] = {
      {"pp", "profile_position"}, {"vl", "velocity"},         {"pv", "profile_velocity"},
      {"pt", "profile_torque"},   {"hm", "homing"},           {"ip", "interpolated_position"},
      {"csp", "cyclic_position"}, {"csv", "cyclic_velocity"}, {"cst", "cyclic_torque"},
  };
  for (const auto& [short_form, canonical] : kShortForms) {
    if (name == short_form) return canonical;
  }
  return name;
}

}  // namespace cia402::drive
