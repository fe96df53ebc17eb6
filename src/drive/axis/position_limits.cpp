// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/position_limits.h"

#include <algorithm>
#include <utility>

namespace cia402::drive {
namespace {

constexpr std::uint32_t kNoObject = 0x06020000, kNoSubindex = 0x06090011;  // CiA 301, 7.2.4.3.17
constexpr double kInside = 1e-4;  // rad or m; more than the noise of an encoder at a limit

using Failure = fieldbus::Transfer::Failure;

}  // namespace

PositionLimits::PositionLimits(const AxisConfig& config) : read_back_(config.profile->reads_back) {
  adopt(config);
}

void PositionLimits::adopt(const AxisConfig& config) {
  sides_.clear();
  ticket_.reset();
  idle_ = false;
  for (const auto* writes : {&config.profile->startup, &config.writes}) {
    for (const NamedWrite& write : *writes) {
      if (!write.when_homed) continue;
      const auto limit = resolveLimit(write, config);
      if (!limit || !*limit) continue;
      const ObjectId object = (*limit)->write.object;  // the user's write replaces the profile's
      auto side = std::find_if(sides_.begin(), sides_.end(), [&](const Side& known) {
        return known.limit.write.object == object;
      });
      if (side == sides_.end()) side = sides_.insert(side, Side());
      side->limit = **limit;
    }
  }
}

void PositionLimits::forget() {
  idle_ = false;
  ticket_.reset();
  for (Side& side : sides_) {
    const ResolvedLimit limit = side.limit;
    side = Side();
    side.limit = limit;
  }
}

void PositionLimits::aim(bool known, double shift, double position) {
  idle_ = false;
  for (Side& side : sides_) {
    const ResolvedLimit& limit = side.limit;
    side.closed = limit.open;
    // What does not fit lies beyond all that the drive can count.
    if (known && !limit.conversion.shifted(shift).toDevice(limit.value, side.closed)) {
      side.closed = limit.open;
    }
    const bool outside = limit.lower ? position < limit.value : position > limit.value;
    side.left_open = outside && side.closed != limit.open;
    side.wanted = side.left_open ? limit.open : side.closed;
    side.aimed = true;
    side.refusal.clear();
  }
}

void PositionLimits::closeIfInside(double position, double target) {
  for (Side& side : sides_) {
    if (!side.left_open) continue;
    const double beyond = side.limit.lower ? 1.0 : -1.0;
    const double room = (position - side.limit.value) * beyond;
    if (!(room > kInside) || !((target - side.limit.value) * beyond > kInside)) continue;
    side.left_open = false;
    side.wanted = side.closed;
  }
}

bool PositionLimits::reached(const Side& side) const {
  return side.absent || !side.aimed || side.held == side.wanted;
}

void PositionLimits::advance(fieldbus::ObjectAccess& objects) {
  if (ticket_) {
    if (!ticket_->done()) return;
    const fieldbus::Ticket answer = std::exchange(ticket_, nullptr);
    take(sides_[busy_], *answer);
  }
  for (busy_ = 0; busy_ < sides_.size(); ++busy_) {
    Side& side = sides_[busy_];
    if (reached(side) || !side.refusal.empty()) continue;
    const ResolvedWrite& write = side.limit.write;
    sent_ = side.wanted;
    ticket_ = side.asked ? objects.download(write.object, wireBytes(sent_, write.type), write.name)
                         : objects.upload(write.object, write.name);
    return;
  }
  idle_ = true;
  for (const Side& side : sides_) idle_ = idle_ && side.aimed && !side.left_open;
}

void PositionLimits::take(Side& side, const fieldbus::Transfer& answer) {
  if (answer.direction() == fieldbus::Transfer::Direction::upload) {
    side.asked = true;
    const bool none = answer.abortCode() == kNoObject || answer.abortCode() == kNoSubindex;
    side.absent =
        none && answer.failure() == Failure::aborted_by_server && side.limit.write.optional;
    const std::size_t size = fieldbus::sizeBits(side.limit.write.type) / 8;
    if (answer.ok() && answer.data().size() == size) {
      side.held = fieldbus::toUnsigned(answer.data());
    }
    if (std::exchange(side.checking, false)) compare(side);
    return;
  }
  if (answer.ok()) {
    side.wrote = sent_;
    side.checking = read_back_;
    side.asked = !read_back_;
    side.held = read_back_ ? std::nullopt : std::optional<std::uint64_t>(sent_);
    return;
  }
  if (answer.failure() != Failure::aborted_by_server) side.held.reset();  // it may have taken it
  side.refusal = answer.message();
}

/// What cannot be read again is believed.
void PositionLimits::compare(Side& side) {
  if (!side.held) side.held = side.wrote;
  if (*side.held == side.wrote) return;
  side.refusal = "the drive took " + side.limit.write.name + " = " + std::to_string(side.wrote) +
                 ", but holds " + std::to_string(*side.held) +
                 " when it is read back: look at its range in the drive's manual";
}

bool PositionLimits::settled() const {
  if (ticket_) return false;
  for (const Side& side : sides_) {
    if (!reached(side) && side.refusal.empty()) return false;
  }
  return true;
}

/// Of two limits of which the lower is not below the upper, drives make none.
bool PositionLimits::narrower(const Side& side) const {
  if (!side.held) return false;
  const auto joint = [](const Side& of) { return of.limit.conversion.toJoint(*of.held); };
  for (const Side& other : sides_) {
    const bool pair = other.limit.write.object.index == side.limit.write.object.index &&
                      other.limit.lower != side.limit.lower;
    if (!pair || !other.held) continue;
    if (side.limit.lower ? joint(side) >= joint(other) : joint(other) >= joint(side)) return false;
  }
  const double wanted = side.limit.conversion.toJoint(side.wanted);
  return side.limit.lower ? joint(side) > wanted : joint(side) < wanted;
}

std::string PositionLimits::problem() const {
  for (const Side& side : sides_) {
    if (side.refusal.empty() || reached(side)) continue;
    if (!side.limit.write.optional || narrower(side)) return side.refusal;
  }
  return {};
}

std::string PositionLimits::remark() const {
  for (const Side& side : sides_) {
    if (side.refusal.empty() || reached(side)) continue;
    return "; the drive's own position limits stay as they are until it is enabled again: " +
           side.refusal;
  }
  return {};
}

}  // namespace cia402::drive
