// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/command_line.h"

#include <cstdio>
#include <string_view>

namespace cia402::ros_node {
namespace {

constexpr int kUsageError = 2;

}  // namespace

std::optional<int> readCommandLine(int argc, const char* const* argv, const char* help) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "-h" || argument == "--help") {
      std::fputs(help, stdout);
      return 0;
    }
    if (argument.find(":=") != std::string_view::npos) continue;
    std::fprintf(stderr, "%s: unknown argument \"%s\", see --help\n", argv[0], argv[i]);
    return kUsageError;
  }
  return std::nullopt;
}

}  // namespace cia402::ros_node
