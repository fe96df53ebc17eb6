// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/objects.h"

#include <stdexcept>

namespace cia402::drive {
namespace {

using fieldbus::ObjectId;

/// The fixed name of the profile format, or else the standard's own index.
const ObjectSpec* findObject(const DriveProfile& profile, const char* name, ObjectId id) {
  const ObjectSpec* spec = profile.find(name);
  return spec != nullptr ? spec : profile.find(profile.own(id));
}

OutputObject output(const fieldbus::Device& device, const ObjectSpec* spec) {
  OutputObject result;
  result.spec = spec;
  if (spec == nullptr) return result;
  result.slot = device.image().outputSlot(spec->id);
  return result;
}

bool sameCoding(const ObjectSpec& a, const ObjectSpec& b) {
  return a.type == b.type && a.encoding == b.encoding && a.quantity == b.quantity &&
         a.factor == b.factor && !a.unit && !b.unit;
}

/// @param used the axis sends something in it
ModeChannel::Offset offset(const AxisConfig& config, const fieldbus::Device& device,
                           const std::string& name, bool used) {
  const ObjectSpec* object = used && !name.empty() ? config.profile->find(name) : nullptr;
  if (object == nullptr) return {};
  const auto conversion = Conversion::create(*object, *config.profile, config.geometry);
  if (!conversion) return {};  // told when the configuration was checked
  return {output(device, object), *conversion};
}

ModeChannel modeChannel(const AxisConfig& config, const fieldbus::Device& device,
                        const ModeSpec& spec, const ObjectSpec* position) {
  ModeChannel channel;
  channel.spec = &spec;
  if (spec.target.empty()) return channel;
  const ObjectSpec* object = config.profile->find(spec.target);
  channel.target = output(device, object);
  if (object == nullptr) {
    channel.refusal = "the drive profile does not name its target object " + spec.target;
    return channel;
  }
  if (!channel.target.mapped()) {
    channel.refusal = "its target " + fieldbus::toString(object->id) + " " + object->name +
                      " is not mapped into an " + device.terms().output +
                      "; name the mode in `modes:` of the axis";
    return channel;
  }
  const auto conversion = Conversion::create(*object, *config.profile, config.geometry);
  if (conversion) {
    channel.conversion = *conversion;
  } else {
    channel.refusal = conversion.error().message;
  }
  const FeedForward& feed = config.feed_forward;
  channel.velocity_offset = offset(config, device, spec.offsets.velocity, feed.velocity != 0.0);
  channel.torque_offset = offset(config, device, spec.offsets.torque, feed.inertia != 0.0);
  if (spec.set_point_stream) {
    channel.set_point_speed = offset(config, device, spec.set_point_stream->speed, true);
    channel.set_point_deceleration =
        offset(config, device, spec.set_point_stream->deceleration, true);
    if (!channel.set_point_speed.output.mapped()) {
      channel.refusal = "the speed of its set-points, " + spec.set_point_stream->speed +
                        ", is not mapped into an " + device.terms().output +
                        ", or its unit is not known";
    }
  }
  channel.copies_position = position != nullptr && sameCoding(*object, *position);
  return channel;
}

}  // namespace

AxisObjects::AxisObjects(const AxisConfig& config, fieldbus::Device& device)
    : signals(config, device) {
  controlword = output(device, findObject(*config.profile, "controlword", {0x6040, 0}));
  mode = output(device, findObject(*config.profile, "mode_of_operation", {0x6060, 0}));
  if (!controlword.mapped()) {
    throw std::invalid_argument(whoIs(config) + ": the controlword (" +
                                config.profile->address(0x6040) + ") must be mapped into a " +
                                device.terms().cyclic);
  }

  modes.reserve(config.profile->modes.size());
  for (const ModeSpec& spec : config.profile->modes) {
    modes.push_back(modeChannel(config, device, spec, signals[SignalId::position].spec));
  }
  if (channel(config.mode) == nullptr) {
    throw std::invalid_argument(config.name + ": the drive profile " + config.profile->name +
                                " has no mode " + config.mode);
  }
}

const ModeChannel* AxisObjects::channel(const std::string& mode_name) const {
  for (const ModeChannel& channel : modes) {
    if (channel.spec->name == mode_name) return &channel;
  }
  return nullptr;
}

const ModeChannel* AxisObjects::channelOfValue(int mode_value) const {
  for (const ModeChannel& channel : modes) {
    if (channel.spec->value == mode_value) return &channel;
  }
  return nullptr;
}

const ModeChannel* AxisObjects::homingChannel() const {
  for (const ModeChannel& channel : modes) {
    if (channel.spec->kind == ControlKind::homing) return &channel;
  }
  return nullptr;
}

}  // namespace cia402::drive
