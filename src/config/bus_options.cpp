// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "config/robot_parts.h"
#include "drive/profile/named_write.h"

namespace cia402::config {
namespace {

void readBitrate(yaml::Section& section, BusConfig& bus) {
  static const std::vector<std::int64_t> kRates = {10000,  20000,  50000,  100000, 125000,
                                                   250000, 500000, 800000, 1000000};
  const auto value = section.get("bitrate");
  const auto rate = value ? value->integer(1, 1000000) : std::nullopt;
  if (!rate) return;
  if (std::find(kRates.begin(), kRates.end(), *rate) == kRates.end()) {
    value->problem(
        "is no bit rate of CiA 301; there are 10000, 20000, 50000, 100000, 125000, "
        "250000, 500000, 800000 and 1000000");
  }
  bus.bitrate = static_cast<double>(*rate);
}

void readSyncPeriod(yaml::Section& section, BusConfig& bus) {
  double period = toSeconds(bus.sync_period);
  if (!section.read("sync_period", period, yaml::Range{0.0, 1.0, true})) return;
  const auto value = *section.get("sync_period");
  bus.sync_period = fromSeconds(period);
  if (bus.sync_period < std::chrono::microseconds(100)) {
    value.problem("must be at least 0.0001 s");
  } else if (bus.sync_period.count() % 1000 != 0) {
    value.problem("must be a whole number of microseconds, as 1006h counts in them");
  }
}

void readSyncWindow(yaml::Section& section, BusConfig& bus) {
  double window = 0.0;
  if (!section.read("sync_window", window, yaml::Range{0.0, 1.0, false})) return;
  const auto value = *section.get("sync_window");
  bus.sync_window = fromSeconds(window);
  if (bus.sync_window->count() % 1000 != 0) {
    value.problem("must be a whole number of microseconds, as 1007h counts in them");
  } else if (*bus.sync_window > bus.sync_period) {
    value.problem("must not be longer than sync_period (" +
                  std::to_string(toSeconds(bus.sync_period)) + " s)");
  }
}

void readTimeInterval(yaml::Section& section, BusConfig& bus) {
  double interval = 0.0;
  if (!section.read("time_interval", interval, yaml::Range{0.0, 86400.0, false})) return;
  bus.time_interval = fromSeconds(interval);
  if (interval > 0.0 && interval < 0.01) {
    section.get("time_interval")->problem("must be 0 (no TIME messages) or at least 0.01 s");
  }
}

void readListen(yaml::Section& section, BusConfig& bus) {
  double listen = toSeconds(bus.listen);
  if (section.read("listen", listen, yaml::Range{0.0, 60.0, false})) {
    bus.listen = fromSeconds(listen);
  }
}

void readHeartbeat(yaml::Section& section, BusConfig& bus) {
  double heartbeat = toSeconds(bus.heartbeat);
  if (!section.read("heartbeat", heartbeat, yaml::Range{0.0, 65.535, false})) return;
  bus.heartbeat = fromSeconds(heartbeat);
  if (bus.heartbeat.count() % 1000000 != 0) {
    section.get("heartbeat")->problem("must be a whole number of milliseconds, as 1017h counts");
  }
}

/// Does the family write the period in this form when a drive starts?
bool writesPeriod(const drive::DriveProfile& profile, const char* source) {
  return std::any_of(profile.startup.begin(), profile.startup.end(),
                     [&](const drive::NamedWrite& write) { return write.from == source; });
}

/// What the device says of periods; `whose` begins the sentence.
void checkDevicePeriod(const yaml::Value& at, const std::string& whose, Duration period,
                       const canopen::DeviceProfile& device) {
  const Duration step = device.sync_period_step;
  if (device.has_sync_period_object && period % step != Duration(0)) {
    at.problem(whose + " takes multiples of " + secondsText(step) + " in 1006h");
  }
  if (period < device.sync_period_min) {
    at.problem(whose + " follows no period below " + secondsText(device.sync_period_min) +
               "; make it longer");
  }
  if (period > device.sync_period_max) {
    at.problem(whose + " follows no period above " + secondsText(device.sync_period_max) +
               "; make it shorter");
  }
}

void checkPeriod(const yaml::Value& at, const RobotConfig& robot) {
  for (const drive::AxisConfig& axis : robot.axes) {
    if (!axis.profile) continue;
    const std::string whose = "`" + axis.name + "` (profile " + axis.profile->name + ")";
    const Duration period = robot.bus.sync_period;
    checkDevicePeriod(at, whose, period, *robot.deviceOf(axis).profile);
    if (writesPeriod(*axis.profile, "sync_period.ms") && period.count() % 1000000 != 0) {
      at.problem(whose + " takes the period in whole milliseconds");
    }
    const bool interpolates = writesPeriod(*axis.profile, "sync_period.value") ||
                              writesPeriod(*axis.profile, "sync_period.exponent");
    if (interpolates && !drive::interpolationPeriod(period)) {
      at.problem("`" + axis.name +
                 "` needs the period in 60C2h as a number 1 to 255 times a power "
                 "of ten; take for example 0.004 instead of " +
                 secondsText(robot.bus.sync_period));
      return;
    }
  }
}

void warnOfUnnoticedLoss(RobotConfig& robot) {
  const auto unsupervised = [&](const canopen::DeviceConfig& device) {
    return !device.profile ||
           planErrorControl(robot.bus, device).kind == canopen::ErrorControl::none;
  };
  if (robot.bus.heartbeat == Duration(0) &&
      std::all_of(robot.devices.begin(), robot.devices.end(), unsupervised)) {
    robot.warnings.emplace_back(
        "bus/heartbeat: is 0: should this program die, no drive would notice and stop; nor would a "
        "lost drive be noticed but by its missing TPDOs");
    return;
  }
  for (const canopen::DeviceConfig& device : robot.devices) {
    if (!device.profile) continue;
    const ErrorControlPlan plan = planErrorControl(robot.bus, device);
    if (plan.kind == canopen::ErrorControl::guarding) continue;
    if (plan.kind == canopen::ErrorControl::none) {
      robot.warnings.push_back("axes/" + device.name +
                               ": this drive is not supervised: its loss shows in missing TPDOs "
                               "only");
    }
    if (plan.master_timeout > Duration(0)) continue;
    robot.warnings.push_back("axes/" + device.name +
                             ": this drive watches no heartbeat: should this program die, it would "
                             "not notice and stop");
  }
}

/// The next period from `us` on that 60C2h can tell: 1 to 255 times a power of ten.
std::int64_t tellable(std::int64_t us) {
  std::int64_t unit = 1;
  while ((us + unit - 1) / unit > 255) unit *= 10;
  return (us + unit - 1) / unit * unit;
}

struct FeasibleCycle {
  Duration period;
  double rate;  ///< Hz; the highest with the plan of that period
};

BusLoad planLoad(const RobotConfig& robot) {
  Problems told_elsewhere;
  return busLoad(makeMasterConfig(robot, told_elsewhere), robot.bus.bitrate);
}

/// The shortest cycle that loads the bus to kComfortableLoad at most. A slower cycle plans anew:
/// what need not come so often comes with fewer of its SYNCs.
std::optional<FeasibleCycle> feasibleCycle(RobotConfig robot, BusLoad load) {
  constexpr double kSlowest = 1.0;  // Hz
  std::int64_t us = 0;
  while (load.feasible_rate >= kSlowest) {
    us = tellable(std::max(us + 1, static_cast<std::int64_t>(std::ceil(1e6 / load.feasible_rate))));
    const Duration period = std::chrono::microseconds(us);
    planAgain(robot, period);
    load = planLoad(robot);
    if (load.worst <= kComfortableLoad) return FeasibleCycle{period, load.feasible_rate};
  }
  return {};
}

}  // namespace

void readBus(const yaml::Value& value, BusConfig& bus, bool& counter_given) {
  yaml::Section section(value);
  section.require("interface", "the CAN interface (can0), or `sim` for simulated drives");
  section.read("interface", bus.interface);
  if (bus.interface.size() > 15) {
    section.get("interface")->problem("no network interface has a name longer than 15 letters");
  }
  readBitrate(section, bus);
  readSyncPeriod(section, bus);
  section.readInteger("node_id", bus.node_id, 1, 127);
  readHeartbeat(section, bus);
  if (const auto sync = section.get("sync")) {
    bus.external_sync = sync->oneOf({"own", "external"}).value_or(0) == 1;
  }
  readListen(section, bus);
  if (const auto reset = section.get("reset")) {
    bus.reset_all = reset->oneOf({"each", "all"}).value_or(0) == 1;
  }
  if (const auto receive = section.get("receive")) {
    bus.receive_all = receive->oneOf({"configured", "all"}).value_or(0) == 1;
  }
  section.read("stop_all_on_loss", bus.stop_all_on_loss);
  readSyncWindow(section, bus);
  readTimeInterval(section, bus);
  counter_given = section.readInteger("sync_counter", bus.sync_counter, 0, 240);
  if (counter_given && bus.sync_counter == 1) {
    section.get("sync_counter")->problem("1 is no counter; write 0 (none) or 2 to 240");
  }
  section.finish();
}

void checkSync(const yaml::Value& bus_section, bool counter_given, RobotConfig& robot) {
  yaml::Section section(bus_section);
  warnOfUnnoticedLoss(robot);
  checkPeriod(section.get("sync_period").value_or(bus_section), robot);
  const canopen::DeviceConfig* chooser = nullptr;
  for (const canopen::DeviceConfig& device : robot.devices) {
    if (counter_given || !device.profile || !device.profile->sync_counter) continue;
    if (chooser != nullptr && *device.profile->sync_counter != robot.bus.sync_counter) {
      bus_section.problem("`" + chooser->name + "` and `" + device.name +
                          "` want different SYNC "
                          "counters; choose with `sync_counter`");
    }
    chooser = chooser != nullptr ? chooser : &device;
    robot.bus.sync_counter = *device.profile->sync_counter;
  }
  for (const canopen::DeviceConfig& device : robot.devices) {
    if (robot.bus.sync_counter == 0 || !device.profile || device.profile->has_sync_counter_object) {
      continue;
    }
    robot.warnings.push_back("axes/" + device.name +
                             ": SYNC carries a counter, but this drive has no "
                             "1019h; if it takes no SYNC, write `sync_counter: 0` under `bus`");
  }
}

namespace {

/// The makers' rules for the shortest sensible period, each told once.
void warnOfShortPeriod(const canopen::MasterConfig& master, RobotConfig& robot) {
  std::size_t pdos = 0;
  for (const canopen::NodeConfig& node : master.nodes) {
    pdos += static_cast<std::size_t>(
        std::count_if(node.pdos.begin(), node.pdos.end(),
                      [](const canopen::PdoConfig& pdo) { return pdo.enabled; }));
  }
  std::vector<std::string> told;
  for (const drive::AxisConfig& axis : robot.axes) {
    if (!axis.profile) continue;
    const auto& advice = robot.deviceOf(axis).profile->sync_advice;
    const bool again = std::find(told.begin(), told.end(), axis.profile->name) != told.end();
    if (!advice || again) continue;
    const double per_second = advice->pdos_per_ms * 1000.0 * robot.bus.bitrate / 1e6;
    const double least =
        static_cast<double>(pdos) / per_second / advice->share + toSeconds(advice->margin);
    if (toSeconds(robot.bus.sync_period) >= least) continue;
    told.push_back(axis.profile->name);
    const double tenth = std::ceil(least * 1e4 - 1e-9) * 1e-4;  // of a millisecond
    robot.warnings.push_back("bus/sync_period: the maker of " + axis.profile->name + " advises " +
                             numberText(tenth) + " s or more for " + std::to_string(pdos) +
                             " PDOs, not " + secondsText(robot.bus.sync_period));
  }
}

}  // namespace

void checkBusLoad(const yaml::Value& bus_section, RobotConfig& robot, Problems& problems) {
  if (planLoad(robot).worst > kComfortableLoad) leaveRiders(robot);
  const canopen::MasterConfig master = makeMasterConfig(robot, problems);
  warnOfShortPeriod(master, robot);
  const BusLoad load = busLoad(master, robot.bus.bitrate);
  const std::string rate = std::to_string(std::lround(1.0 / toSeconds(robot.bus.sync_period)));
  const std::string share = "the PDOs need " + percentText(load.worst) + " of the bus at " + rate +
                            " Hz in the worst case (" + percentText(load.nominal) +
                            " without stuff bits)";
  if (load.worst <= kComfortableLoad) return;
  const auto cycle = feasibleCycle(robot, load);
  const std::string feasible = std::to_string(cycle ? static_cast<int>(cycle->rate) : 0);
  if (load.worst > 1.0) {
    yaml::Section section(bus_section);
    const auto at = section.get("sync_period").value_or(bus_section);
    if (!cycle) {
      at.problem(share + "; heartbeats and events alone fill it: make `heartbeat` longer, give " +
                 "event-driven PDOs an `inhibit` time, or use a second bus");
      return;
    }
    at.problem(share + "; at most " + feasible + " Hz keep it below 80 %: write `sync_period` of " +
               secondsText(cycle->period) +
               " or more, leave modes (`modes`) or feedback (`feedback`) out, or use a second bus");
  } else {
    robot.warnings.push_back("bus/sync_period: " + share +
                             ", which leaves little for SDO and "
                             "emergencies; at most " +
                             feasible + " Hz keep it below 80 %");
  }
}

}  // namespace cia402::config
