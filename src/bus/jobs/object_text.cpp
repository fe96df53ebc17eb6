// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/object_text.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <sstream>

#include "common/text.h"
#include "decode/value_text.h"
#include "drive/profile/conversion.h"
#include "drive/profile/object_value.h"
#include "motion/joint.h"

namespace cia402::bus {
namespace {

using drive::ObjectSpec;
using fieldbus::Bytes;

bool isText(drive::DataType type) { return fieldbus::sizeBits(type) == 0; }

bool isPrintable(const Bytes& data) {
  return !data.empty() && std::all_of(data.begin(), data.end(),
                                      [](std::uint8_t byte) { return std::isprint(byte) != 0; });
}

/// "37 06"; "nothing" where there is none.
std::string bytesOf(const Bytes& data) {
  return data.empty() ? "nothing" : hexBytes(data.data(), data.size());
}

/// What it means is not guessed: two bytes may be a number with or without a sign, or a text.
ObjectText describeUnlisted(const Bytes& data) {
  ObjectText text;
  const bool long_text = data.size() > 8 && isPrintable(data);
  text.value = long_text ? textOf(data) : bytesOf(data);
  if (data.empty()) return text;
  text.value += std::string(" (") +
                (data.size() == 1 ? "1 byte" : std::to_string(data.size()) + " bytes") +
                (isPrintable(data) && !long_text ? ", as text " + textOf(data) : "") +
                "; its type is not known: give it behind the object, e.g. " +
                (long_text ? "text, bytes)" : "u16, i32, f32, text)");
  return text;
}

/// What whole numbers an object holds.
struct IntegerRange {
  std::int64_t lowest = 0;
  std::uint64_t highest = 0;          ///< of a decimal number
  std::uint64_t highest_pattern = 0;  ///< of a hexadecimal one: the bits as they are
  unsigned size = 0;                  ///< bytes
  std::string type;                   ///< for messages
};

IntegerRange rangeOf(drive::DataType type) {
  const unsigned bits = fieldbus::sizeBits(type);
  const std::uint64_t all = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  IntegerRange range;
  range.highest = fieldbus::isSigned(type) ? all >> 1 : all;
  range.lowest = fieldbus::isSigned(type) ? -static_cast<std::int64_t>(all >> 1) - 1 : 0;
  range.highest_pattern = all;
  range.size = bits == 1 ? 1 : bits / 8;
  range.type = fieldbus::toString(type);
  return range;
}

/// Whether the number has a sign is not known: both readings are taken.
IntegerRange rangeOfSize(unsigned size) {
  const std::uint64_t all = size >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << (8 * size)) - 1;
  return {-static_cast<std::int64_t>(all >> 1) - 1, all, all, size,
          std::to_string(size) + (size == 1 ? " byte" : " bytes")};
}

bool isHexadecimal(const std::string& value) {
  return value.size() > 2 && value[0] == '0' && std::tolower(value[1]) == 'x';
}

Result<Bytes> integerBytes(const std::string& value, const IntegerRange& range) {
  const bool negative = !value.empty() && value[0] == '-';
  const std::string digits = value.substr(negative ? 1 : 0);
  const bool hexadecimal = isHexadecimal(digits);
  char* end = nullptr;
  errno = 0;
  const std::uint64_t magnitude = std::strtoull(digits.c_str(), &end, hexadecimal ? 16 : 10);
  if (digits.empty() || *end != '\0' || std::isdigit(static_cast<unsigned char>(digits[0])) == 0) {
    return Error{"\"" + value + "\" is not a whole number; write e.g. -5 or 0x1A"};
  }
  const std::uint64_t raw = negative ? ~magnitude + 1 : magnitude;
  const std::uint64_t lowest = ~static_cast<std::uint64_t>(range.lowest) + 1;  // its magnitude
  const std::uint64_t highest = hexadecimal ? range.highest_pattern : range.highest;
  if (errno != 0 || magnitude > (negative ? lowest : highest)) {
    return Error{value + " does not fit " + range.type + " (" + std::to_string(range.lowest) +
                 ".." + std::to_string(range.highest) + ")"};
  }
  return fieldbus::toBytes(raw & range.highest_pattern, range.size);
}

/// "01 2A FF".
Result<Bytes> bytesFrom(const std::string& value) {
  Bytes bytes;
  std::istringstream words(value);
  for (std::string word; words >> word;) {
    const bool pair = word.size() == 2 && std::isxdigit(static_cast<unsigned char>(word[0])) != 0 &&
                      std::isxdigit(static_cast<unsigned char>(word[1])) != 0;
    if (!pair) {
      return Error{"\"" + value + "\" is no row of bytes; write e.g. 01 2A FF"};
    }
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
  }
  if (bytes.empty()) return Error{"there is no byte to write; write e.g. 01 2A FF"};
  return bytes;
}

/// A number, or its bits in hexadecimal.
Result<Bytes> floatBytes(const std::string& value, const ObjectSpec& spec) {
  const unsigned size = fieldbus::sizeBits(spec.type) / 8;
  if (isHexadecimal(value)) {
    const Result<Bytes> bits = integerBytes(value, rangeOfSize(size));
    if (!bits) return bits;
    const std::uint64_t raw = fieldbus::toUnsigned(*bits);
    const auto finite = drive::sendable(spec.type, spec.encoding, raw);
    if (!finite) return Error{drive::notFinite(spec.type, raw)};
    return fieldbus::toBytes(*finite, size);
  }
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (value.empty() || end == nullptr || *end != '\0') {
    return Error{"\"" + value + "\" is not a number; write e.g. -1.5"};
  }
  const auto bits = drive::floatBits(spec.type, spec.encoding, number);
  if (!bits) {
    return Error{value +
                 " cannot be sent: it is no finite number that fits the object; write e.g. "
                 "-1.5"};
  }
  return fieldbus::toBytes(*bits, size);
}

}  // namespace

