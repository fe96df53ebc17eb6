// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/guarding.h"

namespace cia402::sim {

namespace {

constexpr std::uint32_t kErrorControl = 0x700;
constexpr ObjectId kGuardTime{0x100C, 0};
constexpr ObjectId kLifeTimeFactor{0x100D, 0};
constexpr ObjectId kHeartbeatTime{0x1017, 0};
constexpr std::uint16_t kLifeGuardLost = 0x8130;
constexpr unsigned kToggleBit = 0x80;

}  // namespace

void SlaveGuarding::serveObjects() {
  exists_ = context_.dictionary.find(kGuardTime) != nullptr ||
            context_.dictionary.find(kHeartbeatTime) == nullptr;
  for (const ObjectId id : {kGuardTime, kLifeTimeFactor}) {
    context_.serveWrites(id, nullptr, [this](const Entry&) { restart(); });
  }
}

void SlaveGuarding::reset() {
  toggle_ = false;
  guarded_ = false;
  lost_ = false;
  deadline_ = kNever;
}

bool SlaveGuarding::used() const { return exists_ && context_.value(kHeartbeatTime) == 0; }

Duration SlaveGuarding::lifeTime() const {
  const auto guard_time = static_cast<std::int64_t>(context_.value(kGuardTime));
  const auto factor = static_cast<std::int64_t>(context_.value(kLifeTimeFactor));
  return std::chrono::milliseconds(guard_time * factor);
}

void SlaveGuarding::restart() {
  deadline_ = kNever;
  if (guarded_ && !lost_ && lifeTime() > Duration::zero()) deadline_ = context_.now + lifeTime();
}

void SlaveGuarding::receive(const can::Frame& frame) {
  if (!frame.remote || !used()) return;
  const unsigned state = static_cast<unsigned>(context_.state) | (toggle_ ? kToggleBit : 0U);
  toggle_ = !toggle_;
  context_.sink.send(can::Frame(kErrorControl + context_.node, {static_cast<std::uint8_t>(state)}));
  const bool was_lost = lost_;
  emergency_.resolve(lost_);
  guarded_ = true;
  restart();
  if (was_lost) context_.application.onMasterBack(context_.now);
}

void SlaveGuarding::tick() {
  if (deadline_ > context_.now) return;
  deadline_ = kNever;
  if (!used()) return;
  emergency_.raise(lost_, kLifeGuardLost);
  context_.masterLost();
}

}  // namespace cia402::sim
