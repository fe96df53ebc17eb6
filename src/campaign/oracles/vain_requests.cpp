// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that says that it is stopped answers no SDO (CiA 301, table 38): who boots it starts it
// first. People may ask it what they like.
#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

constexpr unsigned kTold = 3;   // heartbeats in a row: one may be lost, one not looked at yet
constexpr unsigned kAsked = 2;  // requests: one may have been on its way

/// The upload of 1000h, with which each boot begins.
bool boots(const can::Frame& request) {
  return request.size >= 4 && request.data[0] == 0x40 && request.data[1] == 0x00 &&
         request.data[2] == 0x10 && request.data[3] == 0x00;
}

class VainRequests final : public Oracle {
 public:
  explicit VainRequests(const Stage& stage) : drives_(stage.drives().size()) {}
  const char* name() const override { return "vain_request"; }

  void look(const View& view) override {
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      const std::size_t first = view.stage.drives()[i].axes.front();
      if (view.truths[first].nmt != canopen::NmtState::stopped) drives_[i] = {};  // reset, perhaps
    }
  }

  void onFrame(const can::Frame& frame, const View& view) override {
    if (frame.error || frame.remote || frame.size == 0) return;
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      Drive& drive = drives_[i];
      const std::uint32_t node = view.stage.drives()[i].node_id;
      const std::size_t first = view.stage.drives()[i].axes.front();
      // An emergency or an answer proves that it left the state since.
      if (frame.id == 0x080 + node || frame.id == 0x580 + node) drive.told = drive.asked = 0;
      if (frame.id == 0x700 + node) {  // a heartbeat, or an answer to guarding
        const bool heard =
            view.now >= view.conditions.lossy && view.now >= view.conditions.axes[first].unheard;
        const bool stopped = heard && (frame.data[0] & 0x7F) == 0x04;
        drive.told = stopped ? drive.told + 1 : 0;
        if (!stopped) drive.asked = 0;
      }
      if (frame.id != 0x600 + node || !boots(frame) || drive.told < kTold) continue;
      if (++drive.asked != kAsked) continue;
      report(view, first, "says that it is stopped, and is asked by SDO again and again");
    }
  }

 private:
  struct Drive {
    unsigned told = 0, asked = 0;  // since it said something else
  };
  std::vector<Drive> drives_;
};

}  // namespace

std::unique_ptr<Oracle> makeVainRequests(const Stage& stage) {
  return std::make_unique<VainRequests>(stage);
}

}  // namespace cia402::campaign
