// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/bit_change.h"

#include "fieldbus/bytes.h"

namespace cia402::bus {
namespace {

std::string titleOf(const drive::ObjectSpec& object) {
  return fieldbus::toString(object.id) + " " + object.name;
}

}  // namespace

BitChange::BitChange(drive::Axis& axis, const drive::ObjectSpec& object, std::uint64_t mask,
                     std::uint64_t bits)
    : axis_(&axis),
      object_(&object),
      mask_(mask),
      bits_(bits),
      ticket_(axis.device().objects().upload(object.id, object.name)) {}

/// As many bytes are written as were read, whatever the profile says.
bool BitChange::step() {
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
  const fieldbus::Device& device = axis.device();
  const fieldbus::Slot slot = device.image().outputSlot(object.id);
  if (slot == fieldbus::kNoSlot || device.image().outputLeftOut(slot)) return {};
  return titleOf(object) + " travels in " + device.carrierText(slot) +
         ", which would undo it in the next cycle; take it out of `pdos`";
}

}  // namespace cia402::bus
