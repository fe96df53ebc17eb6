// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/homing_speed.h"

#include <cmath>
#include <utility>

#include "common/text.h"
#include "drive/profile/object_value.h"
#include "drive/sentence.h"
#include "fieldbus/bytes.h"

namespace cia402::drive {
namespace {

constexpr double kTolerance = 1e-3;  // of the limit: a number of the drive is rounded

bool isSpeed(const std::string& from) {
  return from == "homing.search_velocity" || from == "homing.zero_velocity";
}

}  // namespace

Outcome HomingSpeedStep::advance(const Context& context) {
  const AxisConfig& axis = context.axis.config();
  if (!std::exchange(planned_, true)) plan(axis);
  for (; next_ < speeds_.size(); ++next_) {
    const ObjectSpec& object = *speeds_[next_].object;
    if (!ticket_) {
      context.show("looking how fast the drive searches", "the drive to tell its " + object.name);
      ticket_ = context.axis.device().objects().upload(object.id, object.name);
    }
    if (!ticket_->done()) return Outcome::running();
    const fieldbus::Ticket answer = std::exchange(ticket_, nullptr);
    const std::string text = excess(axis, *answer);
    if (!text.empty()) return Outcome::failed(context.axis.who() + text);
  }
  return Outcome::done();
}

void HomingSpeedStep::plan(const AxisConfig& axis) {
  if (!axis.limits.velocity) return;
  for (const NamedWrite& write : axis.profile->startup) add(axis, write);
  for (const NamedWrite& write : axis.profile->homing.writes) add(axis, write);
}

void HomingSpeedStep::add(const AxisConfig& axis, const NamedWrite& write) {
  const ObjectSpec* object = findObject(*axis.profile, write.object);
  if (!isSpeed(write.from) || isGiven(write.from, axis)) return;
  if (object == nullptr || !object->readable) return;
  if (saidToLack(axis, write.object)) return;
  const auto conversion = Conversion::create(*object, *axis.profile, axis.geometry);
  if (conversion) speeds_.push_back({&write, object, *conversion});
}

std::string HomingSpeedStep::excess(const AxisConfig& axis,
                                    const fieldbus::Transfer& answer) const {
  const Speed& speed = speeds_[next_];
  const bool number = answer.ok() && !answer.data().empty() && answer.data().size() <= 8;
  if (!number) return {};
  const double own = std::fabs(speed.conversion.toJoint(fieldbus::toUnsigned(answer.data())));
  const double limit = *axis.limits.velocity;
  if (!(own > limit * (1 + kTolerance))) return {};
  const std::string unit = axis.geometry.prismatic() ? " m/s" : " rad/s";
  const std::string key = speed.write->from.substr(speed.write->from.find('.') + 1);
  return ": is not homed, as the drive would search with a " + speed.object->name + " (" +
         fieldbus::toString(speed.object->id) + ") of " + numberText(own) + unit +
         ", beyond the joint's limit " + numberText(limit) + unit + "; give `" + key +
         "` in `homing` of axes/" + axis.name;
}

}  // namespace cia402::drive
