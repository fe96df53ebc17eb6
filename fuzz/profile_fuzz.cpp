// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <string>

#include "config/drive_family.h"
#include "input.h"

// Drive profiles of any bytes: problems, never a crash.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cia402;
  Problems problems;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const drive::DriveProfile profile = config::parseDriveFamily(text, "fuzz.yaml", problems).drive;
  if (!problems.empty()) return 0;
  for (const drive::ObjectSpec& object : profile.objects) {
    fuzz::require(profile.find(object.name) != nullptr, "every object is found by its name");
    fuzz::require(profile.find(object.id) != nullptr, "every object is found by its index");
  }
  return 0;
}
