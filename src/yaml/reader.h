// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "common/problems.h"

namespace cia402::yaml {

/// The name nearest to a misspelt one; empty if none is near enough to be meant.
std::string nearestName(std::string_view name, const std::vector<std::string>& candidates);
/// ", did you mean `velocity`?" or, where nothing is near, "; known are a, b, c".
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

/// YAML text, or that of a file, as a tree. To be used instead of YAML::Load and YAML::LoadFile:
/// before version 0.7 these never return from a text that ends behind the colon of a flow mapping.
/// @throws YAML::ParserException with line and reason; YAML::BadFile for a file that cannot be read
YAML::Node parse(const std::string& text);
YAML::Node parseFile(const std::string& path);

/// A whole number from a YAML scalar: decimal or 0x hexadecimal.
std::optional<std::int64_t> parseInteger(const std::string& text);
/// A number from a YAML scalar; also .inf and .nan, which callers must refuse.
std::optional<double> parseNumber(const std::string& text);

/// Lowest and highest value that a key may have.
struct Range {
  double low = -std::numeric_limits<double>::max(), high = std::numeric_limits<double>::max();
  bool low_excluded = false;  ///< "greater than low" instead of "at least low"
};
inline constexpr Range kPositive{0.0, std::numeric_limits<double>::max(), true};
inline constexpr Range kNotNegative{0.0, std::numeric_limits<double>::max(), false};

/// One value somewhere in a YAML tree. Reading it as what it is not adds a problem with its path
/// (and line, where the tree came from a file) and gives nothing.
class Value {
 public:
  /// @param source file name for messages; empty: paths without a line number.
  Value(const YAML::Node& node, std::string path, Problems& problems, std::string source = {});

  /// A finite number within `range`.
  std::optional<double> number(Range range = {}) const;
  /// A whole number from `low` to `high`, decimal or 0x hexadecimal.
  std::optional<std::int64_t> integer(std::int64_t low, std::int64_t high) const;
  /// true or false, in the words of YAML, or 1 or 0.
  std::optional<bool> boolean() const;
  /// A text that is not empty; a number is one, too.
  std::optional<std::string> text() const;
  /// The index of the text in `words`.
  std::optional<std::size_t> oneOf(const std::vector<std::string>& words) const;
  /// The elements of a list.
  std::vector<Value> list() const;
  /// A list of exactly `size` numbers (any number of them if 0).
  std::optional<std::vector<double>> numbers(std::size_t size = 0) const;

  bool isMap() const { return node_.IsMap(); }
  bool isList() const { return node_.IsSequence(); }
  bool isScalar() const { return node_.IsScalar(); }
  const YAML::Node& node() const { return node_; }
  const std::string& path() const { return path_; }
  Problems& problems() const { return *problems_; }
  const std::string& source() const { return source_; }

  /// Adds a problem with the path of this value.
  void problem(const std::string& message) const;

 private:
  YAML::Node node_;
  std::string path_;
  Problems* problems_;
  std::string source_;
};

/// A mapping of a YAML tree. Remembers which keys were asked for; finish() adds a problem for every
/// other key, with the nearest known name, and for every key given twice.
class Section {
 public:
  /// Anything but a mapping adds a problem and reads as an empty one; so does nothing at all.
  explicit Section(const Value& value);

  /// Is it there? It counts as asked for.
  bool has(const std::string& key);
  /// Its value; nothing if it is missing.
  std::optional<Value> get(const std::string& key);
  /// As get(), and a problem if the key is missing. @param hint what to write.
  std::optional<Value> require(const std::string& key, const std::string& hint);

  /// Reads a key into `target`, which keeps its value if the key is missing or wrong.
  /// @return true if the key was there and right.
  bool read(const std::string& key, double& target, Range range = {});
  bool read(const std::string& key, bool& target);
  bool read(const std::string& key, std::string& target);
  bool read(const std::string& key, std::optional<double>& target, Range range = {});
  template <typename Integer>
  bool readInteger(const std::string& key, Integer& target, std::int64_t low, std::int64_t high) {
    const auto value = get(key);
    const auto number = value ? value->integer(low, high) : std::nullopt;
    if (number) target = static_cast<Integer>(*number);
    return number.has_value();
  }
  template <typename Integer>
  bool readInteger(const std::string& key, std::optional<Integer>& target, std::int64_t low,
                   std::int64_t high) {
    Integer number{};
    const bool found = readInteger(key, number, low, high);
    if (found) target = number;
    return found;
  }

  /// All keys with their values in the file's order, for mappings whose keys are free names. Marks
  /// them as known.
  std::vector<std::pair<std::string, Value>> entries();

  /// Call when everything was read.
  void finish();

  void problem(const std::string& message) const { value_.problem(message); }
  const Value& value() const { return value_; }

 private:
  Value child(const std::string& key, const YAML::Node& node) const;

  Value value_;
  std::vector<std::string> known_;
  bool free_names_ = false;
};

}  // namespace cia402::yaml
