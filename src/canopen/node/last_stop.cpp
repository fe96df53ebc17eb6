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

/// By PDO, since the node has been started.
bool isSent(const PdoImage& image, fieldbus::Slot slot) {
  if (slot == fieldbus::kNoSlot || image.outputLeftOut(slot)) return false;
  const PdoImage::Pdo& rpdo = image.rpdos()[image.carrierOf(slot)];
  return rpdo.sent_once && rpdo.carrier.empty();
}

std::vector<can::Frame> packed(const PdoImage& image, const std::set<std::size_t>& rpdos) {
  std::vector<can::Frame> frames;
  for (const std::size_t rpdo : rpdos) image.pack(rpdo, frames.emplace_back());
  return frames;
}

}  // namespace

void LastStop::remember(PdoImage& image) {
  brakes_.clear();
  ramps_ = known_ = true;
  std::vector<const BootBrake*> pushing_now;
  for (const BootBrake& brake : config_.brakes) {
    const auto& pushing = brake.pushing;
    if (pushing.empty()) continue;
    const fieldbus::Slot slot = image.inputSlot(brake.shown_mode);
    const bool told = slot != fieldbus::kNoSlot && image.input(slot).valid;
    if (!told) {
      ramps_ = known_ = false;
      continue;
    }
    const int mode = static_cast<std::int8_t>(image.input(slot).raw & 0xFFU);
    if (std::find(pushing.begin(), pushing.end(), mode) == pushing.end()) continue;
    ramps_ = false;
    brakes_.push_back({brake.mode, fieldbus::toBytes(static_cast<std::uint64_t>(brake.brake), 1)});
    pushing_now.push_back(&brake);
  }
  rememberSetPoints(image, pushing_now);
}

/// As they were sent: nothing but what brakes and stops the motor is new to the drive.
void LastStop::rememberSetPoints(PdoImage& image, const std::vector<const BootBrake*>& pushing) {
  std::set<std::size_t> carriers;
  for (const BootBrake* brake : pushing) {
    const fieldbus::Slot mode = image.outputSlot(brake->mode);
    const fieldbus::Slot target = image.outputSlot(brake->target);  // the velocity it has had
    if (!isSent(image, mode) || !isSent(image, target)) continue;
    image.setOutput(mode, static_cast<std::uint64_t>(brake->brake));
    carriers.insert(image.carrierOf(mode));
  }
  std::vector<can::Frame> takes_over = packed(image, carriers);
  for (const StartupWrite& write : config_.writes) {
    const fieldbus::Slot slot = image.outputSlot(write.object);
    if (!write.always || slot == fieldbus::kNoSlot || image.outputLeftOut(slot)) continue;
    image.setOutput(slot, fieldbus::toUnsigned(write.data));
    if (isSent(image, slot)) carriers.insert(image.carrierOf(slot));
  }
  std::vector<can::Frame> stops = packed(image, carriers);
  if (stops.empty()) return;  // it was forgotten before
  takes_over_ = std::move(takes_over);
  set_points_ = std::move(stops);
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
  if (brakes_.empty()) return false;
  bool told = false;
  for (const ModeWrite& write : brakes_) told = sdo_.post(write.object, write.data) || told;
  for (const can::Frame& frame : takes_over_) sink_.send(frame);
  return told || !takes_over_.empty();
}

bool LastStop::stopMotor() {
  bool told = false;
  for (const StartupWrite& write : config_.writes) {
    if (write.always) told = sdo_.post(write.object, write.data) || told;
  }
  return told;
}

void LastStop::stopBesides(NmtState heard, Time now) {
  if (!known_) return;
  if (!asked_since_) asked_since_ = now;
  const bool mute = now >= *asked_since_ + kNoAnswer;
  if (!ramps_ && !mute) return;
  const bool by_pdo = mute && startForPdos(heard);
  if (!ramps_ && !std::exchange(taken_over_, true) && brake()) return;
  if (by_pdo) {
    for (const can::Frame& frame : set_points_) sink_.send(frame);
  }
  if (besides_ >= kMotorStops && now < besides_at_ + kSeldom) return;
  ++besides_;
  besides_at_ = now;
  stopMotor();
}

bool LastStop::startForPdos(NmtState heard) {
  const bool left = heard == NmtState::pre_operational;
  if (set_points_.empty() || (!left && heard != NmtState::operational)) return false;
  if (left) sink_.send(nmtFrame(NmtCommand::start, config_.node_id));
  return true;
}

bool LastStop::insists(NmtState state, Time now) {
  if (next_ == kNever || state != NmtState::operational || now >= patience_end_) return false;
  if (now >= last_ + kOnItsWay) restart(now);
  return true;
}

}  // namespace cia402::canopen