std::string textOf(const Bytes& data) {
  return isPrintable(data) ? "\"" + std::string(data.begin(), data.end()) + "\"" : bytesOf(data);
}

std::string inJointUnits(const ObjectSpec& spec, const drive::AxisConfig& axis, const Bytes& data) {
  const char* unit = decode::unitOf(spec.quantity, axis);
  if (unit == nullptr || data.size() * 8 != fieldbus::sizeBits(spec.type)) return {};
  const auto joint = drive::Conversion::create(spec, *axis.profile, axis.geometry);
  if (!joint) return {};
  return motion::formatNumber(joint->toJoint(fieldbus::toUnsigned(data))) + " " + unit;
}

ObjectText describeObject(const ObjectSpec* spec, const drive::AxisConfig& axis,
                          const Bytes& data) {
  if (spec == nullptr) return describeUnlisted(data);
  const unsigned bits = fieldbus::sizeBits(spec->type);
  ObjectText text;
  if (isText(spec->type)) {
    const bool visible = spec->type == drive::DataType::visible_string;
    const bool octets = spec->type == drive::DataType::octet_string;
    text.value = octets ? bytesOf(data) : textOf(visible ? decode::unpadded(data) : data);
    return text;
  }
  if (data.size() * 8 != (bits == 1 ? 8 : bits)) {
    text.value = textOf(data) + " (" + std::to_string(data.size()) +
                 " bytes, but the profile says " + fieldbus::toString(spec->type) + ")";
    return text;
  }
  const std::uint64_t raw = fieldbus::toUnsigned(data);
  if (drive::holdsFloat(spec->type, spec->encoding)) {
    text.number = drive::floatOf(spec->type, spec->encoding, raw);
    text.value = motion::formatNumber(text.number);
  } else {
    const bool with_sign = fieldbus::isSigned(spec->type);
    const std::int64_t number = fieldbus::toSigned(raw, bits);
    text.number = with_sign ? static_cast<double>(number) : static_cast<double>(raw);
    text.value = (with_sign ? std::to_string(number) : std::to_string(raw)) + " (" +
                 hexText(raw, static_cast<int>(2 * data.size())) + ")";
  }
  const std::string joint = inJointUnits(*spec, axis, data);
  if (!joint.empty()) text.value += " = " + joint;
  const std::string inputs = drive::activeInputs(*axis.profile, *spec, raw);
  if (!inputs.empty()) text.value += ": " + inputs;
  const std::string word =
      drive::textOf(spec->words, fieldbus::isSigned(spec->type) ? fieldbus::toSigned(raw, bits)
                                                                : static_cast<std::int64_t>(raw));
  if (!word.empty()) text.value += ": " + word;
  const auto fields = axis.profile->bit_fields.find(spec->fields);
  if (fields != axis.profile->bit_fields.end()) {
    text.value += ": " + drive::fieldsText(fields->second, raw);
  }
  return text;
}

Result<Bytes> encodeObject(const ObjectSpec& spec, const std::string& value) {
  if (spec.type == drive::DataType::octet_string) return bytesFrom(value);
  if (isText(spec.type)) return Bytes(value.begin(), value.end());
  const Result<Bytes> bytes = drive::holdsFloat(spec.type, spec.encoding)
                                  ? floatBytes(value, spec)
                                  : integerBytes(value, rangeOf(spec.type));
  if (bytes && !spec.takes(fieldbus::toUnsigned(*bytes))) {
    return Error{spec.name + " (" + fieldbus::toString(spec.id) + ") takes " + spec.rangeText() +
                 " in the drive's own numbers, not " + value};
  }
  return bytes;
}

Result<Bytes> encodeUnlisted(const std::string& value, std::size_t size) {
  if (size == 0 || size > 8) return Bytes(value.begin(), value.end());
  return integerBytes(value, rangeOfSize(static_cast<unsigned>(size)));
}

}  // namespace cia402::bus
