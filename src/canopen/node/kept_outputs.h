// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "canopen/boot/context.h"
#include "canopen/pdo/image.h"
#include "canopen/sdo/client.h"

namespace cia402::canopen {

/// Objects in RPDOs that no cycle sets (PdoEntry::kept). They travel as the drive has been found to
/// hold them, and from a write on, whoever has asked for it, as they were written.
class KeptOutputs {
 public:
  /// Both must outlive it.
  KeptOutputs(PdoImage& image, SdoClient& sdo);

  /// The node is in operation, and its RPDOs are about to be sent.
  void begin(const std::vector<KeptValue>& found);

 private:
  void written(ObjectId object, const Bytes& data);

  PdoImage& image_;
  std::vector<ObjectId> objects_;
};

}  // namespace cia402::canopen
