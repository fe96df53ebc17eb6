// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace cia402::bus {

/// How well something is, for diagnostics and log, the worse the later.
enum class Condition : std::uint8_t {
  well,
  warning,  ///< it does what it is told, or is about to, but something wants to be looked at
  error,    ///< it does not, or nobody knows
  unheard,  ///< nothing comes from it: what is shown of it is of the past, or unknown
};

/// The condition in words: "operation enabled", or what is wrong.
struct Summary {
  Condition condition = Condition::well;
  std::string text;

  /// Something else that is so. Of what is not well all is told, and the worst counts.
  void add(Condition other, const std::string& words) {
    if (condition != Condition::well && other != Condition::well) {
      text += "; " + words;
    } else if (other > condition) {
      text = words;
    }
    if (other > condition) condition = other;
  }
};

}  // namespace cia402::bus
