// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/kept_outputs.h"

#include <algorithm>

namespace cia402::canopen {

KeptOutputs::KeptOutputs(const NodeConfig& config, PdoImage& image, SdoClient& sdo)
    : image_(image) {
  for (const PdoConfig& pdo : config.pdos) {
    if (!pdo.enabled || pdo.direction != PdoDirection::rpdo) continue;
    for (const PdoEntry& entry : pdo.entries) {
      if (entry.kept) objects_.push_back(entry.object);
    }
  }
  if (objects_.empty()) return;
  sdo.tellWritten([this](ObjectId object, const Bytes& data) { written(object, data); });
}

void KeptOutputs::begin(const std::vector<KeptValue>& found) {
  for (const KeptValue& value : found) image_.setOutput(image_.outputSlot(value.object), value.raw);
}

void KeptOutputs::written(ObjectId object, const Bytes& data) {
  const bool kept = std::find(objects_.begin(), objects_.end(), object) != objects_.end();
  if (kept && data.size() <= 8) image_.setOutput(image_.outputSlot(object), toUnsigned(data));
}

}  // namespace cia402::canopen
