// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "config/profile/parts.h"
#include "config/robot_parts.h"
#include "config/tuned_mode.h"

namespace cia402::config {

using drive::AxisConfig;
using drive::ModeSpec;
using drive::SetPointStream;

namespace {

/// An object that goes with each set-point; nothing: a problem is told, or there is none.
std::string readCompanion(const std::optional<yaml::Value>& value, const char* kind,
                          Quantity quantity, const DriveProfile& profile) {
  const auto name = value ? value->text() : std::nullopt;
  if (!name) return {};
  const ObjectSpec* object = profile.find(*name);
  if (object != nullptr && object->rpdo && object->quantity == quantity) return *name;
  value->problem("`" + *name + "` is no object of the profile with `quantity: " + kind +
                 "` that an RPDO can carry");
  return {};
}

void readCompanions(yaml::Section& section, const DriveProfile& profile, SetPointStream& stream) {
  const auto speed = section.require("speed", "the object of the speed that goes with a set-point");
  stream.speed = readCompanion(speed, "velocity", Quantity::velocity, profile);
  stream.deceleration =
      readCompanion(section.get("deceleration"), "acceleration", Quantity::acceleration, profile);
}

}  // namespace

SetPointStream readSetPointStream(const yaml::Value& value, SetPointStream stream,
                                  const DriveProfile* profile) {
  yaml::Section section(value);
  if (profile != nullptr) readCompanions(section, *profile, stream);
  section.read("interval", stream.interval, yaml::Range{0.0, 1.0, false});
  section.read("catch_up", stream.catch_up, yaml::Range{0.0, SetPointStream::kLargestShare, false});
  section.finish();
  return stream;
}

void tuneSetPointStream(yaml::Section& section, AxisConfig& axis) {
  const auto value = section.get("set_point_stream");
  if (!axis.profile) return;
  const ModeSpec* const mode =
      tunedMode(axis, &ModeSpec::set_point_stream, value,
                "whose set-points lead the drive along a stream of positions");
  if (mode == nullptr) return;
  axis.set_point_stream =
      value ? readSetPointStream(*value, *mode->set_point_stream, nullptr) : mode->set_point_stream;
  const auto& outputs = axis.outputs;
  const bool sent =
      std::find(outputs.begin(), outputs.end(), axis.set_point_stream->speed) != outputs.end();
  if (!canBeIn(axis, *mode) || outputs.empty() || sent) return;
  value.value_or(section.value())
      .problem("mode `" + mode->name + "` needs `" + axis.set_point_stream->speed +
               "` in an RPDO; add it to `pdos`, or leave the mode out of `modes`");
}

}  // namespace cia402::config
