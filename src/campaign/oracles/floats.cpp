// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Nothing that is not finite, nor -0.0, leaves in an object that holds a float.
#include <map>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

/// Neither infinite nor NaN nor -0.0, by the bits of IEEE 754.
bool sound(std::uint32_t bits) { return (bits & 0x7F800000) != 0x7F800000 && bits != 0x80000000; }

class Floats final : public Oracle {
 public:
  explicit Floats(const Stage& stage) : received_(stage.axes().size()) {
    for (const PdoPlace& place : stage.rpdos()) {
      const AxisFacts& facts = stage.axes()[place.axis];
      const drive::ObjectSpec* spec = facts.config->profile->find(place.object);
      if (spec != nullptr && spec->encoding == drive::Encoding::float32) {
        places_[place.cob_id].push_back(place);
      }
    }
  }
  const char* name() const override { return "bad_float"; }

  void onFrame(const can::Frame& frame, const View& view) override {
    const auto found = places_.find(frame.id);
    if (found == places_.end() || frame.error || frame.remote) return;
    for (const PdoPlace& place : found->second) {
      if (frame.size < place.byte + 4) continue;
      std::uint32_t bits = 0;
      for (unsigned i = 0; i < 4; ++i) {
        bits |= static_cast<std::uint32_t>(frame.data[place.byte + i]) << 8 * i;
      }
      if (!sound(bits)) report(view, place.axis, "is sent the float " + hex(bits) + " by RPDO");
    }
  }
  void look(const View& view) override {
    for (std::size_t i = 0; i < received_.size(); ++i) {
      if (view.truths[i].bad_floats > received_[i]) {
        report(view, i, "was sent a float that is not finite, or -0.0");
      }
      received_[i] = view.truths[i].bad_floats;
    }
  }

 private:
  static std::string hex(std::uint32_t bits) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%08X", bits);
    return text;
  }

  std::map<std::uint32_t, std::vector<PdoPlace>> places_;
  std::vector<unsigned> received_;
};

}  // namespace

std::unique_ptr<Oracle> makeFloats(const Stage& stage) { return std::make_unique<Floats>(stage); }

}  // namespace cia402::campaign
