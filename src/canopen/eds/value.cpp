// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/value.h"

#include <cmath>
#include <cstring>
#include <locale>
#include <sstream>

#include "canopen/eds/problems.h"
#include "canopen/eds/strings.h"

namespace cia402::canopen {
namespace {

constexpr std::string_view kNodeId = "$nodeid";

int digitOf(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return 99;
}

std::optional<std::uint64_t> parseDigits(std::string_view digits, unsigned base) {
  if (digits.empty()) return {};
  std::uint64_t value = 0;
  for (char c : digits) {
    const auto digit = static_cast<unsigned>(digitOf(c));
    if (digit >= base || value > (~std::uint64_t{0} - digit) / base) return {};
    value = value * base + digit;
  }
  return value;
}

bool startsWithHex(std::string_view text) {
  return text.size() > 1 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
}

std::uint64_t maskOf(unsigned bits) { return ~std::uint64_t{0} >> (64 - bits); }

ObjectValue bytesOf(std::uint64_t raw, DataType type) {
  ObjectValue bytes;
  for (unsigned bit = 0; bit < sizeBits(type); bit += 8) {
    bytes.push_back(static_cast<std::uint8_t>(raw >> bit));
  }
  return bytes;
}

std::string rangeText(DataType type) {
  const unsigned bits = sizeBits(type);
  const std::uint64_t all = maskOf(bits);
  if (!isSigned(type)) return "0.." + std::to_string(all);
  return "-" + std::to_string((all >> 1U) + 1) + ".." + std::to_string(all >> 1U);
}

EdsValue failed(std::string why) {
  EdsValue value;
  value.error = std::move(why);
  return value;
}

EdsValue taken(std::uint64_t raw, DataType type, std::string note) {
  EdsValue value;
  value.bytes = bytesOf(raw, type);
  value.note = std::move(note);
  return value;
}

EdsValue doesNotFit(std::string_view text, DataType type) {
  return failed(quoteEds(text) + " does not fit " + toString(type) + " (" + rangeText(type) + ")");
}

// A number that only fits if its bits are meant: 0xFFFF8000 or 65535 for an int16.
EdsValue signedPattern(std::string_view text, const EdsNumber& number, DataType type) {
  const unsigned bits = sizeBits(type);
  const std::uint64_t mask = maskOf(bits);
  if (number.negative) return doesNotFit(text, type);
  const std::uint64_t above = number.magnitude & ~mask;
  const bool extended = (above == (maskOf(32) & ~mask) || above == ~mask) &&
                        (number.magnitude >> (bits - 1) & 1U) != 0;
  if (above != 0 && !extended) return doesNotFit(text, type);
  const ObjectValue bytes = bytesOf(number.magnitude & mask, type);
  if (above == 0 && number.pattern) return taken(number.magnitude, type, number.note);
  return taken(number.magnitude & mask, type,
               quoteEds(text) + " is taken as " + describeValue(type, bytes) + ", the " +
                   toString(type) + " of these bits");
}

EdsValue integerValue(std::string_view text, const EdsNumber& number, DataType type) {
  const std::uint64_t mask = maskOf(sizeBits(type));
  if (!isSigned(type)) {
    if (number.negative && number.magnitude != 0) {
      return failed(quoteEds(text) + " is negative, but the type is " + toString(type));
    }
    if (number.magnitude > mask) return doesNotFit(text, type);
    return taken(number.magnitude, type, number.note);
  }
  const std::uint64_t highest = mask >> 1U;
  if (number.magnitude > highest + (number.negative ? 1 : 0)) {
    return signedPattern(text, number, type);
  }
  const std::uint64_t raw = number.negative ? ~number.magnitude + 1 : number.magnitude;
  return taken(raw & mask, type, number.note);
}

// "true" and "0.0" where a whole number should stand.
std::optional<EdsNumber> oddNumber(std::string_view text, DataType type) {
  EdsNumber number;
  const std::string word = nameKey(text);
  if (type == DataType::boolean && (word == "true" || word == "false")) {
    number.magnitude = word == "true" ? 1 : 0;
    number.note = quoteEds(text) + " should be " + (word == "true" ? "1" : "0");
    return number;
  }
  const std::optional<double> real = parseEdsReal(text);
  if (!real || *real != std::floor(*real) || std::abs(*real) > 9e15) return {};
  number.negative = *real < 0.0;
  number.magnitude = static_cast<std::uint64_t>(std::abs(*real));
  number.note = quoteEds(text) + " should be a whole number, as the type is " + toString(type);
  return number;
}

EdsValue plainInteger(std::string_view text, DataType type) {
  std::optional<EdsNumber> number = parseEdsNumber(text);
  if (!number) number = oddNumber(text, type);
  if (!number) {
    return failed(quoteEds(text) + " is no whole number, but the type is " + toString(type));
  }
  return integerValue(text, *number, type);
}

EdsValue formula(std::string_view text, std::size_t at, DataType type, NodeId node_id) {
  const EdsValue wrong = failed(quoteEds(text) + " is no formula; write for example $NODEID+0x180");
  std::string_view before = trimmed(text.substr(0, at));
  std::string_view after = trimmed(text.substr(at + kNodeId.size()));
  if (!before.empty()) {
    if (before.back() != '+') return wrong;
    before = trimmed(before.substr(0, before.size() - 1));
  }
  if (!after.empty()) {
    if (after.front() != '+') return wrong;
    after = trimmed(after.substr(1));
    if (after.empty()) return wrong;
  }
  if ((!before.empty() && !after.empty()) || (before.empty() && at != 0)) return wrong;
  EdsNumber number;
  if (!before.empty() || !after.empty()) {
    const auto offset = parseEdsNumber(before.empty() ? after : before);
    if (!offset || offset->negative) return wrong;
    number = *offset;
  }
  if (number.magnitude > maskOf(64) - node_id) return doesNotFit(text, type);
  number.magnitude += node_id;
  EdsValue value = integerValue(text, number, type);
  value.adds_node_id = true;
  return value;
}

EdsValue integerText(std::string_view text, DataType type, NodeId node_id) {
  std::string lower;
  for (char c : text) lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  const std::size_t at = lower.find(kNodeId);
  return at == std::string::npos ? plainInteger(text, type) : formula(text, at, type, node_id);
}

std::uint64_t patternOf(double number, DataType type) {
  std::uint64_t pattern = 0;
  if (type == DataType::real32) {
    const auto narrow = static_cast<float>(number);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &narrow, sizeof bits);
    return bits;
  }
  std::memcpy(&pattern, &number, sizeof pattern);
  return pattern;
}

EdsValue realText(std::string_view text, DataType type) {
  if (startsWithHex(text)) {
    const auto bits = parseDigits(text.substr(2), 16);
    if (bits && (*bits == 0 || text.size() == 2 + sizeBits(type) / 4))
      return taken(*bits, type, {});
    return failed(quoteEds(text) + " is neither a number like 1.5 nor all " +
                  std::to_string(sizeBits(type) / 4) + " digits of the bits of a " +
                  toString(type));
  }
  std::string plain(text);
  std::string note;
  const std::size_t comma = plain.find(',');
  if (comma != std::string::npos && plain.find('.') == std::string::npos) {
    plain[comma] = '.';
    note = quoteEds(text) + " should have a point, not a comma";
  }
  const std::optional<double> number = parseEdsReal(plain);
  if (!number) return failed(quoteEds(text) + " is no number, but the type is " + toString(type));
  if (type == DataType::real32 && !std::isfinite(static_cast<float>(*number))) {
    return failed(quoteEds(text) + " does not fit real32");
  }
  return taken(patternOf(*number, type), type, note);
}

}  // namespace

