// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "yaml/reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>

#include "common/text.h"

namespace cia402::yaml {
namespace {

// Insertions, deletions, replacements and swaps of neighbours between two words.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
  std::iota(cost[0].begin(), cost[0].end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
      }
    }
  }
  return cost[a.size()][b.size()];
}

std::string describe(const YAML::Node& node) {
  if (node.IsScalar()) return "`" + node.Scalar() + "`";
  if (node.IsSequence()) return "a list";
  if (node.IsMap()) return "a mapping";
  return "nothing";
}

std::string rangeText(const Range& range) {
  std::ostringstream text;
  const bool has_low = range.low > -std::numeric_limits<double>::max();
  const bool has_high = range.high < std::numeric_limits<double>::max();
  if (has_low) text << (range.low_excluded ? "greater than " : "at least ") << range.low;
  if (has_low && has_high) text << " and ";
  if (has_high) text << "at most " << range.high;
  return text.str();
}

}  // namespace

std::string nearestName(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance < best_distance && distance < candidate.size()) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

// A longer list (of an EDS) would hide what is said.
constexpr std::size_t kMostListed = 60;

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearestName(name, candidates);
  if (!nearest.empty()) return ", did you mean `" + nearest + "`?";
  if (candidates.empty() || candidates.size() > kMostListed) return "";
  return "; known are " + joined(candidates, ", ");
}

YAML::Node parse(const std::string& text) { return YAML::Load(text + '\n'); }

YAML::Node parseFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) return YAML::LoadFile(path);  // throws, with what its version has to say
  std::ostringstream text;
  text << file.rdbuf();
  return parse(text.str());
}

std::optional<std::int64_t> parseInteger(const std::string& text) {
  const std::size_t digits = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  if (digits == text.size() || std::isspace(static_cast<unsigned char>(text[digits]))) return {};
  const bool hex = text.compare(digits, 2, "0x") == 0 || text.compare(digits, 2, "0X") == 0;
  char* end = nullptr;
  errno = 0;
  const std::int64_t value = std::strtoll(text.c_str(), &end, hex ? 16 : 10);
  if (errno != 0 || end != text.c_str() + text.size()) return {};
  return value;
}

std::optional<double> parseNumber(const std::string& text) {
  double value = 0.0;
  if (const auto whole = parseInteger(text)) return static_cast<double>(*whole);
  if (!YAML::convert<double>::decode(YAML::Node(text), value)) return {};
  return value;
}

Value::Value(const YAML::Node& node, std::string path, Problems& problems, std::string source)
    : node_(node), path_(std::move(path)), problems_(&problems), source_(std::move(source)) {}

void Value::problem(const std::string& message) const {
  if (source_.empty()) {
    problems_->add(path_, message);
    return;
  }
  const YAML::Mark mark = node_.Mark();
  const std::string line = mark.is_null() ? "" : ":" + std::to_string(mark.line + 1);
  problems_->add(source_ + line + (path_.empty() ? "" : ": " + path_), message);
}

std::optional<double> Value::number(Range range) const {
  const auto value = node_.IsScalar() ? parseNumber(node_.Scalar()) : std::nullopt;
  if (!value) {
    problem("must be a number, not " + describe(node_));
  } else if (!std::isfinite(*value)) {
    problem("must be a finite number, not " + describe(node_));
  } else if (*value < range.low || *value > range.high ||
             (range.low_excluded && *value == range.low)) {
    problem("must be " + rangeText(range) + ", not " + describe(node_));
  } else {
    return value;
  }
  return {};
}

std::optional<std::int64_t> Value::integer(std::int64_t low, std::int64_t high) const {
  const auto value = node_.IsScalar() ? parseInteger(node_.Scalar()) : std::nullopt;
  if (!value) {
    problem("must be a whole number, not " + describe(node_));
  } else if (*value < low || *value > high) {
    problem("must be between " + std::to_string(low) + " and " + std::to_string(high) + ", not " +
            describe(node_));
  } else {
    return value;
  }
  return {};
}

std::optional<bool> Value::boolean() const {
  bool value = false;
  if (node_.IsScalar() && YAML::convert<bool>::decode(node_, value)) return value;
  if (node_.IsScalar() && (node_.Scalar() == "1" || node_.Scalar() == "0")) {
    return node_.Scalar() == "1";
  }
  problem("must be true or false, not " + describe(node_));
  return {};
}

