// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>

#include "system/scene.h"

namespace cia402 {

inline std::string genericProfileText() {
  std::ifstream file(test::configFolder() + "/drives/generic_cia402.yaml");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Writes a profile of a test's own. @return its path, as `drive:` of an axis takes it.
inline std::string writeProfile(const std::string& text) {
  static int number = 0;
  std::string path = testing::TempDir() + "field_drive_" + std::to_string(getpid()) + "_" +
                     std::to_string(++number) + ".yaml";
  std::ofstream(path) << text;
  return path;
}

/// The pair of generic drives, the left one with more keys in its profile and habits of its own.
/// @param habits "quirks: {...}, communication: {...}"; @param options of the axis, ", key: value"
inline std::string fieldPair(const std::string& keys, const std::string& habits,
                             const std::string& options = {}) {
  return genericPair(", drive: " + writeProfile(genericProfileText() + "\n" + keys + "\n") +
                     ", simulation: {drive: generic_cia402, with: {" + habits + "}}" + options);
}

}  // namespace cia402
