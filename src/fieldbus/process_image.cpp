// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/process_image.h"

#include <algorithm>

namespace cia402::fieldbus {
namespace {

Slot findSlot(const std::vector<ObjectId>& objects, ObjectId object) {
  const auto found = std::find(objects.begin(), objects.end(), object);
  return found == objects.end() ? kNoSlot : static_cast<Slot>(found - objects.begin());
}

}  // namespace

Slot ProcessImage::inputSlot(ObjectId object) const { return findSlot(input_objects_, object); }
Slot ProcessImage::outputSlot(ObjectId object) const { return findSlot(output_objects_, object); }

Slot ProcessImage::addInput(ObjectId object) {
  const Slot slot = inputSlot(object);
  if (slot != kNoSlot) return slot;
  input_objects_.push_back(object);
  inputs_.emplace_back();
  deliveries_.emplace_back();
  inputs_left_out_.push_back(false);
  return static_cast<Slot>(inputs_.size() - 1);
}

Slot ProcessImage::addOutput(ObjectId object) {
  const Slot slot = outputSlot(object);
  if (slot != kNoSlot) return slot;
  output_objects_.push_back(object);
  outputs_.push_back(0);
  carriers_.push_back(0);
  outputs_left_out_.push_back(false);
  return static_cast<Slot>(outputs_.size() - 1);
}

void ProcessImage::setCarrier(Slot slot, std::size_t carrier) {
  carriers_[slot] = carrier;
  sent_.resize(std::max(sent_.size(), carrier + 1));
}

void ProcessImage::clear() {
  std::fill(inputs_.begin(), inputs_.end(), ProcessValue{});
  std::fill(outputs_.begin(), outputs_.end(), std::uint64_t{0});
}

}  // namespace cia402::fieldbus
