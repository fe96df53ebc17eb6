// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/conversion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fieldbus/float_codec.h"

namespace cia402::drive {
namespace {

using Base = UnitSpec::Base;
using Type = AxisGeometry::Type;

constexpr double kExact = 9007199254740992.0;  // 2^53: whole numbers up to here are doubles
constexpr double kPi = 3.14159265358979323846;

bool isMotion(Quantity quantity) {
  return quantity == Quantity::position || quantity == Quantity::distance ||
         quantity == Quantity::velocity || quantity == Quantity::acceleration ||
         quantity == Quantity::jerk;
}

Error lacks(const ObjectSpec& object, const std::string& what) {
  return Error{object.name + " (" + fieldbus::toString(object.id) +
               ") cannot be converted: " + what};
}

// Radians of the shaft that the drive counts at, per base unit.
Result<double> angle(const ObjectSpec& object, Base base, const AxisGeometry& geometry) {
  switch (base) {
    case Base::count:
      if (geometry.counts_per_turn > 0.0) return 2.0 * kPi / geometry.counts_per_turn;
      return lacks(object,
                   "counts_per_turn is not given; write the drive's position counts per "
                   "motor turn");
    case Base::turn:
      return 2.0 * kPi;
    case Base::radian:
      return 1.0;
    case Base::degree:
      return kPi / 180.0;
    default:
      return lacks(object, "the profile's unit for it is none of count, turn, rad, deg");
  }
}

// Joint units (rad or m) per radian of the shaft that the drive counts at.
Result<double> transmission(const ObjectSpec& object, const DriveProfile& profile,
                            const AxisGeometry& geometry) {
  if (!(geometry.gear_ratio > 0.0)) return lacks(object, "gear_ratio is not greater than 0");
  const double shaft = profile.output_shaft ? 1.0 : 1.0 / geometry.gear_ratio;
  if (geometry.type != Type::prismatic) return shaft;
  if (geometry.lead > 0.0) return shaft * geometry.lead / (2.0 * kPi);
  return lacks(object, "lead is not given; a prismatic axis needs its metres per screw turn");
}

Result<double> torque(const ObjectSpec& object, Base base, const DriveProfile& profile,
                      const AxisGeometry& geometry) {
  double unit = 1.0;
  if (base == Base::per_mille_of_rated) {
    if (!(geometry.rated_torque > 0.0)) {
      return lacks(object, "rated_torque is not given, and the drive counts in 1/1000 of it");
    }
    unit = geometry.rated_torque * 1e-3;
  } else if (base != Base::newton_metre) {
    return lacks(object, "the profile's unit for torque is neither per_mille_of_rated nor N.m");
  }
  const auto per_radian = transmission(object, profile, geometry);
  if (!per_radian) return per_radian;
  return unit / *per_radian;  // power is the same on both sides of gear and screw
}

// SI joint units per device unit, direction left out.
Result<double> jointPerUnit(const ObjectSpec& object, const UnitSpec& unit,
                            const DriveProfile& profile, const AxisGeometry& geometry) {
  if (object.quantity == Quantity::torque) return torque(object, unit.base, profile, geometry);
  if (!isMotion(object.quantity)) return 1.0;
  const auto radians = angle(object, unit.base, geometry);
  if (!radians) return radians;
  const auto per_radian = transmission(object, profile, geometry);
  if (!per_radian) return per_radian;
  return *radians * *per_radian / (unit.per_minute ? 60.0 : 1.0);
}

const UnitSpec* unitOf(const ObjectSpec& object, const DriveProfile& profile) {
  if (object.unit) return &*object.unit;
  // Windows and following errors count as positions do.
  const auto found = profile.units.find(object.quantity == Quantity::distance ? Quantity::position
                                                                              : object.quantity);
  return found == profile.units.end() ? nullptr : &found->second;
}

}  // namespace

Result<Conversion> Conversion::create(const ObjectSpec& object, const DriveProfile& profile,
                                      const AxisGeometry& geometry) {
  const unsigned bits = fieldbus::sizeBits(object.type);
  if (bits == 0 || object.type == DataType::real64) {
    return lacks(object, std::string("a ") + fieldbus::toString(object.type) +
                             " holds no number that can be scaled");
  }
  Conversion result;
  double scale = 1.0 / object.factor;
  if (object.quantity != Quantity::none) {
    const UnitSpec* unit = unitOf(object, profile);
    if (unit == nullptr) return lacks(object, "the profile has no unit for what it measures");
    const auto per_unit = jointPerUnit(object, *unit, profile, geometry);
    if (!per_unit) return per_unit.error();
    scale = unit->to > 0.0 ? *per_unit * unit->to / (scale * unit->scale)
                           : scale * *per_unit * unit->scale;
    result.time_ = unit->to > 0.0;
  }

  const bool floating = object.encoding != Encoding::integer;
  result.encoding_ = object.encoding;
  result.plain_ = !floating && !result.time_;
  result.shift_ = static_cast<std::uint8_t>(64 - bits);
  result.mask_ = ~std::uint64_t{0} >> result.shift_;
  result.signed_ = fieldbus::isSigned(object.type) || object.type == DataType::real32;
  const bool directed = isMotion(object.quantity) || object.quantity == Quantity::torque;
  result.factor_ = result.signed_ && directed && geometry.direction < 0 ? -scale : scale;
  result.inverse_ = 1.0 / result.factor_;
  if (result.signed_ && object.quantity == Quantity::position) {
    result.offset_ = geometry.position_offset;
  }

  // 2^63 - 1 and 2^64 - 1 are no doubles: the largest ones below them.
  const double power = std::ldexp(1.0, static_cast<int>(bits) - (result.signed_ ? 1 : 0));
  result.high_ = bits == 64 ? std::nextafter(power, 0.0) : power - 1.0;
  result.low_ = result.signed_ ? -power : 0.0;
  if (floating) {
    result.high_ = largestFloat(object.encoding);
    result.low_ = result.signed_ ? lowestFloat(object.encoding) : 0.0;
  }
  result.first_ = result.low_;
  result.last_ = result.high_;
  if (result.time_) result.low_ = 1.0;  // no time at all is no acceleration
  if (object.range) {
    result.low_ = std::max(result.low_, object.range->low);
    result.high_ = std::min(result.high_, object.range->high);
  }
  return result;
}

double Conversion::otherToJoint(std::uint64_t raw) const {
  const double device = encoding_ == Encoding::integer ? static_cast<double>(raw & mask_)
                                                       : decodeFloat(encoding_, raw);
  return time_ ? factor_ / device : device * factor_ + offset_;
}

bool Conversion::toDevice(double value, std::uint64_t& raw) const {
  if (!plain_) return toOther(value, raw);
  double rounded = std::nearbyint((value - offset_) * inverse_);
  if (wraps_ && std::fabs(rounded) < kExact) {
    const double numbers = last_ - first_ + 1.0;
    rounded -= numbers * std::floor((rounded - first_) / numbers);
  }
  if (!(rounded >= low_ && rounded <= high_)) return false;  // NaN, too
  raw = wire(rounded);
  return true;
}

/// Not inlined: toDevice() would save its registers for the integers, too.
[[gnu::noinline]] bool Conversion::toOther(double value, std::uint64_t& raw) const {
  const double device = time_ ? factor_ / value : (value - offset_) * inverse_;
  if (encoding_ == Encoding::integer) {
    const double rounded = std::nearbyint(device);
    if (!(rounded >= low_ && rounded <= high_)) return false;
    raw = wire(rounded);
    return true;
  }
  if (!(device >= low_ && device <= high_)) return false;
  return encodeFloat(encoding_, device, raw);
}

std::uint64_t Conversion::wire(double device) const {
  return (signed_ ? static_cast<std::uint64_t>(static_cast<std::int64_t>(device))
                  : static_cast<std::uint64_t>(device)) &
         mask_;
}

std::uint64_t Conversion::sendableFloat(std::uint64_t raw) const {
  return withoutNegativeZero(encoding_, raw);
}

double Conversion::lowest() const {
  if (time_) return factor_ / high_;
  return (factor_ < 0.0 ? high_ : low_) * factor_ + offset_;
}

double Conversion::highest() const {
  if (time_) return factor_ / low_;
  return (factor_ < 0.0 ? low_ : high_) * factor_ + offset_;
}

std::uint64_t Conversion::lowestRaw() const {
  std::uint64_t raw = 0;
  if (encoding_ != Encoding::integer) return encodeFloat(encoding_, low_, raw) ? raw : 0;
  if (low_ > first_) return wire(low_);
  return signed_ ? mask_ ^ (mask_ >> 1) : 0;
}

std::uint64_t Conversion::highestRaw() const {
  std::uint64_t raw = 0;
  if (encoding_ != Encoding::integer) return encodeFloat(encoding_, high_, raw) ? raw : 0;
  if (high_ < last_) return wire(high_);
  return signed_ ? mask_ >> 1 : mask_;
}

double Conversion::resolution() const { return plain_ ? std::fabs(factor_) : 0.0; }

double Conversion::span() const { return plain_ ? (last_ - first_ + 1.0) * factor_ : 0.0; }

Conversion Conversion::wrapping() const {
  Conversion result = *this;
  result.wraps_ = plain_ && shift_ > 0;
  return result;
}

Conversion Conversion::shifted(double amount) const {
  Conversion result = *this;
  result.offset_ += amount;
  return result;
}

}  // namespace cia402::drive
