// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/bit_change.h"

#include "drive/profile/outputs.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {
namespace {

std::string titleOf(const drive::ObjectSpec& object) {
  return fieldbus::toString(object.id) + " " + object.name;
}

fieldbus::Slot travellingIn(drive::Axis& axis, const drive::ObjectSpec& object) {
  const fieldbus::ProcessImage& image = axis.device().image();
  const fieldbus::Slot slot = image.outputSlot(object.id);
  return slot == fieldbus::kNoSlot || image.outputLeftOut(slot) ? fieldbus::kNoSlot : slot;
}

}  // namespace

BitChange::BitChange(drive::Axis& axis, const drive::ObjectSpec& object, std::uint64_t mask,
                     std::uint64_t bits)
    : axis_(&axis), object_(&object), slot_(travellingIn(axis, object)), mask_(mask), bits_(bits) {
  if (!travels()) ticket_ = axis.device().objects().upload(object.id, object.name);
}

/// As many bytes are written as were read, whatever the profile says.
bool BitChange::step() {
  if (travels()) {
    fieldbus::ProcessImage& image = axis_->device().image();
    found_ = image.output(slot_);
    image.setOutput(slot_, (found_ & ~mask_) | (bits_ & mask_));
    return true;
  }
  if (!ticket_->done()) return false;
  if (!ticket_->ok()) {
    problem_ =
        titleOf(*object_) + (writing_ ? " not written: " : " not read: ") + ticket_->reason();
    return true;
  }
  if (writing_) return true;
  found_ = fieldbus::toUnsigned(ticket_->data());
  if (mask_ == 0) return true;
  const auto size = static_cast<unsigned>(ticket_->data().size());
  writing_ = true;
  ticket_ = axis_->device().objects().download(
      object_->id, fieldbus::toBytes((found_ & ~mask_) | (bits_ & mask_), size), object_->name);
  return false;
}

std::string bitsRefusal(drive::Axis& axis, const drive::ObjectSpec& object) {
  if (drive::saidToLack(axis.config(), object.name)) {
    return "the configuration says that the drive lacks " + titleOf(object) + " (`lacks`)";
  }
  const fieldbus::Slot slot = travellingIn(axis, object);
  if (slot == fieldbus::kNoSlot) return {};
  if (!drive::isSetByAxis(*axis.config().profile, object.name)) return {};
  return titleOf(object) + " travels in " + axis.device().carrierText(slot) +
         ", which would undo it in the next cycle; take it out of `pdos`";
}

}  // namespace cia402::bus
