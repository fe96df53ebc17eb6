// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How long the drive holds what its profile leaves open, by reading it.
#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"

namespace cia402::canopen {
namespace {

class Widths : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (item_ == 0) boot.sdo.widths().clear();
    if (item_ >= boot.config.widths.size()) return false;
    const OpenWidth& open = boot.config.widths[item_];
    boot.read(open.object, open.name, now, boot.ifThere());
    return true;
  }

  Progress check(BootContext& boot, Time) override {
    if (!boot.answered()) return Progress::waiting;
    const OpenWidth& open = boot.config.widths[item_++];
    if (!boot.ok()) return boot.refused() ? Progress::again : boot.failTransfer();
    const std::size_t bytes = boot.ticket->data().size();
    if (bytes == open.bytes) return Progress::again;
    if (bytes < open.bytes || bytes > open.most) {
      return boot.fail(BootFailure::refused,
                       objectText(open.object, open.name) + " has " + std::to_string(bytes) +
                           " bytes in the drive, and not " + std::to_string(open.bytes) + " to " +
                           std::to_string(open.most) + " as its profile allows");
    }
    const LearnedWidth width{open.object, open.bytes, bytes, open.is_signed};
    boot.sdo.widths().add(width);
    boot.found.widths.push_back(width);
    boot.remarks.push_back(objectText(open.object, open.name) + " has " +
                           std::to_string(8 * bytes) + " bits in this drive");
    return Progress::again;
  }

 private:
  std::size_t item_ = 0;
};

}  // namespace

BootStepPointer makeWidths() { return std::make_unique<Widths>(); }

}  // namespace cia402::canopen
