// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Usage: benchmarks --list | NAME | --cycles AXES CYCLES
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "figures.h"

namespace cia402::benchmark {
namespace {

struct Figure {
  const char* name;
  int (*measure)();
};

constexpr std::array<Figure, 8> kFigures{{
    {"virtual_time_speed_3_axes", virtualTimeSpeed},
    {"virtual_time_repeatable", virtualTimeRepeatable},
    {"cycle_cost_6_axes", cycleCost},
    {"group_cost_6_axes", groupCost},
    {"sync_lateness", syncLateness},
    {"sdo_block_download", sdoBlockDownload},
    {"sdo_block_upload", sdoBlockUpload},
    {"boot_32_nodes", bootNodes},
}};

int run(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "--list" && argc == 2) {
    for (const Figure& figure : kFigures) std::printf("%s\n", figure.name);
    return 0;
  }
  if (what == "--cycles" && argc == 4) return countedCycles(std::atoi(argv[2]), std::atoi(argv[3]));
  for (const Figure& figure : kFigures) {
    if (argc == 2 && what == figure.name) return figure.measure();
  }
  std::fprintf(stderr, "usage: %s --list | NAME | --cycles AXES CYCLES\n", argv[0]);
  return 2;
}

}  // namespace

void print(const std::string& name, double value, const std::string& unit) {
  std::printf("%s %.4g %s\n", name.c_str(), value, unit.c_str());
  std::fflush(stdout);
}

}  // namespace cia402::benchmark

int main(int argc, char** argv) {
  try {
    return cia402::benchmark::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}
