// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/dictionary/reader.h"

namespace cia402::sim {

/// `array: {index: ..., count: ..., ...}` of dictionary_yaml.h.
void readArrayMacro(DictionaryReader& reader, const YAML::Node& macro);
/// `rpdos: {...}` and `tpdos: {...}` of dictionary_yaml.h.
void readPdoMacro(DictionaryReader& reader, const YAML::Node& macro, bool receive);

}  // namespace cia402::sim
