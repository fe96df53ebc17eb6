// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>

#include "sim/definition/drive_definition.h"

namespace cia402::sim {

/// Faults that a code names, as texts such as "0x7305".
class RawFaults {
 public:
  /// @return nullptr if the text names none; else it stays where it is.
  const FaultDefinition* find(const std::string& text) {
    char* end = nullptr;
    const bool raw = text.compare(0, 2, "0x") == 0;
    const unsigned long code = raw ? std::strtoul(text.c_str(), &end, 16) : 0;
    if (code == 0 || code > 0xFFFF || *end != '\0') return nullptr;
    FaultDefinition& made = faults_[static_cast<std::uint16_t>(code)];
    made.name = text;
    made.code = static_cast<std::uint16_t>(code);
    made.error_register = registerFor(made.code);
    return &made;
  }

 private:
  std::map<std::uint16_t, FaultDefinition> faults_;
};

}  // namespace cia402::sim
