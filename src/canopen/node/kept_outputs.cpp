// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/kept_outputs.h"

#include <algorithm>

namespace cia402::canopen {

KeptOutputs::KeptOutputs(PdoImage& image, SdoClient& sdo) : image_(image) {
  sdo.tellWritten([this](ObjectId object, const Bytes& data) { written(object, data); });
}

void KeptOutputs::begin(const std::vector<KeptValue>& found) {
  objects_.clear();
  for (const KeptValue& value : found) {
    objects_.push_back(value.object);
    image_.setOutput(image_.outputSlot(value.object), value.raw);
  }
}

void KeptOutputs::written(ObjectId object, const Bytes& data) {
  const bool kept = std::find(objects_.begin(), objects_.end(), object) != objects_.end();
  if (kept && data.size() <= 8) image_.setOutput(image_.outputSlot(object), toUnsigned(data));
}

}  // namespace cia402::canopen
