// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/dictionary/value.h"

#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace cia402::sim {

namespace {

constexpr char kNodeId[] = "$NODEID";

bool isReal(DataType type) { return type == DataType::real32 || type == DataType::real64; }

bool isSignedInteger(DataType type) {
  return type == DataType::int8 || type == DataType::int16 || type == DataType::int24 ||
         type == DataType::int32 || type == DataType::int40 || type == DataType::int48 ||
         type == DataType::int56 || type == DataType::int64;
}

std::optional<std::int64_t> integerOf(const std::string& text) {
  if (text.empty() || text.find_first_of(" \t") != std::string::npos) return std::nullopt;
  const std::size_t digits = text[0] == '-' || text[0] == '+' ? 1 : 0;
  const bool hexadecimal = text.compare(digits, 2, "0x") == 0 || text.compare(digits, 2, "0X") == 0;
  if (digits == text.size() || text.find_first_of("+-", digits) != std::string::npos) {
    return std::nullopt;
  }
  errno = 0;
  char* end = nullptr;
  const std::uint64_t size = std::strtoull(text.c_str() + digits, &end, hexadecimal ? 16 : 10);
  if (errno != 0 || *end != '\0') return std::nullopt;
  if (text[0] != '-') return static_cast<std::int64_t>(size);
  constexpr std::uint64_t kLowest = std::uint64_t{1} << 63U;
  if (size > kLowest) return std::nullopt;
  return static_cast<std::int64_t>(std::uint64_t{0} - size);
}

std::optional<double> realOf(const std::string& text) {
  if (text.empty()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (*end != '\0') return std::nullopt;
  return value;
}

std::uint64_t bitPattern(double value, unsigned bits) {
  if (bits == 64) {
    std::uint64_t pattern = 0;
    std::memcpy(&pattern, &value, sizeof(pattern));
    return pattern;
  }
  const auto narrow = static_cast<float>(value);
  std::uint32_t pattern = 0;
  std::memcpy(&pattern, &narrow, sizeof(pattern));
  return pattern;
}

Result<DefaultValue> parseReal(const std::string& text, DataType type) {
  const unsigned bits = widthBits(type);
  const auto value = realOf(text);
  if (!value) return Error{"'" + text + "' is not a real number"};
  if (bits != 32 && bits != 64) return Error{"a real number needs a type of 32 or 64 bits"};
  DefaultValue result;
  result.number = bitPattern(*value, bits);
  return result;
}

Result<DefaultValue> parseNumber(std::string text, DataType type) {
  DefaultValue result;
  if (text.rfind(kNodeId, 0) == 0) {
    result.add_node_id = true;
    text.erase(0, std::strlen(kNodeId));
    if (!text.empty() && text[0] != '+') return Error{"expected '+' after $NODEID"};
    text = text.empty() ? "0" : text.substr(1);
  }
  if (text == "true" || text == "false") text = text == "true" ? "1" : "0";
  const auto value = integerOf(text);
  if (!value) return Error{"the default '" + text + "' is not a number"};
  if (!fits(*value, type)) {
    return Error{"the default " + text + " does not fit " + std::to_string(widthBits(type)) +
                 " bits"};
  }
  result.number = static_cast<std::uint64_t>(*value);
  return result;
}

}  // namespace

std::string textOf(const YAML::Node& node) { return node.IsScalar() ? node.Scalar() : ""; }

std::string hexId(ObjectId id) {
  char text[16];
  std::snprintf(text, sizeof(text), "0x%04X:%02X", static_cast<unsigned>(id.index),
                static_cast<unsigned>(id.subindex));
  return text;
}

std::optional<std::int64_t> parseInteger(const YAML::Node& node) { return integerOf(textOf(node)); }

bool fits(std::int64_t value, DataType type) {
  const unsigned bits = widthBits(type);
  if (bits == 0) return false;
  if (bits == 64) return true;
  if (value < 0) {
    return isSignedInteger(type) && value >= -(std::int64_t{1} << (bits - 1));
  }
  return value < std::int64_t{1} << bits;
}

bool inRange(const Entry& entry) {
  if (isReal(entry.type)) return true;
  const std::int64_t value =
      isSignedInteger(entry.type) ? asSigned(entry) : static_cast<std::int64_t>(entry.number);
  return (!entry.low || value >= *entry.low) && (!entry.high || value <= *entry.high);
}

Result<DefaultValue> parseDefault(const YAML::Node& node, DataType type) {
  if (!node.IsScalar()) return Error{"a default is a single value"};
  const std::string& text = node.Scalar();
  if (widthBits(type) == 0) {
    DefaultValue result;
    result.bytes.assign(text.begin(), text.end());
    return result;
  }
  if (text.size() > 1 && text[0] == 'f' && text != "false") return parseReal(text.substr(1), type);
  return isReal(type) ? parseReal(text, type) : parseNumber(text, type);
}

}  // namespace cia402::sim
