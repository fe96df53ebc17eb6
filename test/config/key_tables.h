// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The tables of keys in docs/configuration.md.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "folders.h"

namespace cia402::config {

/// A row: what a key, or several, may be and is where it is not given.
struct KeyRow {
  std::vector<std::string> keys;  ///< "goal_time", "constraints/goal_time"
  std::string fallback;           ///< the cell below `default`
  std::string text;               ///< the whole line
};

/// A chapter of the document, from its heading to the next one.
struct KeyChapter {
  std::vector<KeyRow> rows;
  std::string text;
};

/// What stands in `code`: "`lower` < `upper`" gives lower, upper.
inline std::vector<std::string> codeIn(const std::string& text) {
  static const std::regex kCode("`([^`]+)`");
  std::vector<std::string> all;
  for (std::sregex_iterator at(text.begin(), text.end(), kCode), end; at != end; ++at) {
    all.push_back((*at)[1]);
  }
  return all;
}

/// All words of it: "`{save: [1]}`" gives save.
inline std::set<std::string> wordsOfCode(const std::string& text) {
  static const std::regex kWord("[A-Za-z_]+");
  std::set<std::string> words;
  for (const std::string& code : codeIn(text)) {
    for (std::sregex_iterator at(code.begin(), code.end(), kWord), end; at != end; ++at) {
      words.insert(at->str());
    }
  }
  return words;
}

inline std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream rest(line.substr(1));
  for (std::string cell; std::getline(rest, cell, '|');) {
    const std::size_t first = cell.find_first_not_of(' ');
    const std::size_t last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last + 1 - first));
  }
  return cells;
}

/// By heading: "Top level", "axes/<name>", "homing".
inline std::map<std::string, KeyChapter> keyChapters() {
  std::ifstream file(test::configFolder() + "/../docs/configuration.md");
  EXPECT_TRUE(file.is_open());
  std::map<std::string, KeyChapter> chapters;
  KeyChapter* chapter = nullptr;
  std::size_t fallback = 0;  // the column of defaults, if this is a table of keys
  bool fenced = false;
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, 3, "```") == 0) fenced = !fenced;
    if (fenced || line.compare(0, 3, "```") == 0) continue;
    if (line.compare(0, 2, "##") == 0) {
      std::string heading = line.substr(line.find(' ') + 1);
      heading = std::regex_replace(heading, std::regex("`"), "");
      chapter = &chapters[heading];
    }
    if (chapter == nullptr) continue;
    chapter->text += line + "\n";
    if (line.empty() || line[0] != '|') continue;
    const std::vector<std::string> cells = cellsOf(line);
    if (cells[0] == "key") {
      for (fallback = 1; cells.at(fallback) != "default";) ++fallback;
    } else if (cells[0][0] == '`') {
      chapter->rows.push_back({codeIn(cells[0]), cells.at(fallback), line});
    }
  }
  return chapters;
}

/// The keys of a chapter, below a prefix: of "constraints/" those behind it.
inline std::map<std::string, KeyRow> keysBelow(const KeyChapter& chapter,
                                               const std::string& prefix) {
  std::map<std::string, KeyRow> rows;
  for (const KeyRow& row : chapter.rows) {
    for (const std::string& key : row.keys) {
      if (key.compare(0, prefix.size(), prefix) != 0) continue;
      const std::string rest = key.substr(prefix.size());
      rows.emplace(rest.substr(0, rest.find('/')), row);
    }
  }
  return rows;
}

}  // namespace cia402::config
