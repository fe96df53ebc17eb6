// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How wide the drive at hand has floats that its family has in 32 or in 16 bits: they are read, and
// the length of the answer tells.
#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

constexpr std::size_t kHalf = 2, kWhole = 4;  // bytes
constexpr std::uint64_t kLargestHalf = 0xFFFF;

class HalfFloatSearch : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    HalfFloats& halves = boot.sdo.halfFloats();
    if (item_ == 0) halves.clear();
    if (item_ == boot.config.half_floats.size()) {
      if (item_ == 0) return false;
      if (!text_.empty()) boot.remarks.push_back("has these floats in 16 bits: " + text_);
      boot.found.half_floats_known = true;
      return false;
    }
    const HalfFloat& half = boot.config.half_floats[item_];
    boot.read(half.object, half.name, now, boot.ifThere());
    return true;
  }

  Progress check(BootContext& boot, Time) override {
    if (!boot.answered()) return Progress::waiting;
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    if (boot.ok()) judge(boot);
    ++item_;
    return Progress::again;
  }

 private:
  void judge(BootContext& boot) {
    const HalfFloat& half = boot.config.half_floats[item_];
    const Bytes& data = boot.ticket->data();
    const std::string object = objectText(half.object, half.name);
    if (data.size() == kHalf) {
      boot.sdo.halfFloats().add(half);
      append(text_, object, ", ");
    } else if (data.size() == kWhole && toUnsigned(data) != 0 && toUnsigned(data) <= kLargestHalf) {
      boot.notes.push_back(object + " holds " +
                           hexText(static_cast<std::uint32_t>(toUnsigned(data)), 8) +
                           ", which looks like the 16 bits of a float in 32: check the drive's "
                           "firmware before it is relied on");
    }
  }

  std::size_t item_ = 0;
  std::string text_;
};

}  // namespace

BootStepPointer makeHalfFloatSearch() { return std::make_unique<HalfFloatSearch>(); }

}  // namespace cia402::canopen
