// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/problems.h"

#include <algorithm>

#include "canopen/eds/text.h"

namespace cia402::canopen {
namespace {

constexpr std::size_t kLongestQuote = 60;

}  // namespace

std::string toString(const EdsProblem& problem) {
  const bool error = problem.severity == EdsProblem::Severity::error;
  return "line " + std::to_string(problem.line) + (error ? ": error: " : ": warning: ") +
         problem.message;
}

std::size_t Eds::count(EdsProblem::Severity severity) const {
  return static_cast<std::size_t>(
      std::count_if(problems.begin(), problems.end(),
                    [&](const EdsProblem& problem) { return problem.severity == severity; }));
}

void EdsProblems::add(EdsProblem::Severity severity, unsigned line, std::string message) {
  if (list_.size() < kMostEdsProblems) {
    list_.push_back({severity, line, std::move(message)});
  } else {
    ++left_out_;
  }
}

void EdsProblems::moveTo(Eds& eds) {
  std::stable_sort(list_.begin(), list_.end(),
                   [](const EdsProblem& a, const EdsProblem& b) { return a.line < b.line; });
  eds.problems = std::move(list_);
  eds.problems_left_out = left_out_;
}

std::string quoteEds(std::string_view text) {
  const bool cut = text.size() > kLongestQuote;
  std::string quoted = "`";
  for (char c : text.substr(0, kLongestQuote)) {
    quoted += isControl(c) ? '?' : c;
  }
  return quoted + (cut ? "...`" : "`");
}

}  // namespace cia402::canopen