std::optional<EdsNumber> parseEdsNumber(std::string_view text) {
  const std::string_view whole = text = trimmed(text);
  EdsNumber number;
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) {
    number.negative = text[0] == '-';
    text = trimmed(text.substr(1));
  }
  std::optional<std::uint64_t> magnitude;
  if (startsWithHex(text)) {
    magnitude = parseDigits(text.substr(2), 16);
    number.pattern = true;
  } else if (!text.empty() && (text.back() == 'h' || text.back() == 'H')) {
    magnitude = parseDigits(text.substr(0, text.size() - 1), 16);
    number.pattern = true;
    number.note =
        quoteEds(whole) + " should be written 0x" + std::string(text.substr(0, text.size() - 1));
  } else {
    magnitude = parseDigits(text, 10);
    const bool leading_zero = text.size() > 1 && text[0] == '0';
    const auto octal = leading_zero ? parseDigits(text, 8) : std::nullopt;
    if (octal && magnitude && *octal != *magnitude) {
      number.note = quoteEds(whole) + " is octal, " + std::to_string(*octal);
      number.pattern = true;
    } else if (leading_zero && magnitude && !octal) {
      number.note = quoteEds(whole) + " begins with 0, but is no octal number; read as decimal";
    }
    if (octal) magnitude = octal;
  }
  if (!magnitude) return {};
  number.magnitude = *magnitude;
  return number;
}

std::optional<double> parseEdsReal(std::string_view text) {
  for (char c : text) {
    const bool known =
        (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
    if (!known) return {};
  }
  std::istringstream stream{std::string(text)};
  stream.imbue(std::locale::classic());
  double number = 0.0;
  stream >> number;
  if (stream.fail() || stream.peek() != std::istringstream::traits_type::eof()) return {};
  if (!std::isfinite(number)) return {};
  return number;
}

EdsValue parseEdsValue(std::string_view text, DataType type, NodeId node_id) {
  switch (type) {
    case DataType::real32:
    case DataType::real64:
      return realText(text, type);
    case DataType::visible_string:
    case DataType::octet_string:
    case DataType::unicode_string:
    case DataType::domain:
      return stringText(text, type);
    default:
      return integerText(text, type, node_id);
  }
}

std::optional<std::string> formatEdsValue(const ObjectValue& value, DataType type) {
  const unsigned bits = sizeBits(type);
  if (bits == 0) return formatString(value, type);
  if (value.size() != (bits + 7) / 8) return {};
  if (type == DataType::boolean && value[0] > 1) return {};
  const bool real = type == DataType::real32 || type == DataType::real64;
  if (isSigned(type) && !real) return describeValue(type, value);
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (real && std::isfinite(realOf(value))) {
    text.precision(type == DataType::real32 ? 9 : 17);
    text << realOf(value);
    return text.str();
  }
  std::uint64_t raw = 0;
  for (std::size_t i = value.size(); i-- > 0;) raw = raw << 8U | value[i];
  text << "0x" << std::hex << std::uppercase;
  text.width(static_cast<std::streamsize>(2 * value.size()));
  text.fill('0');
  text << raw;
  return text.str();
}

}  // namespace cia402::canopen
