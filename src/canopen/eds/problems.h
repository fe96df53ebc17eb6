// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "canopen/eds/eds.h"

namespace cia402::canopen {

/// Collects what is wrong in a file; a damaged file of any size yields a bounded list.
class EdsProblems {
 public:
  void error(unsigned line, std::string message) {
    add(EdsProblem::Severity::error, line, std::move(message));
  }
  void warning(unsigned line, std::string message) {
    add(EdsProblem::Severity::warning, line, std::move(message));
  }
  /// Moves everything into `eds`, in the order of the lines.
  void moveTo(Eds& eds);

 private:
  void add(EdsProblem::Severity severity, unsigned line, std::string message);

  std::vector<EdsProblem> list_;
  std::size_t left_out_ = 0;
};

/// A piece of the file for a message: short, without control characters.
std::string quoteEds(std::string_view text);

}  // namespace cia402::canopen
