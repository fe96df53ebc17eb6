// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "folders.h"

namespace cia402::test {

std::string configFolder() { return CIA402_CONFIG_FOLDER; }
std::string testFolder() { return CIA402_TEST_FOLDER; }

}  // namespace cia402::test
