// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/named_write.h"

#include <cmath>
#include <limits>

#include "common/text.h"
#include "drive/profile/object_value.h"
#include "fieldbus/bytes.h"

namespace cia402::drive {
namespace {

constexpr char kHold[] = "quick_stop.hold";

// What a write puts into the object: an SI value, a raw number, or a copy.
struct Source {
  std::optional<double> value;
  std::optional<std::int64_t> raw;
  std::optional<ObjectId> copied_from;
};

std::optional<double> limit(const std::string& name, const motion::JointLimits& limits,
                            bool reversed) {
  if (name == "limits.lower") return reversed ? limits.upper : limits.lower;
  if (name == "limits.upper") return reversed ? limits.lower : limits.upper;
  if (name == "limits.velocity") return limits.velocity;
  if (name == "limits.acceleration") return limits.acceleration;
  if (name == "limits.jerk") return limits.jerk;
  if (name == "limits.effort") return limits.effort;
  return {};
}

// An option that is 0 was not configured; the offset counts always, as 0 by default.
std::optional<double> homing(const std::string& name, const HomingOptions& options) {
  const auto positive = [](double v) { return v > 0.0 ? std::optional<double>(v) : std::nullopt; };
  if (name == "homing.search_velocity") return positive(options.search_velocity);
  if (name == "homing.zero_velocity") return positive(options.zero_velocity);
  if (name == "homing.acceleration") return positive(options.acceleration);
  if (name == "homing.timeout") return toSeconds(options.timeout);
  if (name == "homing.offset") return options.atHome();
  if (name == "homing.timeout") return toSeconds(options.timeout);
  return {};
}

/// Is it an option of the axis' `homing` section that it has?
bool asksForHoming(const std::string& from, const AxisConfig& axis) {
  if (!axis.homing) return false;
  if (from == "homing.offset") return axis.homing->offset.has_value();
  return from == "homing.method" || homing(from, *axis.homing).has_value();
}

Source configured(const NamedWrite& write, const AxisConfig& axis, bool reversed) {
  Source source;
  const std::string& from = write.from;
  if (const auto value = limit(from, axis.limits, reversed)) {
    source.value = *value * write.times;
  } else if (from == "sync_period.value" || from == "sync_period.exponent") {
    const auto period = interpolationPeriod(axis.cycle);
    if (period) source.raw = from == "sync_period.value" ? int{period->value} : period->exponent;
  } else if (from == "sync_period.ms") {
    source.raw = axis.cycle / std::chrono::milliseconds(1);
  } else if (from == kHold) {
    if (axis.quick_stop_holds) source.raw = axis.profile->quick_stop_holds.front();
  } else if (axis.homing && from == "homing.method") {
    source.raw = axis.homing->method;
  } else if (axis.homing && homing(from, *axis.homing)) {
    source.value = *homing(from, *axis.homing) * write.times;
  } else if (const ObjectSpec* object = axis.profile->find(from)) {
    source.copied_from = object->id;
  }
  return source;
}

bool reverses(const ObjectSpec& object, const AxisConfig& axis) {
  return (axis.geometry.direction < 0) != (object.factor < 0.0);
}

Error refuse(const AxisConfig& axis, const std::string& name, const std::string& why) {
  return Error{whoIs(axis) + ": " + name + ": " + why};
}

// Velocities, accelerations and efforts of the configuration are magnitudes: the drive gets them
// positive whatever the axis' direction.
bool isMagnitude(const NamedWrite& write) {
  return !write.from.empty() && write.from != "limits.lower" && write.from != "limits.upper" &&
         write.from != "homing.offset";
}

Result<std::uint64_t> encode(const NamedWrite& write, double value, const Conversion& conversion,
                             const AxisConfig& axis, const std::string& name) {
  if (std::isinf(value)) return conversion.mostRaw();
  const double wanted = isMagnitude(write) && conversion.reversed() ? -value : value;
  std::uint64_t raw = 0;
  if (conversion.toDevice(wanted, raw)) return raw;
  return refuse(axis, name,
                numberText(value) + " does not fit; the object holds " +
                    numberText(conversion.lowest()) + " to " + numberText(conversion.highest()));
}

std::uint64_t masked(std::int64_t value, DataType type) {
  const unsigned bits = fieldbus::sizeBits(type);
  return static_cast<std::uint64_t>(value) & (~std::uint64_t{0} >> (64 - bits));
}

bool fits(std::int64_t value, DataType type) {
  const unsigned bits = fieldbus::sizeBits(type);
  if (bits >= 64) return true;
  const std::int64_t span = std::int64_t{1} << bits;
  const std::int64_t low = fieldbus::isSigned(type) ? -(span / 2) : 0;
  return value >= low && value < low + span;
}

// Access, length and limits as the EDS tells them.
Result<void> checkAgainstEds(const ResolvedWrite& write, const AxisConfig& axis) {
  const fieldbus::DictionaryEntry* entry =
      axis.description != nullptr ? axis.description->dictionary.find(write.object) : nullptr;
  if (entry == nullptr || write.copied_from) return {};
  return fieldbus::checkWrite(*entry, wireBytes(write.raw, write.type), axis.description->file);
}

// The number that limits nothing: as far as the object goes, or as the EDS lets it.
std::uint64_t widest(const ResolvedWrite& write, const Conversion& conversion,
                     const AxisConfig& axis, bool low) {
  const fieldbus::DictionaryEntry* entry =
      axis.description != nullptr ? axis.description->dictionary.find(write.object) : nullptr;
  const auto* bound = entry == nullptr ? nullptr : low ? &entry->low : &entry->high;
  const auto number = bound != nullptr && *bound
                          ? sendable(write.type, axis.profile->encodingOf(write.object, write.type),
                                     fieldbus::toUnsigned(**bound))
                          : std::nullopt;
  if (number) return *number;
  return low ? conversion.lowestRaw() : conversion.highestRaw();
}

// A number of the drive's own, as wide as the object.
Result<void> takeRaw(const NamedWrite& write, std::int64_t number, const ObjectSpec* object,
                     const AxisConfig& axis, ResolvedWrite& resolved) {
  const DataType type = resolved.type;
  if (!write.from.empty() && !fits(number, type)) {
    return refuse(axis, resolved.name,
                  std::to_string(number) + " (" + write.from + ") does not fit");
  }
  const std::uint64_t raw = masked(number, type);
  const auto finite = sendable(type, axis.profile->encodingOf(resolved.object, type), raw);
  if (!finite) return refuse(axis, resolved.name, notFinite(type, raw));
  resolved.raw = *finite;
  if (object == nullptr || object->takes(resolved.raw)) return {};
  return refuse(axis, resolved.name,
                std::to_string(number) + " does not fit; the object takes " + object->rangeText() +
                    " in the drive's own numbers");
}

}  // namespace

bool isGiven(const std::string& name, const AxisConfig& axis) {
  if (name.empty() || limit(name, axis.limits, false)) return true;
  if (name == kHold) return axis.quick_stop_holds;
  return name == "homing.method" ? axis.homing && axis.homing->method
                                 : axis.homing && homing(name, *axis.homing).has_value();
}

std::optional<InterpolationPeriod> interpolationPeriod(Duration period) {
  struct Unit {
    std::int8_t exponent;
    std::int64_t ns;
  };
  // Milliseconds first: some drives know no other exponent than -3, the default of 60C2h:02.
  constexpr Unit kUnits[] = {{-3, 1000000}, {0, 1000000000}, {-1, 100000000}, {-2, 10000000},
                             {-4, 100000},  {-5, 10000},     {-6, 1000}};
  for (const auto& [exponent, unit_ns] : kUnits) {
    const std::int64_t value = period.count() / unit_ns;
    if (period.count() % unit_ns != 0 || value < 1 || value > 255) continue;
    return InterpolationPeriod{static_cast<std::uint8_t>(value), exponent};
  }
  return {};
}

Result<std::optional<ResolvedWrite>> resolveWrite(const NamedWrite& write, const AxisConfig& axis) {
  using Resolved = std::optional<ResolvedWrite>;
  const ObjectSpec* object = findObject(*axis.profile, write.object);
  const auto id = object != nullptr ? std::optional<ObjectId>(object->id)
                                    : objectId(*axis.profile, write.object);
  const auto type = object != nullptr ? std::optional<DataType>(object->type) : write.type;
  if (!id || !type || fieldbus::sizeBits(*type) == 0) {
    return refuse(axis, write.object, sourceOf(*axis.profile) + " has no such number");
  }
  ResolvedWrite resolved;
  resolved.object = *id;
  resolved.type = *type;
  const bool hold = write.from == kHold && axis.quick_stop_holds;
  if (hold && axis.profile->quick_stop_holds.empty()) {
    return refuse(axis, write.object, "the profile names no value that holds (quick_stop_holds)");
  }
  resolved.optional = write.optional && !hold;  // what was asked for is done or told
  resolved.asked_for = hold || asksForHoming(write.from, axis);
  resolved.name =
      (object != nullptr ? object->name + " " : "") + "(" + fieldbus::toString(*id) + ")";

  if (!isGiven(write.if_given, axis)) return Resolved{};
  Source source;
  if (!write.from.empty()) {
    source = configured(write, axis, object != nullptr && reverses(*object, axis));
  }
  if (!source.value && !source.raw && !source.copied_from) {
    source.value = write.value;
    source.raw = write.raw;
  }
  if (source.copied_from) {
    resolved.copied_from = source.copied_from;
  } else if (source.raw) {
    if (const auto done = takeRaw(write, *source.raw, object, axis, resolved); !done) {
      return done.error();
    }
  } else if (source.value && object != nullptr) {
    const auto conversion = Conversion::create(*object, *axis.profile, axis.geometry);
    if (!conversion && write.optional) return Resolved{};
    if (!conversion) return refuse(axis, resolved.name, conversion.error().message);
    const auto raw = encode(write, *source.value, *conversion, axis, resolved.name);
    if (!raw) return raw.error();
    const bool negative = write.from == "homing.offset" && axis.homing->offset_shifts_zero;
    resolved.raw = negative ? negated(*raw, resolved.type) : *raw;
  } else {
    return Resolved{};
  }
  if (const auto allowed = checkAgainstEds(resolved, axis); !allowed) {
    return refuse(axis, resolved.name, allowed.error().message);
  }
  return Resolved{resolved};
}

Result<std::optional<ResolvedLimit>> resolveLimit(const NamedWrite& write, const AxisConfig& axis) {
  using Limit = std::optional<ResolvedLimit>;
  const auto resolved = resolveWrite(write, axis);
  if (!resolved) return resolved.error();
  const ObjectSpec* object = findObject(*axis.profile, write.object);
  if (!*resolved || object == nullptr) return Limit{};
  const auto conversion = Conversion::create(*object, *axis.profile, axis.geometry);
  const bool smaller_number = write.from == "limits.lower";
  const auto value = limit(write.from, axis.limits, reverses(*object, axis));
  if (!conversion || !value) return Limit{};
  ResolvedLimit result;
  result.write = **resolved;
  result.conversion = *conversion;
  result.value = *value * write.times;
  result.lower = smaller_number != conversion->reversed();
  result.open = widest(result.write, *conversion, axis, smaller_number);
  return Limit{result};
}

std::uint64_t negated(std::uint64_t raw, DataType type) {
  return masked(-fieldbus::toSigned(raw, fieldbus::sizeBits(type)), type);
}

std::vector<std::uint8_t> wireBytes(std::uint64_t raw, DataType type) {
  std::vector<std::uint8_t> bytes;
  for (unsigned bit = 0; bit < fieldbus::sizeBits(type); bit += 8) {
    bytes.push_back(static_cast<std::uint8_t>(raw >> bit));
  }
  return bytes;
}

}  // namespace cia402::drive