std::optional<std::string> Value::text() const {
  if (node_.IsScalar() && !node_.Scalar().empty()) return node_.Scalar();
  problem("must be a text, not " + describe(node_));
  return {};
}

std::optional<std::size_t> Value::oneOf(const std::vector<std::string>& words) const {
  const auto word = text();
  if (!word) return {};
  const auto found = std::find(words.begin(), words.end(), *word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  problem("unknown word `" + *word + "`" + suggestion(*word, words));
  return {};
}

std::vector<Value> Value::list() const {
  std::vector<Value> values;
  if (!node_.IsSequence()) {
    problem("must be a list, not " + describe(node_));
    return values;
  }
  for (std::size_t i = 0; i < node_.size(); ++i) {
    values.emplace_back(node_[i], path_ + "[" + std::to_string(i) + "]", *problems_, source_);
  }
  return values;
}

std::optional<std::vector<double>> Value::numbers(std::size_t size) const {
  std::vector<double> all;
  const std::vector<Value> values = list();
  for (const Value& value : values) {
    if (const auto number = value.number()) all.push_back(*number);
  }
  if (!node_.IsSequence() || all.size() != values.size()) return {};
  if (size != 0 && all.size() != size) {
    problem("must be a list of " + std::to_string(size) + " numbers, not of " +
            std::to_string(all.size()));
    return {};
  }
  return all;
}

Section::Section(const Value& value) : value_(value) {
  if (!value.node().IsMap() && value.node().IsDefined() && !value.node().IsNull()) {
    value.problem("must be a mapping (key: value), not " + describe(value.node()));
  }
}

Value Section::child(const std::string& key, const YAML::Node& node) const {
  const std::string path = value_.path().empty() ? key : value_.path() + "/" + key;
  return Value(node, path, value_.problems(), value_.source());
}

bool Section::has(const std::string& key) { return get(key).has_value(); }

std::optional<Value> Section::get(const std::string& key) {
  known_.push_back(key);
  if (!value_.node().IsMap()) return {};
  for (const auto& pair : value_.node()) {
    if (pair.first.IsScalar() && pair.first.Scalar() == key) {
      return child(key, pair.second);
    }
  }
  return {};
}

std::optional<Value> Section::require(const std::string& key, const std::string& hint) {
  const auto value = get(key);
  if (!value) value_.problem("`" + key + "` is missing: " + hint);
  return value;
}

bool Section::read(const std::string& key, double& target, Range range) {
  const auto value = get(key);
  const auto number = value ? value->number(range) : std::nullopt;
  if (number) target = *number;
  return number.has_value();
}

bool Section::read(const std::string& key, std::optional<double>& target, Range range) {
  double number = 0.0;
  const bool found = read(key, number, range);
  if (found) target = number;
  return found;
}

bool Section::read(const std::string& key, bool& target) {
  const auto value = get(key);
  const auto boolean = value ? value->boolean() : std::nullopt;
  if (boolean) target = *boolean;
  return boolean.has_value();
}

bool Section::read(const std::string& key, std::string& target) {
  const auto value = get(key);
  const auto text = value ? value->text() : std::nullopt;
  if (text) target = *text;
  return text.has_value();
}

std::vector<std::pair<std::string, Value>> Section::entries() {
  free_names_ = true;
  std::vector<std::pair<std::string, Value>> all;
  if (!value_.node().IsMap()) return all;
  for (const auto& pair : value_.node()) {
    if (!pair.first.IsScalar()) {
      value_.problem("has a key that is not a name");
      continue;
    }
    const std::string& key = pair.first.Scalar();
    all.emplace_back(key, child(key, pair.second));
  }
  return all;
}

void Section::finish() {
  if (!value_.node().IsMap()) return;
  std::set<std::string> seen;
  for (const auto& pair : value_.node()) {
    const std::string key = pair.first.IsScalar() ? pair.first.Scalar() : std::string("?");
    const Value at = child(key, pair.first);
    if (!seen.insert(key).second) at.problem("is given twice");
    if (free_names_ || std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    std::vector<std::string> candidates = known_;
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    at.problem("unknown key" + suggestion(key, candidates));
  }
}

}  // namespace cia402::yaml
