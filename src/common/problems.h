// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace cia402 {

/// One thing wrong in a file or parameter tree.
struct Problem {
  std::string path;     ///< where: "axes/shoulder/limits/upper", or "file.yaml:12: objects/..."
  std::string message;  ///< what is wrong with which value, and what to write instead
};

/// Collects every problem of a configuration, so that all are reported at once.
class Problems {
 public:
  void add(std::string path, std::string message) {
    list_.push_back({std::move(path), std::move(message)});
  }
  bool empty() const { return list_.empty(); }
  const std::vector<Problem>& list() const { return list_; }
  /// One line each: "  axes/shoulder/limits/upper: ...".
  std::string text() const {
    std::string all;
    for (const Problem& problem : list_) all += "  " + problem.path + ": " + problem.message + "\n";
    return all;
  }

 private:
  std::vector<Problem> list_;
};

}  // namespace cia402
