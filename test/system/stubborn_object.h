// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "system/scene.h"

namespace cia402 {

/// The drive of `joint` takes another number than is written.
inline void clamp(Scene& scene, std::uint16_t index, std::uint8_t subindex, std::uint64_t number) {
  sim::ObjectDictionary& dictionary = scene.drive("joint").dictionary();
  dictionary.onWrite({index, subindex}, [&dictionary, number](const sim::Entry& entry) {
    dictionary.find(entry.id)->number = number;
  });
}

}  // namespace cia402
