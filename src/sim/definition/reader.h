// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "cia402_driver/common/time.h"
#include "yaml/reader.h"

namespace cia402::sim {

/// One map of the file of a simulated drive: a yaml::Section that is finished at its end, and what
/// these files need besides.
class DefinitionReader {
 public:
  explicit DefinitionReader(const yaml::Value& map) : section_(map) {}
  ~DefinitionReader() { section_.finish(); }
  DefinitionReader(const DefinitionReader&) = delete;
  DefinitionReader& operator=(const DefinitionReader&) = delete;

  /// Whether the key is there; from now on it is a known one.
  bool has(const std::string& key) { return section_.has(key); }
  /// Its value, to be read by the caller; null where it is missing.
  YAML::Node node(const std::string& key);
  /// Each reads a key into `out`, which keeps its value where the key is missing or wrong.
  void read(const std::string& key, bool& out) { section_.read(key, out); }
  void read(const std::string& key, std::string& out) { section_.read(key, out); }
  void read(const std::string& key, double& out, double low, double high) {
    section_.read(key, out, yaml::Range{low, high, false});
  }
  void read(const std::string& key, std::int64_t& out, std::int64_t low, std::int64_t high) {
    section_.readInteger(key, out, low, high);
  }
  /// Seconds, 0 to an hour.
  void read(const std::string& key, Duration& out);
  /// One of `words`; out is left alone if there is none.
  template <typename T>
  void read(const std::string& key, T& out, const std::vector<std::pair<const char*, T>>& words) {
    const auto value = section_.get(key);
    if (!value) return;
    std::vector<std::string> known;
    for (const auto& [word, meaning] : words) known.emplace_back(word);
    if (const auto index = value->oneOf(known)) out = words[*index].second;
  }
  /// `body` for the map under `key`, if there.
  void section(const std::string& key, const std::function<void(DefinitionReader&)>& body);
  /// `body` for each element of the list under `key`, if there.
  void list(const std::string& key, const std::function<void(const yaml::Value&)>& body);
  /// `body` for each pair of the map under `key`, if there.
  void each(const std::string& key,
            const std::function<void(const std::string&, const yaml::Value&)>& body);

  /// Notes what is wrong with the value of a key.
  void problem(const std::string& key, const std::string& text);

 private:
  yaml::Section section_;
};

}  // namespace cia402::sim
