// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/absolute_encoder.h"

#include <cmath>
#include <utility>

namespace cia402::sim {
namespace {

constexpr double kMostTurns = 65535.0;  // that its counter holds
constexpr std::uint64_t kResetsTurns = 2;
constexpr unsigned kStateBits = 0x4F, kNotReady = 0x00;  // of the statusword; so without power, too

std::uint64_t countsOf(double value) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::llround(value)));
}

}  // namespace

AbsoluteEncoder::AbsoluteEncoder(const DriveDefinition& definition, ObjectDictionary& dictionary,
                                 DriveCore& core)
    : encoder_(definition.absolute),
      overflow_(definition.fault("turns_overflow")),
      battery_(definition.fault(encoder_.battery_fault)),
      low_battery_(definition.fault("battery_warning")),
      dictionary_(dictionary),
      core_(core) {
  const auto object = [&](Role role) {
    const auto found = definition.objects.find(role);
    return found == definition.objects.end() ? Object() : Object(found->second);
  };
  gear_numerator_ = object(Role::gear_numerator);
  gear_denominator_ = object(Role::gear_denominator);
  if (encoder_.counts != 0) showAll();
}

/// Each object is brought up to date when it is read.
template <typename Number>
void AbsoluteEncoder::show(const Object& object, Number number) {
  if (!object) return;
  dictionary_.onRead(*object, [number](Entry& entry) {
    const unsigned bits = widthBits(entry.type);
    entry.number = number() & (bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1);
    return 0U;
  });
}

template <typename Number>
void AbsoluteEncoder::show(const AbsoluteEncoderDefinition::Wide& objects, Number number) {
  show(objects.low, number);
  show(objects.high, [number] { return number() >> 32U; });
}

void AbsoluteEncoder::showAll() {
  const auto counts = static_cast<double>(encoder_.counts);
  show(encoder_.turns, [this] { return countsOf(std::floor(turned())); });
  show(encoder_.single_turn,
       [this, counts] { return countsOf((turned() - std::floor(turned())) * counts); });
  show(encoder_.encoder, [this, counts] { return countsOf(turned() * counts); });
  show(encoder_.mechanical, [this, counts] { return countsOf(core_.motion().counter() * counts); });
  show(encoder_.rotary, [this] { return countsOf(rotary()); });
  show(encoder_.rotary_units, [this] { return countsOf(std::floor(rotary() / countsPerUnit())); });
  show(encoder_.overflows,
       [this] { return countsOf(std::trunc(std::floor(turned()) / (kMostTurns + 1.0))); });
}

double AbsoluteEncoder::number(const Object& object, double fallback) const {
  const Entry* entry = object ? dictionary_.find(*object) : nullptr;
  return entry == nullptr ? fallback : static_cast<double>(entry->acting());
}

double AbsoluteEncoder::wide(const AbsoluteEncoderDefinition::Wide& objects) const {
  return number(objects.low, 0.0) + std::ldexp(number(objects.high, 0.0), 32);
}

EncoderKind AbsoluteEncoder::kind() const {
  const auto index = static_cast<std::size_t>(number(encoder_.system, 0.0));
  return index < encoder_.kinds.size() ? encoder_.kinds[index] : EncoderKind::absolute;
}

double AbsoluteEncoder::turned() const { return core_.motion().motor().truePosition() - zero_; }

double AbsoluteEncoder::rotary() const {
  const auto counts = static_cast<double>(encoder_.counts);
  const double given = wide(encoder_.load_counts);
  const double gear = number(encoder_.load_gear.low, 1.0) / number(encoder_.load_gear.high, 1.0);
  const double load = given > 0.0 ? given : counts * gear;
  const double at = core_.motion().counter() * counts;
  return at - load * std::floor(at / load);
}

double AbsoluteEncoder::countsPerUnit() const {
  return number(gear_numerator_, 1.0) / number(gear_denominator_, 1.0);
}

bool AbsoluteEncoder::batteryLow() const {
  return battery_ != nullptr && low_battery_ != nullptr && core_.faults().has(*low_battery_);
}

/// What is left of its counter is where it stands in its turn.
void AbsoluteEncoder::forgetTurns() {
  const double whole = std::floor(turned());
  zero_ += whole;
  core_.motion().setCounter(core_.motion().motor().mirrored() ? -turned() : turned());
  core_.motion().setHomed(false);
  homed_ = told_ = false;
  core_.onObstacle();  // shows it
}

void AbsoluteEncoder::start(bool cold) {
  told_ = false;  // without power nothing could be told
  if (encoder_.counts == 0 || !cold) return;
  const EncoderKind known = kind();
  if (known == EncoderKind::incremental) {
    zero_ = core_.motion().motor().truePosition();
    return forgetTurns();
  }
  if (battery_low_ || known == EncoderKind::single_turn) {
    forgetTurns();
    battery_due_ = battery_low_ && known == EncoderKind::absolute;
    return;
  }
  core_.motion().setHomed(homed_);
  core_.onObstacle();
}

/// Faults are told once the drive has initialised itself.
void AbsoluteEncoder::lookAtTurns() {
  homed_ = core_.motion().homed();
  battery_low_ = batteryLow();
  if ((core_.statusword() & kStateBits) == kNotReady) return;
  if (std::exchange(battery_due_, false)) core_.raise(*battery_);
  const bool counts = kind() != EncoderKind::incremental;
  const bool beyond = counts && std::fabs(std::floor(turned())) > kMostTurns;
  if (!beyond) told_ = false;
  if (!beyond || told_ || overflow_ == nullptr || number(encoder_.overflow_masked, 0.0) != 0.0) {
    return;
  }
  told_ = true;
  core_.raise(*overflow_);
}

void AbsoluteEncoder::written(const Entry& entry) {
  if (holds(entry.id) && entry.number == kResetsTurns) forgetTurns();
}

}  // namespace cia402::sim
