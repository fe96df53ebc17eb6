// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/last_stop.h"

#include <algorithm>
#include <set>
#include <utility>

namespace cia402::canopen {
namespace {

constexpr unsigned kBrakes = 2;      // by the mode that brakes, where another stop would not, ...
constexpr unsigned kMotorStops = 5;  // ... by SDO, ...
constexpr Duration kMotorInterval = std::chrono::milliseconds(8);
constexpr unsigned kQuickStops = 5;  // ... then by NMT, ...
constexpr Duration kQuickInterval = std::chrono::milliseconds(20);
constexpr Duration kSlowInterval = std::chrono::milliseconds(100);  // ... and at last so often
constexpr Duration kPatience = std::chrono::milliseconds(500);
constexpr Duration kEnough = std::chrono::seconds(3);
constexpr Duration kSeldom = std::chrono::seconds(1);  // a slow drive has answered them by then
constexpr Duration kNoAnswer = std::chrono::milliseconds(50);  // to an SDO; most take 10
constexpr Duration kOnItsWay = std::chrono::milliseconds(10);  // a heartbeat of before the command

}  // namespace

void LastStop::remember(PdoImage& image) {
  rememberSetPoints(image);
  brakes_.clear();
  ramps_ = true;
  for (const BootBrake& brake : config_.brakes) {
    const auto& pushing = brake.pushing;
    if (pushing.empty()) continue;
    const fieldbus::Slot slot = image.inputSlot(brake.shown_mode);
    const bool told = slot != fieldbus::kNoSlot && image.input(slot).valid;
    if (!told) {
      ramps_ = false;
      continue;
    }
    const int mode = static_cast<std::int8_t>(image.input(slot).raw & 0xFFU);
    if (std::find(pushing.begin(), pushing.end(), mode) == pushing.end()) continue;
    ramps_ = false;
    brakes_.push_back({brake.mode, fieldbus::toBytes(static_cast<std::uint64_t>(brake.brake), 1)});
  }
}

/// As they were sent: nothing but what stops the motor is new to the drive.
void LastStop::rememberSetPoints(PdoImage& image) {
  std::set<std::size_t> carriers;
  for (const StartupWrite& write : config_.writes) {
    const fieldbus::Slot slot = image.outputSlot(write.object);
    if (!write.always || slot == fieldbus::kNoSlot || image.outputLeftOut(slot)) continue;
    image.setOutput(slot, fieldbus::toUnsigned(write.data));
    carriers.insert(image.carrierOf(slot));
  }
  std::vector<can::Frame> frames;
  for (const std::size_t carrier : carriers) {
    const PdoImage::Pdo& rpdo = image.rpdos()[carrier];
    if (rpdo.sent_once && rpdo.carrier.empty()) image.pack(carrier, frames.emplace_back());
  }
  if (!frames.empty()) set_points_ = std::move(frames);  // else it was forgotten before
}

void LastStop::begin(Time now) {
  patience_end_ = now + kPatience;
  end_ = now + kEnough;
  restart(now);
}

void LastStop::restart(Time now) {
  said_ = braked_ = 0;
  next_ = now;
  tick(now);
}

void LastStop::tick(Time now) {
  if (now < next_) return;
  if (now >= end_) return end();
  last_ = now;
  if (braked_ < kBrakes && brake()) {
    ++braked_;
    next_ = now + kMotorInterval;
    return;
  }
  if (said_ < kMotorStops) {
    ++said_;
    next_ = now + kMotorInterval;
    if (stopMotor()) return;
    said_ = kMotorStops;
  }
  sink_.send(nmtFrame(NmtCommand::stop, config_.node_id));
  const bool quickly = ++said_ < kMotorStops + kQuickStops;
  next_ = now + (quickly ? kQuickInterval : kSlowInterval);
}

bool LastStop::brake() {
  bool told = false;
  for (const ModeWrite& write : brakes_) told = sdo_.post(write.object, write.data) || told;
  return told;
}

bool LastStop::stopMotor() {
  bool told = false;
  for (const StartupWrite& write : config_.writes) {
    if (write.always) told = sdo_.post(write.object, write.data) || told;
  }
  return told;
}

void LastStop::stopBesides(NmtState heard, Time now) {
  if (besides_ == 0) besides_since_ = now;
  if (now >= besides_since_ + kNoAnswer) stopByPdo(heard);
  if (besides_ >= kMotorStops && now < besides_at_ + kSeldom) return;
  ++besides_;
  besides_at_ = now;
  stopMotor();
}

void LastStop::stopByPdo(NmtState heard) {
  const bool left = heard == NmtState::pre_operational;
  if (set_points_.empty() || (!left && heard != NmtState::operational)) return;
  if (left) sink_.send(nmtFrame(NmtCommand::start, config_.node_id));
  for (const can::Frame& frame : set_points_) sink_.send(frame);
}

bool LastStop::insists(NmtState state, Time now) {
  if (next_ == kNever || state != NmtState::operational || now >= patience_end_) return false;
  if (now >= last_ + kOnItsWay) restart(now);
  return true;
}

}  // namespace cia402::canopen
