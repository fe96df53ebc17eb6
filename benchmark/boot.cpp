// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How long many drives take to boot, beside the time that their frames alone need on the wire.
#include <array>
#include <cstdio>
#include <stdexcept>

#include "figures.h"
#include "robots.h"
#include "tools/virtual_robot.h"

namespace cia402::benchmark {
namespace {

struct Row {
  int nodes;
  double sync_period;  ///< s; the shortest usual one that leaves some of the bus free
};
constexpr std::array<Row, 4> kRows{{{1, 0.004}, {8, 0.008}, {32, 0.02}, {100, 0.08}}};

struct Boot {
  double took = 0.0, wire = 0.0;  ///< s, from the reset command to the last node ready
  std::uint64_t frames = 0;
  double ratio() const { return took / wire; }
};

bool allReady(bus::Network& robot) {
  for (const canopen::Node& node : robot.master().nodes()) {
    if (node.health() != fieldbus::Health::ready) return false;
  }
  return true;
}

/// The drives are powered and waiting when the driver starts and resets them.
Boot boot(const Row& row) {
  TestRobot robot = genericRobot(row.nodes, row.sync_period, Layout::profile);
  robot.robot.bus.listen = Duration::zero();  // the boot is measured, not the time before
  tools::VirtualRobot world(robot.robot, robot.master, robot.drives);
  world.world().powerOn();
  world.run(std::chrono::seconds(1));
  const sim::BusTraffic before = world.world().bus().traffic();
  const Time begin = world.now();
  world.startDriver();
  const Time end = begin + std::chrono::seconds(60);
  while (!allReady(world.network()) && world.now() < end) world.run(std::chrono::microseconds(100));
  for (const canopen::Node& node : world.network().master().nodes()) {
    const std::uint32_t boot_ups = node.bootUps();  // the driver was not there at the first one
    const bool well = node.health() == fieldbus::Health::ready && boot_ups == 1 &&
                      node.notes().empty() && node.emergencies() == 0;
    if (!well) {
      throw std::runtime_error(
          node.name() + " did not boot as it should: " + node.bootStep() + ", boot-ups " +
          std::to_string(boot_ups) + ", emergencies " + std::to_string(node.emergencies()) +
          (node.lastEmergency() ? ", the last one " + std::to_string(node.lastEmergency()->code)
                                : "") +
          " " + node.problem() + (node.notes().empty() ? "" : node.notes().front()));
    }
  }
  const sim::BusTraffic after = world.world().bus().traffic();
  Boot result;
  result.took = toSeconds(world.now() - begin);
  result.wire = static_cast<double>(after.busy_bits - before.busy_bits) / 1e6;
  result.frames = after.frames - before.frames;
  return result;
}

}  // namespace

int bootNodes() {
  std::fprintf(stderr, "| nodes | frames | on the wire | until all are ready | ratio |\n");
  std::fprintf(stderr, "|---|---|---|---|---|\n");
  for (const Row& row : kRows) {
    const Boot result = boot(row);
    std::fprintf(stderr, "| %d | %llu | %.3f s | %.3f s | %.2f |\n", row.nodes,
                 static_cast<unsigned long long>(result.frames), result.wire, result.took,
                 result.ratio());
    if (row.nodes == 32) print("boot_32_nodes", result.ratio(), "ratio");
  }
  return 0;
}

}  // namespace cia402::benchmark
