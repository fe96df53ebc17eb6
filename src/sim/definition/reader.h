// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402::sim {

/// Everything wrong with one file, gathered.
using ProblemTexts = std::vector<std::string>;

/// One map of a YAML file. Notes wrong types, values and, at finish(), keys nobody asked for.
class DefinitionReader {
 public:
  /// @param path for messages, keys with dots between them; empty: the file itself.
  DefinitionReader(const YAML::Node& node, std::string path, ProblemTexts& problems);
  ~DefinitionReader();
  DefinitionReader(const DefinitionReader&) = delete;
  DefinitionReader& operator=(const DefinitionReader&) = delete;

  /// Whether the key is there; from now on it is a known one.
  bool has(const std::string& key);
  /// Its value, to be read by the caller.
  YAML::Node node(const std::string& key);
  /// Each reads a key into `out`, which keeps its value where the key is missing or wrong.
  void read(const std::string& key, bool& out);
  void read(const std::string& key, std::string& out);
  void read(const std::string& key, double& out, double low, double high);
  void read(const std::string& key, std::int64_t& out, std::int64_t low, std::int64_t high);
  /// Seconds, 0 to an hour.
  void read(const std::string& key, Duration& out);
  /// One of `words`; out is left alone if there is none.
  template <typename T>
  void read(const std::string& key, T& out, const std::vector<std::pair<const char*, T>>& words) {
    if (!has(key)) return;
    const std::string text = node(key).IsScalar() ? node(key).Scalar() : "";
    std::string known;
    for (const auto& [word, value] : words) {
      if (text == word) {
        out = value;
        return;
      }
      known += known.empty() ? word : std::string(", ") + word;
    }
    problem(key, "'" + text + "' is none of: " + known);
  }
  /// `body` for the map under `key`, if there.
  void section(const std::string& key, const std::function<void(DefinitionReader&)>& body);
  /// `body` for each pair of the map under `key`.
  void each(const std::string& key,
            const std::function<void(const std::string&, const YAML::Node&)>& body);

  /// Notes what is wrong with the value of a key, with its line.
  void problem(const std::string& key, const std::string& text);
  /// Of a key of this map, for messages.
  std::string pathOf(const std::string& key) const;
  ProblemTexts& problems() { return problems_; }

 private:
  YAML::Node node_;
  std::string path_;
  ProblemTexts& problems_;
  std::set<std::string> asked_;
};

}  // namespace cia402::sim
