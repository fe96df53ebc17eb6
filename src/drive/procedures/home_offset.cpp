// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/home_offset.h"

#include <algorithm>
#include <cmath>

#include "drive/axis/core.h"
#include "drive/profile/named_write.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// What a home that is found may be behind, in this time: until the drive brakes.
constexpr double kBrakesAfter = 0.1;  // s

/// The axis has written itself what the drive is to make of home and of its offset.
bool meansItsOwn(const AxisCore& axis) {
  const DriveProfile& profile = axis.profile();
  const auto& writes = axis.config().writes;
  return std::any_of(writes.begin(), writes.end(), [&](const NamedWrite& write) {
    const ObjectSpec* object = findObject(profile, write.object);
    return object != nullptr && !(object->id == profile.own({0x607C, 0})) &&
           profile.coordinateMark(object->id) == CoordinateMark::home;
  });
}

}  // namespace

/// Where the axis stands after it found home, read from the drive, tells the sign of its home
/// offset, if that is larger than the way on which it came to rest.
std::string offsetProblem(const AxisCore& axis, bool written, bool moves) {
  const HomingOptions& options = *axis.config().homing;
  const ObjectSpec* object = axis.profile().find(axis.profile().own({0x607C, 0}));
  const bool known = options.acceleration > 0.0 && options.search_velocity > 0.0;
  if (!written || object == nullptr || (moves && !known) || meansItsOwn(axis)) return {};
  const Conversion& position = axis.objects().signals[SignalId::position].conversion;
  std::uint64_t raw = 0;
  if (!position.toDevice(options.atHome(), raw)) return {};
  const double mirrored =
      position.toJoint(negated(raw, axis.objects().signals[SignalId::position].spec->type));
  const double speed = std::max(options.search_velocity, options.zero_velocity);
  const double way =
      moves ? speed * speed / (2.0 * options.acceleration) + speed * kBrakesAfter : 0.0;
  const double at = axis.state().position;
  const double off = std::fabs(at - options.atHome());
  if (!std::isfinite(at) || off <= way || std::fabs(at - mirrored) >= off) return {};
  return "home was found, but " + axis.profile().address(0x6064) + " reads " +
         length(at, axis.config().geometry.prismatic()) + " there instead of " +
         length(options.atHome(), axis.config().geometry.prismatic()) + ": the drive takes " +
         fieldbus::toString(object->id) + " home offset with the other sign; set " +
         "homing/offset_means of axes/" + axis.config().name + " to " +
         (options.offset_shifts_zero ? "position_at_home" : "shift_of_zero");
}

}  // namespace cia402::drive
