// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/strings.h"

#include <algorithm>
#include <cstdio>

namespace cia402::canopen {
namespace {

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<ObjectValue> hexBytes(std::string_view text) {
  if (text.size() > 1 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    text.remove_prefix(2);
  }
  ObjectValue bytes;
  while (!text.empty()) {
    if (text[0] == ' ' || text[0] == '\t') {
      text.remove_prefix(1);
      continue;
    }
    const int high = hexDigit(text[0]);
    const int low = text.size() > 1 ? hexDigit(text[1]) : -1;
    if (high < 0 || low < 0) return {};
    bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
    text.remove_prefix(2);
  }
  return bytes;
}

// The next character of valid UTF-8.
char32_t nextCharacter(std::string_view& text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t size = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  char32_t character = size == 1 ? first : first & (0xFFU >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    character = character << 6U | (static_cast<unsigned char>(text[i]) & 0x3FU);
  }
  text.remove_prefix(size);
  return character;
}

void appendUnit(ObjectValue& bytes, char32_t unit) {
  bytes.push_back(static_cast<std::uint8_t>(unit & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(unit >> 8U));
}

ObjectValue utf16(std::string_view text) {
  ObjectValue bytes;
  while (!text.empty()) {
    const char32_t character = nextCharacter(text);
    if (character < 0x10000) {
      appendUnit(bytes, character);
    } else {
      appendUnit(bytes, 0xD800 + ((character - 0x10000) >> 10U));
      appendUnit(bytes, 0xDC00 + ((character - 0x10000) & 0x3FFU));
    }
  }
  return bytes;
}

void appendUtf8(std::string& text, char32_t character) {
  if (character < 0x80) {
    text += static_cast<char>(character);
    return;
  }
  const int more = character < 0x800 ? 1 : character < 0x10000 ? 2 : 3;
  static constexpr unsigned kFirst[] = {0, 0xC0, 0xE0, 0xF0};
  text += static_cast<char>(kFirst[more] | character >> (6U * static_cast<unsigned>(more)));
  for (int i = more - 1; i >= 0; --i) {
    text += static_cast<char>(0x80U | (character >> (6U * static_cast<unsigned>(i)) & 0x3FU));
  }
}

std::optional<std::string> fromUtf16(const ObjectValue& bytes) {
  if (bytes.size() % 2 != 0) return {};
  const auto unit = [&](std::size_t i) {
    return static_cast<char32_t>(bytes[i] | bytes[i + 1] << 8);
  };
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    char32_t character = unit(i);
    if (character >= 0xD800 && character < 0xE000) {  // half of one
      i += 2;
      if (character >= 0xDC00 || i >= bytes.size()) return {};
      if (unit(i) < 0xDC00 || unit(i) >= 0xE000) return {};
      character = 0x10000 + ((character - 0xD800) << 10U) + (unit(i) - 0xDC00);
    }
    appendUtf8(text, character);
  }
  return text;
}

// Whether a line `key=text` reads back as `text`.
bool fitsALine(const std::string& text) {
  if (text.empty() || trimmed(text).size() != text.size() || !isUtf8(text)) return false;
  if (text[0] == ';' || text.find(" ;") != std::string::npos) return false;
  return std::none_of(text.begin(), text.end(), isControl);
}

}  // namespace

EdsValue stringText(std::string_view text, DataType type) {
  EdsValue value;
  if (type == DataType::unicode_string) {
    value.bytes = utf16(text);
    return value;
  }
  if (type != DataType::visible_string) {
    value.bytes = hexBytes(text);
    if (value.bytes) return value;
    value.note = quoteEds(text) + " should be hexadecimal bytes, as the type is " + toString(type) +
                 "; taken as text";
  }
  value.bytes = ObjectValue(text.begin(), text.end());
  return value;
}

std::optional<std::string> formatString(const ObjectValue& value, DataType type) {
  if (type == DataType::octet_string || type == DataType::domain) {
    std::string text;
    for (std::uint8_t byte : value) {
      char pair[4];
      std::snprintf(pair, sizeof pair, "%02X", static_cast<unsigned>(byte));
      text += pair;
    }
    return text.empty() ? std::nullopt : std::optional<std::string>(text);
  }
  const std::optional<std::string> text =
      type == DataType::unicode_string ? fromUtf16(value) : std::string(value.begin(), value.end());
  return text && fitsALine(*text) ? text : std::nullopt;
}

}  // namespace cia402::canopen
