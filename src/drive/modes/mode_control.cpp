// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/mode_control.h"

#include <array>

#include "drive/modes/cyclic_position.h"
#include "drive/modes/homing_control.h"
#include "drive/modes/position_by_set_points.h"
#include "drive/modes/position_by_velocity.h"
#include "drive/modes/profile_position.h"
#include "drive/modes/torque_control.h"
#include "drive/modes/velocity_control.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

using Made = std::unique_ptr<ModeControl>;

template <class Control>
Made make(const ModeChannel& channel, const ModeControl::Context& context) {
  return std::make_unique<Control>(channel, context);
}

/// In a mode that is not cyclic the drive plans the way to a position by itself.
Made makePosition(const ModeChannel& channel, const ModeControl::Context& context) {
  if (channel.spec->position_loop) return make<PositionByVelocity>(channel, context);
  if (channel.spec->set_point_stream) return make<PositionBySetPoints>(channel, context);
  return channel.spec->cyclic ? make<CyclicPosition>(channel, context)
                              : make<ProfilePosition>(channel, context);
}

struct Kind {
  const char* word;
  Quantity target;
  SetPointKind cyclic, planned;  ///< set-points of modes that are cyclic, and that are not
  Made (*make)(const ModeChannel& channel, const ModeControl::Context& context);
};

/// In the order of ControlKind.
constexpr std::array<Kind, 4> kKinds = {{
    {"position", Quantity::position, SetPointKind::stream, SetPointKind::goal, makePosition},
    {"velocity", Quantity::velocity, SetPointKind::velocity, SetPointKind::velocity,
     make<VelocityControl>},
    {"torque", Quantity::torque, SetPointKind::torque, SetPointKind::torque, make<TorqueControl>},
    {"homing", Quantity::none, SetPointKind::none, SetPointKind::none, make<HomingControl>},
}};

}  // namespace

ModeControl::ModeControl(const ModeChannel& channel, const Context& context)
    : channel_(&channel),
      context_(context),
      kind_(kindOf(*channel.spec)),
      hands_over_(kind_ == SetPointKind::goal),
      conversion_(channel.conversion),
      offsets_(channel, context.axis) {
  if (offsets_.any()) handOverEachCycle();
}

std::string ModeControl::targetText() const {
  const ObjectSpec* target = channel_->target.spec;
  if (target == nullptr) return "the mode, which has no target";
  return target->name + " (" + fieldbus::toString(target->id) + "), which takes " +
         number(conversion_.lowest()) + " to " + number(conversion_.highest());
}

bool ModeControl::late(Time /*now*/) {
  sent().interrupt();
  return false;
}

bool ModeControl::leadsInside(double value) const {
  if (!state().homed) return true;
  const double before = sent().value(), position = state().position;
  return !(limits().lower && position <= *limits().lower && value < 0.0 && !(value > before)) &&
         !(limits().upper && position >= *limits().upper && value > 0.0 && !(value < before));
}

SetPointKind kindOf(const ModeSpec& mode) {
  const Kind& kind = kKinds[static_cast<std::size_t>(mode.kind)];
  return mode.cyclic ? kind.cyclic : kind.planned;
}

std::vector<std::string> controlKindWords() {
  std::vector<std::string> words;
  for (const Kind& kind : kKinds) words.emplace_back(kind.word);
  return words;
}

Quantity targetQuantity(ControlKind kind) { return kKinds[static_cast<std::size_t>(kind)].target; }

std::unique_ptr<ModeControl> makeModeControl(const ModeChannel& channel,
                                             const ModeControl::Context& context) {
  return kKinds[static_cast<std::size_t>(channel.spec->kind)].make(channel, context);
}

}  // namespace cia402::drive
