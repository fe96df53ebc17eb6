// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/eds/problems.h"

namespace cia402::canopen {

/// A line `key=value`.
struct EdsKey {
  std::string name;   ///< as written
  std::string value;  ///< without blanks around it and without a comment; UTF-8
  unsigned line = 0;
};

struct EdsSection {
  std::string name;  ///< as written
  unsigned line = 0;
  std::map<std::string, EdsKey> keys;  ///< by name in lower case without blanks

  /// nullptr if there is no such key. @param key in lower case.
  const EdsKey* find(const std::string& key) const;
  /// The same, but a key without a value counts as missing.
  const EdsKey* given(const std::string& key) const;
};

/// The sections and keys of an EDS file, by name in lower case without blanks. Repairs what can be:
/// line ends of any system, a byte order mark, Latin-1, comments behind values, sections and keys
/// given twice; each repair and each line that is lost is reported.
class EdsText {
 public:
  EdsText(std::string_view text, EdsProblems& problems);

  const std::map<std::string, EdsSection>& sections() const { return sections_; }
  /// nullptr if there is none. @param name in lower case.
  const EdsSection* find(const std::string& name) const;
  /// Number of the last line.
  unsigned lastLine() const { return line_; }

 private:
  void readLine(std::string_view line);
  void readSection(std::string_view line);
  void readKey(std::string_view line);
  std::string decode(std::string_view bytes);

  EdsProblems& problems_;
  std::map<std::string, EdsSection> sections_;
  EdsSection* section_ = nullptr;
  bool told_of_lost_lines_ = false;
  unsigned line_ = 0;
  bool latin1_told_ = false;
};

bool isUtf8(std::string_view text);
/// A control character of ASCII; the bytes of UTF-8 above it are none, whatever the sign of `char`.
bool isControl(char c);
/// Without blanks, tabs and other control characters at both ends.
std::string_view trimmed(std::string_view text);

}  // namespace cia402::canopen
