// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cia402::test {

/// Where the files of this package are that tests read: config/ and test/, absolute. Functions, so
/// that the place is compiled into one small file and not into every test.
std::string configFolder();
std::string testFolder();

}  // namespace cia402::test
