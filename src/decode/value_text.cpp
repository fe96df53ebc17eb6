// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/value_text.h"

#include <algorithm>
#include <cctype>

#include "common/text.h"
#include "decode/object_names.h"
#include "drive/profile/fault_text.h"
#include "drive/profile/object_value.h"

namespace cia402::decode {
namespace {

using drive::ObjectSpec;
using drive::Quantity;
using fieldbus::Bytes;
using fieldbus::ObjectId;

constexpr std::size_t kLongestBytes = 32;

/// Without knowledge of what it means: decimal and hexadecimal.
std::string plain(std::uint64_t raw, unsigned bits, bool is_signed) {
  const std::string decimal =
      is_signed ? std::to_string(fieldbus::toSigned(raw, bits)) : std::to_string(raw);
  return raw < 10 && !is_signed
             ? decimal
             : decimal + " (" + hexText(raw, static_cast<int>((bits + 7) / 8 * 2)) + ")";
}

bool isWhole(const ObjectSpec& spec) { return !drive::holdsFloat(spec.type, spec.encoding); }

}  // namespace

const char* unitOf(Quantity quantity, const drive::AxisConfig& axis) {
  const bool linear = axis.geometry.prismatic();
  switch (quantity) {
    case Quantity::position:
    case Quantity::distance:
      return linear ? "m" : "rad";
    case Quantity::velocity:
      return linear ? "m/s" : "rad/s";
    case Quantity::acceleration:
      return linear ? "m/s^2" : "rad/s^2";
    case Quantity::jerk:
      return linear ? "m/s^3" : "rad/s^3";
    case Quantity::torque:
      return linear ? "N" : "N m";
    case Quantity::current:
      return "A";
    case Quantity::voltage:
      return "V";
    case Quantity::temperature:
      return "degC";
    case Quantity::time:
      return "s";
    case Quantity::none:
      break;
  }
  return nullptr;
}

Bytes unpadded(Bytes data) {
  while (data.size() > 1 && data.back() == 0) data.pop_back();
  return data;
}

std::string bytesText(const Bytes& data) {
  if (data.empty()) return "nothing";
  const bool cut = data.size() > kLongestBytes;
  const auto end = data.begin() + static_cast<std::ptrdiff_t>(cut ? kLongestBytes : data.size());
  const bool printable =
      std::all_of(data.begin(), end, [](std::uint8_t byte) { return std::isprint(byte) != 0; });
  const std::string text =
      printable ? "\"" + std::string(data.begin(), end) + "\""
                : hexBytes(data.data(), static_cast<std::size_t>(end - data.begin()));
  return text + (cut ? "..." : "");
}

ValueText::ValueText(const drive::AxisConfig& axis) : axis_(axis) {
  if (!axis_.profile) return;
  for (const ObjectSpec& spec : axis_.profile->objects) {
    Known known;
    known.spec = &spec;
    known.unit = unitOf(spec.quantity, axis_);
    const auto conversion = drive::Conversion::create(spec, *axis_.profile, axis_.geometry);
    if (conversion) known.conversion = *conversion;
    objects_.emplace(spec.id, known);
  }
}

const ValueText::Known* ValueText::find(ObjectId object) const {
  const auto found = objects_.find(object);
  return found == objects_.end() ? nullptr : &found->second;
}

std::string ValueText::name(ObjectId object) const {
  const Known* known = find(object);
  return known != nullptr ? known->spec->name : communicationObjectName(object);
}

std::string ValueText::title(ObjectId object) const {
  const std::string words = name(object);
  return fieldbus::toString(object) + (words.empty() ? "" : " " + words);
}

void ValueText::note(ObjectId object, std::uint64_t raw) {
  const Known* known = find(object);
  if (known == nullptr || known->spec->name != "mode_display") return;
  const auto value = fieldbus::toSigned(raw, fieldbus::sizeBits(known->spec->type));
  mode_ = nullptr;
  for (const drive::ModeSpec& mode : axis_.profile->modes) {
    if (mode.value == value) mode_ = &mode;
  }
}

std::string ValueText::words(const Known& known, std::uint64_t raw, unsigned bits) const {
  const std::string& name = known.spec->name;
  const auto word = static_cast<std::uint16_t>(raw);
  if (name == "statusword") return statuswordText(word, mode_, axis_.profile->status_words);
  if (name == "controlword") return controlwordText(word, mode_);
  if (name == "error_code") return errorText(word, *axis_.profile);
  if (name == "mode_display" || name == "mode_of_operation") {
    return modeText(static_cast<int>(fieldbus::toSigned(raw, bits)), *axis_.profile);
  }
  const bool whole = isWhole(*known.spec);
  if (known.conversion && (known.unit != nullptr || !whole)) {
    const std::string value = numberText(known.conversion->toJoint(raw));
    const std::string device = !whole || known.conversion->resolution() == 1.0
                                   ? ""
                                   : " (" +
                                         (fieldbus::isSigned(known.spec->type)
                                              ? std::to_string(fieldbus::toSigned(raw, bits))
                                              : std::to_string(raw)) +
                                         ")";
    return value + (known.unit != nullptr ? std::string(" ") + known.unit : "") + device;
  }
  return plain(raw, bits, fieldbus::isSigned(known.spec->type));
}

/// Of an object that nothing names: a float where its place says so.
std::string ValueText::unnamed(ObjectId object, std::uint64_t raw, unsigned bits) const {
  const auto spec =
      axis_.profile && bits % 8 == 0 ? axis_.profile->unnamedFloat(object, bits / 8) : std::nullopt;
  return spec ? numberText(drive::floatOf(spec->type, spec->encoding, raw))
              : plain(raw, bits, false);
}

std::string ValueText::describe(ObjectId object, std::uint64_t raw, unsigned bits) const {
  const Known* known = find(object);
  if (known == nullptr) return unnamed(object, raw, bits);
  const unsigned expected = fieldbus::sizeBits(known->spec->type);
  if (expected != bits) return plain(raw, bits, false);
  return words(*known, raw, bits);
}

std::string ValueText::describe(ObjectId object, const Bytes& data) const {
  const Known* known = find(object);
  const unsigned bits = known == nullptr ? 0 : fieldbus::sizeBits(known->spec->type);
  const auto size = static_cast<unsigned>(data.size());
  if (known == nullptr && fieldbus::isStandardText(object)) return bytesText(unpadded(data));
  if (known == nullptr) {
    return size == 0 || size == 3 || size > 4
               ? bytesText(data)
               : unnamed(object, fieldbus::toUnsigned(data), 8 * size);
  }
  if (bits == 0) return bytesText(data);
  if ((bits + 7) / 8 != size) {
    return bytesText(data) + " (" + std::to_string(size) + " bytes, but the profile says " +
           fieldbus::toString(known->spec->type) + ")";
  }
  return words(*known, fieldbus::toUnsigned(data), bits);
}

std::string modeText(int value, const drive::DriveProfile& profile) {
  for (const drive::ModeSpec& mode : profile.modes) {
    if (mode.value == value) return std::to_string(value) + " " + mode.name;
  }
  return std::to_string(value) + (value == 0 ? " no mode" : " unknown to the profile");
}

std::string errorText(std::uint16_t code, const drive::DriveProfile& profile) {
  if (code == 0) return "0x0000 none";
  return hexText(code, 4) + " " + drive::errorName(profile, code);
}

}  // namespace cia402::decode
