// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/text.h"

namespace cia402::canopen {
namespace {

constexpr char kEndOfFile = '\x1A';  // Ctrl-Z of DOS
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

bool isBlank(char c) { return c == ' ' || isControl(c); }

// How many bytes follow the first one of a UTF-8 sequence; -1: it is none.
int following(unsigned char first) {
  if (first < 0x80) return 0;
  if (first >= 0xC2 && first <= 0xDF) return 1;
  if (first >= 0xE0 && first <= 0xEF) return 2;
  if (first >= 0xF0 && first <= 0xF4) return 3;
  return -1;
}

}  // namespace

bool isControl(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7F;
}

bool isUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i++]);
    const int more = following(first);
    if (more < 0) return false;
    if (more > 1 && i < text.size()) {  // neither overlong, nor half a pair, nor beyond 10FFFF
      const auto second = static_cast<unsigned char>(text[i]);
      const unsigned char low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
      const unsigned char high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
      if (second < low || second > high) return false;
    }
    for (int k = 0; k < more; ++k, ++i) {
      if (i >= text.size() || (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80) return false;
    }
  }
  return true;
}

namespace {

std::string fromLatin1(std::string_view text) {
  std::string utf8;
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0U | byte >> 6U);
      utf8 += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return utf8;
}

// Where a comment behind a value begins: at a ';' with a blank before it.
std::size_t commentIn(std::string_view value) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] == ';' && (i == 0 || isBlank(value[i - 1]))) return i;
  }
  return std::string_view::npos;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

const EdsKey* EdsSection::find(const std::string& key) const {
  const auto found = keys.find(key);
  return found == keys.end() ? nullptr : &found->second;
}

const EdsKey* EdsSection::given(const std::string& key) const {
  const EdsKey* found = find(key);
  return found == nullptr || found->value.empty() ? nullptr : found;
}

const EdsSection* EdsText::find(const std::string& name) const {
  const auto found = sections_.find(name);
  return found == sections_.end() ? nullptr : &found->second;
}

EdsText::EdsText(std::string_view text, EdsProblems& problems) : problems_(problems) {
  if (text.size() > kLongestEds) {
    problems_.error(1, "the file is longer than " + std::to_string(kLongestEds >> 20U) +
                           " MiB; the rest is not read");
    text = text.substr(0, kLongestEds);
  }
  if (text.substr(0, kUtf8Mark.size()) == kUtf8Mark) text.remove_prefix(kUtf8Mark.size());
  if (text.substr(0, 2) == "\xFF\xFE" || text.substr(0, 2) == "\xFE\xFF") {
    problems_.error(1, "the file is in UTF-16; save it as plain text (ASCII, Latin-1 or UTF-8)");
    return;
  }
  while (!text.empty()) {
    const std::size_t end = text.find_first_of(std::string_view("\r\n\x1A", 3));
    const std::string_view line = text.substr(0, end);
    ++line_;
    readLine(line);
    if (end == std::string_view::npos) return;
    if (text[end] == kEndOfFile) {
      if (!trimmed(text.substr(end + 1)).empty()) {
        problems_.warning(line_,
                          "an end-of-file character (Ctrl-Z) stands here; what follows it "
                          "is not read");
      }
      return;
    }
    const bool crlf = text[end] == '\r' && end + 1 < text.size() && text[end + 1] == '\n';
    text.remove_prefix(end + (crlf ? 2 : 1));
  }
}

void EdsText::readLine(std::string_view line) {
  line = trimmed(line);
  if (line.empty() || line[0] == ';' || line[0] == '#') return;
  if (line.substr(0, 2) == "//") {
    problems_.warning(line_, "comments begin with `;`, not with `//`");
  } else if (line[0] == '[') {
    readSection(line);
  } else {
    readKey(line);
  }
}

void EdsText::readSection(std::string_view line) {
  const std::size_t end = line.find(']');
  section_ = nullptr;
  told_of_lost_lines_ = true;  // from here on only those of a section without a name are lost
  std::string_view name = line.substr(1, end == std::string_view::npos ? end : end - 1);
  if (end == std::string_view::npos) {
    problems_.warning(line_, "the `]` behind " + quoteEds(line) + " is missing");
    name = name.substr(0, commentIn(name));
  } else {
    const std::string_view rest = trimmed(line.substr(end + 1));
    if (!rest.empty() && rest[0] != ';' && rest[0] != '#') {
      problems_.warning(
          line_, quoteEds(rest) + " behind " + quoteEds(line.substr(0, end + 1)) + " is ignored");
    }
  }
  const std::string text = decode(trimmed(name));
  const std::string key = nameKey(text);
  if (key.empty()) {
    problems_.error(line_, "a section without a name; its lines are ignored");
    return;
  }
  const auto [place, fresh] = sections_.try_emplace(key);
  section_ = &place->second;
  if (fresh) {
    section_->name = text;
    section_->line = line_;
  } else {
    problems_.warning(line_, "section [" + text + "] stands in line " +
                                 std::to_string(section_->line) +
                                 " already; both are taken together");
  }
}

void EdsText::readKey(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (section_ == nullptr) {
    if (!told_of_lost_lines_) {
      problems_.error(line_, quoteEds(line) + " stands before the first section and is ignored");
    }
    told_of_lost_lines_ = true;
    return;
  }
  if (equals == std::string_view::npos) {
    problems_.error(line_, quoteEds(line) + " has no `=` and is ignored");
    return;
  }
  const std::string name(trimmed(line.substr(0, equals)));
  std::string_view value = trimmed(line.substr(equals + 1));
  value = trimmed(value.substr(0, commentIn(value)));
  if (name.empty()) {
    problems_.error(line_, quoteEds(line) + " has nothing before the `=` and is ignored");
    return;
  }
  EdsKey key{name, decode(value), line_};
  const auto [place, fresh] = section_->keys.try_emplace(nameKey(name), key);
  if (fresh) return;
  const EdsKey& first = place->second;
  const std::string where = name + " in [" + section_->name + "] stands in line " +
                            std::to_string(first.line) + " already";
  if (first.value == key.value) {
    problems_.warning(line_, where);
  } else {
    problems_.error(line_, where + ", with " + quoteEds(first.value) + ", which is taken; not " +
                               quoteEds(key.value));
  }
}

std::string EdsText::decode(std::string_view bytes) {
  std::string text;
  if (isUtf8(bytes)) {
    text = bytes;
  } else {
    text = fromLatin1(bytes);
    if (!latin1_told_) {
      problems_.warning(line_, "there are letters in Latin-1 here; CiA 306 allows ASCII only");
    }
    latin1_told_ = true;
  }
  bool control = false;
  for (char& c : text) {
    if (c == '\t') c = ' ';
    if (!isBlank(c) || c == ' ') continue;
    c = '?';
    control = true;
  }
  if (control) problems_.warning(line_, "a control character is read as `?`");
  return text;
}

}  // namespace cia402::canopen
